//! `afmsweep modes`: natural frequencies and shares of the scene's first instance.

use super::{SceneArgs, load, print, print_json};
use afmsweep::instrument::{DEFAULT_TOLERANCE, Instrument, summary};
use afmsweep::plan::PlanError;
use serde_json::json;

pub fn main(args: &SceneArgs) -> anyhow::Result<()> {
    let scene = load(&args.scene)?;
    let params = scene.instance(0);
    let instrument =
        Instrument::reduce(&params.instrument, params.drive.on, DEFAULT_TOLERANCE).map_err(|source| {
            PlanError::Instrument { instance: 0, values: String::new(), source }.in_scene(&scene)
        })?;
    if args.json {
        // The list ends where frequencies can no longer be vouched for; shares count all modes.
        let rest = |shares: Vec<f64>| shares[instrument.resolved..].iter().sum::<f64>();
        let mut answer = summary::modes_json(&instrument);
        answer["rest"] = json!({
            "modes": instrument.modes.len() - instrument.resolved,
            "tip_share": rest(instrument.tip_shares()),
            "drive_share": rest(instrument.drive_shares()),
        });
        print_json(&answer)
    } else {
        print(&summary::modes_table(&instrument))
    }
}

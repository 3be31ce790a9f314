//! `afmsweep modes`: natural frequencies and shares of the scene's instrument, before any sweep.

use super::{SceneArgs, load, print, print_json};
use afmsweep::instrument::{DEFAULT_TOLERANCE, Instrument, summary};
use anyhow::Context;

pub fn main(args: &SceneArgs) -> anyhow::Result<()> {
    let scene = load(&args.scene)?;
    let instrument = Instrument::reduce(&scene.base.instrument, scene.base.drive.on, DEFAULT_TOLERANCE)
        .with_context(|| format!("{}", args.scene.display()))?;
    if args.json {
        print_json(&summary::modes_json(&instrument))
    } else {
        print(&summary::modes_table(&instrument))
    }
}

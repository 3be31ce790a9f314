//! `afmsweep modes`: natural frequencies and shares of the scene's first instance; of its lever in a fluid.

use super::{SceneArgs, load, print, print_json};
use afmsweep::instrument::{DEFAULT_TOLERANCE, Fluid, Instrument, InstrumentError, mode_summary, modes_in};
use afmsweep::plan::PlanError;
use afmsweep::scene::{Scene, SceneError};
use afmsweep::units::{Dimension, parse};
use serde_json::{Value, json};

#[derive(clap::Args)]
#[command(
    after_help = "Examples: afmsweep modes lever.toml\n          afmsweep modes lever.toml --fluid water"
)]
pub struct ModesArgs {
    #[command(flatten)]
    scene: SceneArgs,
    /// The lever alone in a fluid, by Sader's function: water, air, or density and viscosity as "998 kg/m^3, 1 mPa s"
    #[arg(long, value_name = "FLUID", value_parser = fluid)]
    fluid: Option<Fluid>,
}

/// A fluid by its name, or by its density and viscosity.
fn fluid(text: &str) -> Result<Fluid, String> {
    const FORM: &str = "write water, air, or a density and a viscosity such as \"998 kg/m^3, 1 mPa s\"";
    match text.trim() {
        "water" => return Ok(Fluid::WATER),
        "air" => return Ok(Fluid::AIR),
        _ => {}
    }
    let (density, viscosity) =
        text.split_once(',').ok_or_else(|| format!("no such fluid is known; {FORM}"))?;
    let value = |part: &str, dimension: Dimension| match parse(part, dimension) {
        Ok(value) if value.is_finite() && value > 0.0 => Ok(value),
        Ok(_) => Err(format!("{} is not {} above zero; {FORM}", part.trim(), dimension.described())),
        Err(error) => Err(format!("found {}, expected {}; {FORM}", error.found(), error.expected())),
    };
    Ok(Fluid {
        density: value(density, Dimension::Density)?,
        viscosity: value(viscosity, Dimension::Viscosity)?,
    })
}

pub fn main(args: &ModesArgs) -> anyhow::Result<()> {
    let scene = load(&args.scene.scene)?;
    let params = scene.instance(0);
    let refused = |source: InstrumentError| {
        PlanError::Instrument { instance: 0, values: String::new(), source }.in_scene(&scene)
    };
    if let Some(fluid) = args.fluid {
        let modes = modes_in(&params.instrument, fluid).map_err(refused)?;
        return match args.scene.json {
            true => print_json(&mode_summary::fluid_json(fluid, &modes)),
            false => print(&mode_summary::fluid_table(fluid, &modes)),
        };
    }
    let instrument =
        Instrument::reduce(&params.instrument, params.drive.on, DEFAULT_TOLERANCE).map_err(refused)?;
    match args.scene.json {
        true => print_json(&as_json(&instrument)),
        false => print(&mode_summary::modes_table(&instrument)),
    }
}

/// The modes of a scene's first instance.
///
/// # Errors
/// The instrument cannot be reduced.
pub fn answer(scene: &Scene) -> Result<Value, SceneError> {
    let params = scene.instance(0);
    let reduced = Instrument::reduce(&params.instrument, params.drive.on, DEFAULT_TOLERANCE);
    reduced.map(|instrument| as_json(&instrument)).map_err(|source| {
        PlanError::Instrument { instance: 0, values: String::new(), source }.in_scene(scene)
    })
}

fn as_json(instrument: &Instrument) -> Value {
    // The list ends where frequencies can no longer be vouched for; shares count all modes.
    let rest = |shares: Vec<f64>| shares[instrument.resolved..].iter().sum::<f64>();
    let mut answer = mode_summary::modes_json(instrument);
    answer["rest"] = json!({
        "modes": instrument.modes.len() - instrument.resolved,
        "tip_share": rest(instrument.tip_shares()),
        "drive_share": rest(instrument.drive_shares()),
    });
    answer
}

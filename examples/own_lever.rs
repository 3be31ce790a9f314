//! A lever given by its size: its modes, and what each adds to the tip's compliance.
//!
//! `cargo run --release --example own_lever`

use afmsweep::Scene;
use afmsweep::instrument::{DEFAULT_TOLERANCE, Instrument};
use std::path::Path;

const SCENE: &str = r#"
[instrument.actuator]
model = "rigid"
[instrument.cantilever]
length = "125 um"
width = "30 um"
thickness = "4 um"
youngs_modulus = "169 GPa"
density = "2330 kg/m^3"
quality_factor = 300
[instrument.tip]
mass = "2e-13 kg"
[drive]
on = "tip"
frequency = "resonance"
free_amplitude = "10 nm"
"#;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let scene = Scene::parse(Path::new("own_lever.toml"), SCENE)?;
    let params = scene.instance(0);
    let lever = Instrument::reduce(&params.instrument, params.drive.on, DEFAULT_TOLERANCE)?;
    println!("static stiffness of the tip: {:.4} N/m", 1.0 / lever.flexibility());
    println!("mode   frequency, kHz   Q        share of the compliance");
    for (n, mode) in lever.modes.iter().take(6).enumerate() {
        let share = mode.inverse_mass() / mode.omega.powi(2) / lever.flexibility();
        let frequency = mode.omega / std::f64::consts::TAU / 1e3;
        println!("{:4} {frequency:16.3} {:8.1} {share:14.2e}", n + 1, mode.quality_factor);
    }
    Ok(())
}

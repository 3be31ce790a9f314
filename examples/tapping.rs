//! Tapping on samples of different stiffness: amplitude, phase and largest force, and how good they are.
//!
//! `cargo run --release --example tapping`

use afmsweep::{Scene, Sweep};
use std::path::Path;

const SCENE: &str = r#"
title = "Tapping on soft to stiff samples"
[instrument.cantilever]
stiffness = "2 N/m"
frequency = "70 kHz"
quality_factor = 150
[instrument.tip]
radius = "8 nm"
youngs_modulus = "130 GPa"
[instrument.actuator]
model = "rigid"
[sample]
surface_energy = "30 mJ/m^2"
[contact]
law = "dmt"
[drive]
on = "tip"
frequency = "resonance"
free_amplitude = "20 nm"
[approach]
gap = "14 nm"
[sweep]
"sample.youngs_modulus" = { from = "100 MPa", to = "10 GPa", points = 9, scale = "log" }
[run]
steady = "search"
[output]
observables = ["amplitude", "phase", "force_max"]
"#;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let swept = Sweep::new(Scene::parse(Path::new("tapping.toml"), SCENE)?).run()?;
    let of = |name: &str| swept.results.observable(name).ok_or(format!("no {name}"));
    let (amplitude, phase, force) = (of("amplitude")?, of("phase")?, of("force_max")?);
    println!("modulus, GPa   amplitude, nm   phase, degree   largest force, nN");
    for (i, modulus) in amplitude.axes[0].values.iter().enumerate() {
        let (amplitude, force) = (amplitude.values[i] / 1e-9, force.values[i] / 1e-9);
        println!("{:12.3} {amplitude:15.4} {:15.3} {force:19.3}", modulus / 1e9, phase.values[i]);
    }
    println!("{}", swept.verdict.words());
    Ok(())
}

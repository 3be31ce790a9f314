//! One question, several scenes: how the choice of contact law moves the results, each run in a file of its own.
//!
//! `cargo run --release --example many_scenes`

use afmsweep::scene::LawChoice;
use afmsweep::{Precision, Scene, Sweep};
use std::path::Path;

const SCENE: &str = r#"
[instrument.cantilever]
stiffness = "2 N/m"
frequency = "70 kHz"
quality_factor = 50
[instrument.tip]
radius = "10 nm"
[instrument.actuator]
model = "rigid"
[sample]
youngs_modulus = "1 GPa"
surface_energy = "20 mJ/m^2"
[drive]
on = "tip"
frequency = "resonance"
free_amplitude = "20 nm"
[approach]
gap = "15 nm"
[run]
steady = "search"
[output]
observables = ["amplitude", "force_max", "dissipation"]
"#;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = std::env::temp_dir().join("afmsweep-many-scenes");
    std::fs::create_dir_all(&folder)?;
    for (name, law) in [("hertz", LawChoice::Hertz), ("dmt", LawChoice::Dmt), ("jkr", LawChoice::Jkr)] {
        let mut scene = Scene::parse(Path::new("many_scenes.toml"), SCENE)?;
        scene.base.contact.law = law;
        let swept = Sweep::new(scene).precision(Some(Precision::F64)).run()?;
        let of = |name: &str| swept.results.observable(name).map_or(f64::NAN, |one| one.values[0]);
        println!(
            "{name}: amplitude {:.3} nm, largest force {:.3} nN, {:.2e} J lost a period",
            of("amplitude") / 1e-9,
            of("force_max") / 1e-9,
            of("dissipation")
        );
        swept.results.write(&folder.join(name).with_extension("h5"), true)?;
    }
    println!("files: {}", folder.display());
    Ok(())
}

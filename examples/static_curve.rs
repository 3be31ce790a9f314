//! A contact law's static force over indentation, approach and retraction, without any motion.
//!
//! `cargo run --release --example static_curve`

use afmsweep::Scene;
use afmsweep::contact::Contact;
use std::path::Path;

const SCENE: &str = r#"
[instrument.cantilever]
quality_factor = 100
[instrument.tip]
radius = "10 nm"
[sample]
youngs_modulus = "1 GPa"
surface_energy = "60 mJ/m^2"
[contact]
law = "jkr"
[drive]
frequency = "resonance"
free_amplitude = "10 nm"
"#;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let scene = Scene::parse(Path::new("static_curve.toml"), SCENE)?;
    let contact = Contact::new(&scene.instance(0));
    println!("{}, Tabor's parameter {:.2}", contact.law, contact.tabor());
    let indentations: Vec<f64> = (-6..=6).map(|n| f64::from(n) * 0.5e-9).collect();
    for curve in contact.curves_at(&indentations).curves {
        println!("\n{}\nindentation, nm   force, nN", curve.branch.name());
        for (indentation, force) in curve.indentation_m.iter().zip(&curve.force_n) {
            let force = force.map_or("none".into(), |force| format!("{:.3}", force / 1e-9));
            println!("{:15.2} {force:>11}", indentation / 1e-9);
        }
    }
    Ok(())
}

//! What leaving modes out costs: measured by the reference with and without them, and as the run estimates it.

use afmsweep::compare::{Scales, error, worst};
use afmsweep::control;
use afmsweep::engine::{Cpu, Engine, Model, Progress, Reference};
use afmsweep::observe::{Observable, Status};
use afmsweep::plan::{Plan, Precision};
use afmsweep::scene::Scene;
use serde_json::{Value, json};
use std::path::Path;

/// One calibrated lever on samples from soft to stiff.
fn scene(accuracy: f64, modes: &str) -> Scene {
    let text = format!(
        r#"
[instrument.cantilever]
stiffness = "40 N/m"
frequency = "300 kHz"
quality_factor = 30
[instrument.actuator]
model = "rigid"
[instrument.tip]
radius = "10 nm"
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
"sample.youngs_modulus" = {{ values = ["1 MPa", "10 MPa", "100 MPa", "1 GPa", "10 GPa", "100 GPa"] }}
[run]
periods = 240
measure = 4
accuracy = {accuracy:e}
{modes}
"#
    );
    let mut scene = Scene::parse(Path::new("modes.toml"), &text).expect("the scene is right");
    scene.output.observables = Observable::all().filter(|one| *one != Observable::Contacts).collect();
    scene
}

/// The table, and its rows.
pub fn run() -> Vec<Value> {
    println!(
        "\nmodes left out: error against all modes, measured (reference with the kept ones and with all) and estimated"
    );
    println!(
        "{:<18}{:>12}{:>9}{:>11}{:>11}{:>11}{:>11}",
        "modes", "sample", "status", "measured", "estimated", "amplitude", "force_max"
    );
    let mut rows = Vec::new();
    for (name, accuracy, modes) in [
        ("1, as told", 1e-3, "modes = 1"),
        ("2, as told", 1e-3, "modes = 2"),
        ("chosen for 1e-2", 1e-2, ""),
        ("chosen for 1e-3", 1e-3, ""),
        ("chosen for 1e-4", 1e-4, ""),
    ] {
        let scene = scene(accuracy, modes);
        let plan = Plan::new(&scene, Precision::F64).expect("the scene can be planned");
        let run = control::run(&plan, &Cpu::default(), &Progress::default()).expect("the plan can be run");
        let by = |model| {
            let reference = Reference { tolerance: 1e-10, model };
            reference.run(&run.plan, &Progress::default()).expect("the plan can be run").results
        };
        let (kept, all) = (by(Model::Kept), by(Model::Whole));
        let count = run.plan.drives[0].kept.modes.len();
        for (i, modulus) in scene.sweep.axes[0].values.iter().enumerate() {
            let (ours, truth) = (&kept[i], &all[i]);
            let scales = Scales::of(&plan, i, &truth.measured);
            let of = |observable| error(observable, &ours.measured, &truth.measured, &scales);
            let measured = worst(&plan.observables, &ours.measured, &truth.measured, &scales);
            // Told how many modes to keep, the run does not look at what they leave out.
            let told = !modes.is_empty();
            let estimated = if told { f64::NAN } else { run.truncation[i] };
            let steady = ours.status == Status::Ok && truth.status == Status::Ok;
            println!(
                "{:<18}{:>9.0e} Pa{:>9}{measured:>11.1e}{:>11}{:>11.1e}{:>11.1e}",
                format!("{name} ({count})"),
                modulus,
                if steady { "ok" } else { "not ok" },
                if told { "-".into() } else { format!("{estimated:.1e}") },
                of(Observable::Amplitude),
                of(Observable::ForceMax),
            );
            rows.push(json!({
                "modes": name, "kept": count, "sample_modulus_pa": modulus, "steady": steady,
                "measured": measured, "estimated": if told { None } else { Some(estimated) },
                "amplitude": of(Observable::Amplitude), "force_max": of(Observable::ForceMax),
            }));
        }
    }
    rows
}

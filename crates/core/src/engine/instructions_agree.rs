//! All instruction sets that fuse give the same bits in whole runs.

use super::{Finished, Progress, cpu};
use crate::kernel::{Law, Rounding};
use crate::observe::Observable;
use crate::plan::{Plan, Precision};
use crate::scene::Scene;
use std::path::Path;

fn run(plan: &Plan, rounding: Rounding) -> Vec<Vec<u64>> {
    let bits = |one: &Finished| {
        let mut row = [0.0; 64];
        let mut bits = vec![one.status as u64];
        for observable in Observable::all() {
            let width = observable.width();
            observable.write(&one.measured, &mut row[..width]);
            bits.extend(row[..width].iter().map(|value| value.to_bits()));
        }
        bits
    };
    let class = |class| cpu::resume(plan, class, None, rounding, &Progress::default()).unwrap();
    plan.classes()
        .iter()
        .flat_map(|one| class(one).iter().map(|one| bits(&one.finished)).collect::<Vec<_>>())
        .collect()
}

/// What a law asks of a scene beside its word, by how its name ends: lines of the sample and sections after it.
const LOSSES: [(&str, &str); 3] = [
    ("-shaped", "[instrument.tip]\nshape = \"sphere\""),
    ("-viscous", "retardation_time = \"200 ns\""),
    ("-relaxing", "instantaneous_modulus = \"60 GPa\"\nrelaxation_time = \"200 ns\""),
];
const CHARGES: &str = "[[contact.outside]]\nforce = \"electrostatic\"\nbias = \"1 V\"\ncut_off = \"0.5 nm\"";
const NECK: &str = "[[contact.outside]]\nforce = \"capillary\"\nstrength = \"3 nN\"\nforms_at = \"0.4 nm\"\nbreaks_at = \"2 nm\"";

/// Registers of 256 and of 512 bits, one or two of them, for every law and number of modes.
#[test]
fn instruction_sets_that_fuse_give_the_same_bits() {
    let best = Rounding::new(false);
    for law in Law::ALL.into_iter().filter(|law| law.acts()) {
        let name = law.name();
        let viscosity = LOSSES.iter().find(|(end, _)| name.ends_with(end)).map_or("", |(_, loss)| *loss);
        let (word, outside) = match name {
            "sum-jkr" => ("jkr", CHARGES),
            "sum-hysteretic" => ("dmt", NECK),
            _ if name.starts_with("sum") => ("dmt", CHARGES),
            _ => (name.split('-').next().unwrap_or(name), ""),
        };
        for modes in 1..=8 {
            let text = format!(
                r#"
[instrument.cantilever]
stiffness = "10 N/m"
frequency = "75 kHz"
quality_factor = 30
[instrument.actuator]
model = "rigid"
[sample]
surface_energy = "20 mJ/m^2"
{viscosity}
[contact]
law = "{word}"
[drive]
on = "tip"
frequency = "75 kHz"
free_amplitude = "30 nm"
[approach]
gap = "22 nm"
[sweep]
"sample.youngs_modulus" = {{ values = ["300 MPa", "3 GPa", "30 GPa"] }}
"approach.gap" = {{ values = ["-2 nm", "15 nm", "24 nm", "29.99 nm", "31 nm"] }}
[run]
periods = 12
measure = 5
modes = {modes}
steps_per_period = {}
{outside}
"#,
                if modes > 4 { 512 } else { 128 }
            );
            let mut scene = Scene::parse(Path::new("lanes.toml"), &text).unwrap();
            scene.output.observables = Observable::all().collect();
            for precision in [Precision::F32, Precision::F64] {
                let plan = Plan::new(&scene, precision).unwrap();
                let what = format!("{law}, {modes} modes, {}", precision.name());
                let (fused, strict) = (run(&plan, best), run(&plan, Rounding::STRICT));
                assert!(fused == run(&plan, best.least()), "{what}");
                // Without fused operations there is one rounding only.
                assert_eq!(fused == strict, best == Rounding::STRICT, "{what}");
            }
        }
    }
}

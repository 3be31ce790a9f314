//! The largest force by few oscillators: the lowest modes against a reduction of the tip's compliance.

use afmsweep::engine::{Cpu, Engine, Finished, Progress, Reference, solve_near};
use afmsweep::observe::Status;
use afmsweep::orbit;
use afmsweep::plan::{BasisRule, Plan, Precision};
use afmsweep::scene::Scene;
use serde_json::{Value, json};
use std::path::Path;
use std::time::Instant;

/// Of both bases.
const COUNTS: [usize; 6] = [4, 6, 8, 12, 16, 20];
/// So many that they cost nothing beside the modes left out.
const STEPS: u32 = 16_384;

/// A soft lever in a liquid on samples from soft to stiff.
fn scene(modes: &str) -> Scene {
    let text = format!(
        r#"
[instrument.cantilever]
stiffness = "0.1 N/m"
frequency = "30 kHz"
quality_factor = 3
[instrument.tip]
radius = "10 nm"
[contact]
law = "hertz"
[drive]
on = "tip"
frequency = "30 kHz"
free_amplitude = "30 nm"
[approach]
gap = "21 nm"
[sweep]
"sample.youngs_modulus" = {{ values = ["10 MPa", "100 MPa", "1 GPa", "10 GPa", "100 GPa"] }}
[run]
steady = "search"
periods = 100
measure = 4
accuracy = 1e-3
{modes}
[output]
observables = ["amplitude", "force_max"]
"#
    );
    Scene::parse(Path::new("basis.toml"), &text).expect("the scene is right")
}

fn plan(modes: &str) -> Plan {
    Plan::new(&scene(modes), Precision::F64).expect("the scene can be planned")
}

/// The largest force of each instance, N, and the seconds it took; not a number where none is found.
fn forces(plan: &Plan) -> (Vec<f64>, f64) {
    let start = Instant::now();
    let run = orbit::solve(&plan.clone().with_steps(|_| STEPS), &[], &Cpu::default(), &Progress::default());
    let results = run.expect("the plan can be run").outcome.results;
    let force = |one: &Finished| if one.status == Status::Ok { one.measured.force_max } else { f64::NAN };
    (results.iter().map(force).collect(), start.elapsed().as_secs_f64())
}

/// The table, and its rows.
pub fn run() -> Vec<Value> {
    println!("\nlargest force by few oscillators: error against all modes");
    let whole = plan("");
    let all: Vec<u32> = whole.instances().collect();
    let fine = whole.clone().with_steps(|_| STEPS);
    let run = orbit::solve(&fine, &[], &Cpu::default(), &Progress::default()).expect("the plan can be run");
    let reference = Reference { tolerance: 1e-12, ..Reference::default() };
    let truth = |i: &u32| {
        let station =
            run.found[*i as usize].as_ref().expect("a tap of a lever in a liquid is steady").section;
        let found = solve_near(&fine, *i as usize, &station, &reference, &Progress::default());
        found.expect("the plan has it").expect("the reference finds it").measured
    };
    let truths: Vec<_> = all.iter().map(truth).collect();
    println!("reference: {}", reference.device());
    let mut rows = Vec::new();
    for count in COUNTS {
        let modes = plan(&format!("modes = {count}"));
        // The rate is the plan's own: of the lever that it chose for the contact, or the drive's where it chose none.
        let rate = |i: u32| match whole.basis_rule(i) {
            BasisRule::Contact { rate, .. } => rate,
            _ => 4.0 * whole.drives[0].free.omega,
        };
        // What this measures is the reduction alone: steps follow all of its oscillators.
        let rule = |i: u32| BasisRule::Contact { rate: rate(i), count, elastic: false, resonant: false };
        let wanted: Vec<(u32, BasisRule)> = all.iter().map(|i| (*i, rule(*i))).collect();
        let (lowest, reduced) = (forces(&modes), forces(&whole.with_bases(&wanted)));
        for (i, modulus) in scene("").sweep.axes[0].values.iter().enumerate() {
            let error = |force: f64| (force / truths[i].force_max - 1.0).abs();
            let (a, b) = (error(lowest.0[i]), error(reduced.0[i]));
            println!("{count:>4} {modulus:>8.0e} Pa  lowest modes {a:>9.1e}  reduction {b:>9.1e}");
            rows.push(json!({
                "oscillators": count, "sample_modulus_pa": modulus, "contact_time": truths[i].contact_time,
                "lowest_modes": a, "reduction": b,
                "seconds_lowest": lowest.1, "seconds_reduction": reduced.1,
            }));
        }
    }
    rows
}

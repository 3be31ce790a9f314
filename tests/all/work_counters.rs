//! How much work runs take, frozen: a control loop, a search or an integrator that began to work harder for the same
//! results would show here. Numbers are this program's own, at the commit that last changed them for a reason.

use afmsweep::control;
use afmsweep::engine::{Cpu, Progress, Reference, solve};
use afmsweep::plan::{Plan, Precision};
use afmsweep::scene::Scene;
use std::path::Path;

/// Other mathematical libraries round sines and exponentials otherwise in the last bit, which may move a decision.
const TOLERANCE: f64 = 0.02;

fn plan(name: &str) -> Plan {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("tests/hard/{name}.toml"));
    Plan::new(&Scene::load(&path).unwrap(), Precision::F64).unwrap()
}

fn same(what: &str, seen: &[f64], frozen: &[f64]) {
    println!("{what}: {seen:?}");
    let close = |(seen, frozen): (&f64, &f64)| (seen - frozen).abs() <= TOLERANCE * frozen;
    let all = seen.len() == frozen.len() && seen.iter().zip(frozen).all(close);
    assert!(all, "{what}: {seen:?} where {frozen:?} were frozen");
}

/// Instance-steps of the whole run, steps per period and periods of its last run.
#[test]
fn runs_to_an_accuracy_take_as_many_steps_as_before() {
    for (name, frozen) in [
        ("adhesion_1", [67_344.0, 96.0, 61.0]),
        ("soft_0.5_hertz", [16_384.0, 2048.0, 3.0]),
        ("tip_mass_jkr", [8960.0, 512.0, 2.0]),
        ("q_1e5_search", [16_768.0, 64.0, 2.0]),
    ] {
        same(name, &counted(name, Cpu::default()), &frozen);
    }
}

/// Instance-steps of each kind of sweep: a grid by neighbours, a curve both ways, set-points, both branches, a design.
#[test]
fn sweeps_of_each_kind_take_as_many_steps_as_before() {
    let counted = |name: &str| {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("scenes/{name}.toml"));
        // Fewer of those that there are thousands of: what a set-point or a member of a design costs is the same.
        let few = [
            (
                "from = \"200 MPa\", to = \"20 GPa\", points = 21",
                "from = \"200 MPa\", to = \"20 GPa\", points = 6",
            ),
            ("from = 0.3, to = 0.98, points = 35", "from = 0.3, to = 0.98, points = 8"),
            ("waveforms = { instances = [0, 1400]", "waveforms = { instances = [0]"),
            ("samples = 2048", "samples = 512"),
        ];
        let text = std::fs::read_to_string(&path).unwrap();
        let text = few.iter().fold(text, |text, (from, to)| text.replace(from, to));
        let plan = Plan::new(&Scene::parse(&path, &text).unwrap(), Precision::F64).unwrap();
        let progress = Progress::default();
        control::run(&plan, &Cpu { strict: true }, &progress).unwrap();
        progress.steps() as f64
    };
    let scenes = ["phase_map", "approach_curve", "set_point", "bistable", "sensitivity"];
    same(
        &scenes.join(", "),
        &scenes.map(counted),
        &[2_030_336.0, 4_963_952.0, 6_826_112.0, 209_760.0, 5_037_120.0],
    );
}

/// The same where searches go as on devices.
#[test]
fn searches_as_on_devices_take_as_many_steps_as_before() {
    let name = "q_1e5_search";
    same(name, &counted(name, Cpu { strict: true }), &[4288.0, 64.0, 2.0]);
}

fn counted(name: &str, engine: Cpu) -> [f64; 3] {
    let progress = Progress::default();
    let run = control::run(&plan(name), &engine, &progress).unwrap();
    let steps = run.plan.cases().map(|case| f64::from(case.steps)).sum();
    let periods = run.periods.iter().copied().map(f64::from).sum();
    [progress.steps() as f64, steps, periods]
}

/// Steps taken, steps tried in vain, evaluations, events.
#[test]
fn the_reference_takes_as_many_evaluations_as_before() {
    for (name, frozen) in [
        ("jkr_edge_lets_go", [13_189.0, 1403.0, 193_041.0, 400.0]),
        ("tip_mass_dmt", [151_459.0, 1533.0, 1_881_207.0, 400.0]),
    ] {
        let options = Reference { tolerance: 1e-8, ..Reference::default() };
        let (_, work) = solve(&plan(name), 0, &options).unwrap();
        let seen = [work.accepted, work.rejected, work.evaluations, work.events].map(|count| count as f64);
        same(name, &seen, &frozen);
    }
}

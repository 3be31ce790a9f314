//! The precision that error control chooses, against runs in f64 and against the reference engine.

use crate::program::Desk;
use afmsweep::compare::{Scales, worst};
use afmsweep::control::{self, MemoryJournal, RunResult};
use afmsweep::engine::{Cpu, Progress};
use afmsweep::observe::Status;
use afmsweep::plan::{Plan, Precision};
use afmsweep::scene::Scene;
use std::path::Path;

/// A lever of one mode on samples from soft to stiff, from taps to grazes: 1,200 instances.
fn sweep(quality_factor: f64, accuracy: f64) -> String {
    let periods = 20 + (7.0 * quality_factor) as u32;
    format!(
        "[instrument.actuator]\nmodel = \"rigid\"\n[instrument.cantilever]\n\
         modes = [{{ stiffness = \"5 N/m\", frequency = \"75 kHz\", quality_factor = {quality_factor} }}]\n\
         [contact]\nlaw = \"hertz\"\n[drive]\non = \"tip\"\nfrequency = \"75 kHz\"\n\
         free_amplitude = \"20 nm\"\n[run]\nperiods = {periods}\nmeasure = 4\naccuracy = {accuracy:e}\n[sweep]\n\
         \"sample.youngs_modulus\" = {{ from = \"10 MPa\", to = \"10 GPa\", points = 60, scale = \"log\" }}\n\
         \"approach.gap\" = {{ from = \"10 nm\", to = \"19.9999 nm\", points = 20 }}\n\
         [output]\nobservables = [\"amplitude\", \"phase\", \"force_max\", \"virial\"]\n"
    )
}

fn plan(text: &str, precision: Precision, open: bool) -> Plan {
    let scene = Scene::parse(Path::new("sweep.toml"), text).unwrap_or_else(|error| panic!("{error}"));
    let mut plan = Plan::new(&scene, precision).unwrap();
    plan.precision_open = open;
    plan
}

fn run(plan: &Plan) -> RunResult {
    control::run(plan, &Cpu::default(), &Progress::default()).unwrap()
}

fn in_single(run: &RunResult) -> usize {
    run.arithmetic.of.iter().filter(|one| **one == Precision::F32).count()
}

#[test]
fn single_where_its_rounding_is_small() {
    let text = sweep(20.0, 1e-3);
    let ours = run(&plan(&text, Precision::F64, true));
    assert_eq!(ours.plan.precision, Precision::F32, "{}", ours.arithmetic.reason);
    assert!(ours.arithmetic.rounding > 0.0 && ours.arithmetic.rounding < 1e-4);
    // Grazes need more than one refinement.
    let (single, count) = (in_single(&ours), ours.plan.len());
    assert!(single > count / 2 && single < count, "{single} of {count}");
    assert_eq!(ours.arithmetic.name(), "mixed");
    let double = run(&plan(&text, Precision::F64, false));
    assert_eq!(in_single(&double), 0);
    let mut differ = 0;
    for (i, (a, b)) in ours.results.iter().zip(double.results.iter()).enumerate() {
        assert_eq!((a.status, b.status), (Status::Ok, Status::Ok), "instance {i}");
        let scales = Scales::of(&double.plan, i, &b.measured);
        let apart = worst(&double.plan.observables, &a.measured, &b.measured, &scales);
        assert!(apart < 1e-3, "instance {i}: {apart:e}");
        assert!(ours.estimates[i] <= 1e-3 && ours.estimates[i] > 0.0);
        differ += usize::from(apart > 0.0);
    }
    assert!(differ >= single, "{differ} of {single} are rounded");
    let audited = control::audit(&ours, 40, &MemoryJournal::default(), &Progress::default()).unwrap();
    assert_eq!(audited.len(), 40);
    for one in audited {
        assert!(one.worst.is_some_and(|error| error < 1e-3), "instance {}: {:?}", one.instance, one.worst);
    }
}

/// Rounding of 6e-8 a step is not to be had below some 1e-6, and counts once more for every period that is remembered.
#[test]
fn double_where_rounding_would_show() {
    for (quality_factor, accuracy) in [(20.0, 1e-5), (1000.0, 1e-3)] {
        let text = sweep(quality_factor, accuracy);
        let ours = run(&plan(&text, Precision::F64, true));
        assert_eq!(ours.plan.precision, Precision::F64, "{quality_factor}: {}", ours.arithmetic.reason);
        assert!(ours.arithmetic.rounding > 0.1 * accuracy, "{quality_factor}: {:?}", ours.arithmetic);
        assert_eq!((in_single(&ours), ours.arithmetic.name()), (0, "f64"));
    }
}

#[test]
fn what_is_told_is_obeyed() {
    let text = sweep(20.0, 1e-3);
    for precision in [Precision::F32, Precision::F64] {
        let ours = run(&plan(&text, precision, false));
        assert_eq!(ours.arithmetic.name(), precision.name());
        // What f32 costs is known from a sample; of f64 nobody asks.
        assert_eq!(ours.arithmetic.rounding.is_nan(), precision == Precision::F64);
    }
    // Nothing to choose by: the default stays.
    for change in ["steps_per_period = 128", "start = \"rest\"", "steady = \"search\""] {
        let plan = plan(&text.replace("[run]\n", &format!("[run]\n{change}\n")), Precision::F64, true);
        assert!(plan.precision_settled().is_some(), "{change}");
    }
    let few = plan(&text.replace("points = 60", "points = 6"), Precision::F64, true);
    let ours = run(&few);
    assert_eq!(ours.arithmetic.name(), "f64");
    assert!(ours.arithmetic.reason.contains("too few"), "{}", ours.arithmetic.reason);
}

/// The choice as a user sees it.
#[test]
fn the_choice_is_told_and_kept_in_the_file() {
    let desk = Desk::new();
    let scene = desk.write("sweep.toml", &sweep(20.0, 1e-3));
    let path = scene.to_str().unwrap();
    let said = desk.works(&["plan", path]).out;
    assert!(said.contains("precision f64, or by a trial of both"), "{said}");
    assert_eq!(desk.json(&["plan", path, "--json"])["precision_by_trial"], true);
    let said = desk.works(&["run", path, "--no-audit"]).err;
    assert!(said.contains("\nprecision: f32: it moves a sample of 6"), "{said}");
    let results = afmsweep::store::read(&desk.results(&scene)).unwrap();
    assert_eq!(results.text("precision"), Some("mixed"));
    assert!(results.text("precision_reason").unwrap().contains("moves a sample"));
    let flag = results.flags.iter().find(|flags| flags.name == "precision").expect("which is which");
    assert_eq!(flag.meanings, ["f32", "f64"]);
    let double = flag.data.iter().filter(|code| **code == 1).count();
    let instances = if double == 1 { "instance" } else { "instances" };
    assert!(double > 0 && said.contains(&format!("; {double} {instances} went on in f64")), "{said}");
    let said = desk.works(&["run", path, "--no-audit", "--precision", "f64"]).err;
    assert!(said.contains("precision: f64: as told"), "{said}");
    let results = afmsweep::store::read(&desk.results(&scene)).unwrap();
    assert_eq!(results.text("precision"), Some("f64"));
    assert!(results.flags.iter().all(|flags| flags.name != "precision"));
    let said = desk.works(&["run", path, "--no-audit", "--no-estimate"]).err;
    assert!(said.contains("precision: f64: nothing to choose it by"), "{said}");
}

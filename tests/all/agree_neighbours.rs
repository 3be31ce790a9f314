//! Instances that begin at their neighbours' states against the same ones searched for by themselves, and against
//! themselves on other threads and in another order.

use afmsweep::compare::{Scales, worst};
use afmsweep::observe::{Observable, Status};
use afmsweep::{Audit, Backend, Scene, Sweep, SweepOutcome};
use std::path::Path;

/// Three axes, one of which changes the drive.
const GRID: &str = r#"
[sweep]
"sample.youngs_modulus" = { from = "1 GPa", to = "10 GPa", points = 12, scale = "log" }
"drive.free_amplitude" = { from = "19 nm", to = "22 nm", points = 10 }
"approach.gap" = { from = "13 nm", to = "16 nm", points = 10 }
"#;
/// Points of the same and of levers, which are copies of each other but for their scale and their quality factor.
const DESIGN: &str = r#"
[uncertain]
"sample.youngs_modulus" = { distribution = "loguniform", from = "1 GPa", to = "10 GPa" }
"drive.free_amplitude" = { distribution = "uniform", from = "19 nm", to = "22 nm" }
"approach.gap" = { distribution = "uniform", from = "13 nm", to = "16 nm" }
"instrument.cantilever.stiffness" = { distribution = "uniform", from = "20 N/m", to = "60 N/m" }
"instrument.cantilever.frequency" = { distribution = "uniform", from = "200 kHz", to = "400 kHz" }
"instrument.cantilever.quality_factor" = { distribution = "uniform", from = 60, to = 95 }
[design]
kind = "latin-hypercube"
samples = 2000
"#;

fn scene(law: &str, swept: &str) -> Scene {
    let lever = match swept {
        DESIGN => {
            "stiffness = \"40 N/m\"\nfrequency = \"300 kHz\"\nquality_factor = 100\n[instrument.actuator]\nmodel = \"rigid\""
        }
        _ => "modes = [{ stiffness = \"40 N/m\", frequency = \"300 kHz\", quality_factor = 100 }]",
    };
    let text = format!(
        r#"
[instrument.cantilever]
{lever}
[instrument.tip]
radius = "10 nm"
[sample]
surface_energy = "20 mJ/m^2"
[contact]
law = "{law}"
[drive]
on = "tip"
frequency = "resonance"
free_amplitude = "20 nm"
[approach]
gap = "15 nm"
{swept}
[run]
steady = "search"
accuracy = 1e-3
[output]
observables = ["amplitude", "phase", "force_max", "dissipation"]
"#
    );
    Scene::parse(Path::new("grid.toml"), &text).unwrap_or_else(|error| panic!("{error}"))
}

fn run(scene: &Scene, cold: bool, threads: usize) -> SweepOutcome {
    let sweep = Sweep::new(scene.clone()).backend(Backend::Cpu).audit(Audit::None);
    sweep.cold(cold).threads(Some(threads)).run().unwrap_or_else(|error| panic!("{error}"))
}

/// Truth: each instance by itself, from its free oscillation: no lever here rings long enough for harmonic balance.
#[test]
fn what_neighbours_lead_to_is_what_a_search_finds() {
    for (law, swept) in [("hertz", GRID), ("dmt", GRID), ("jkr", GRID), ("dmt", DESIGN), ("jkr", DESIGN)] {
        let scene = scene(law, swept);
        let (ours, cold) = (run(&scene, false, 2), run(&scene, true, 2));
        let plan = &cold.run.plan;
        let mut largest: f64 = 0.0;
        for i in 0..plan.len() {
            let (a, b) = (&ours.run.results.get(i), &cold.run.results.get(i));
            assert_eq!(a.status, b.status, "{law}, instance {i}");
            if b.status != Status::Ok {
                continue;
            }
            let error = worst(&plan.observables, &a.measured, &b.measured, &Scales::of(plan, i, &b.measured));
            // Two refinements that end at other steps are each within the accuracy.
            let same = ours.run.plan.steps(i as u32) == plan.steps(i as u32);
            let bound = if same { 0.5 } else { 2.0 };
            assert!(error < bound * plan.run.accuracy, "{law}, instance {i}: {error:e}");
            largest = largest.max(error);
        }
        let started = ours.run.neighbour_started();
        println!(
            "{law}: {started:.3} begun at neighbours, largest difference {largest:.1e}, {} steps for {}",
            ours.steps_taken, cold.steps_taken
        );
        assert!(started > 0.7, "{law}: {started}");
        assert!(cold.run.neighbour_started.is_empty());
        // Of a grid the trials, which cost as much, are less.
        let gain = if swept == GRID { 2.0 } else { 1.5 };
        assert!(gain * ours.steps_taken as f64 <= cold.steps_taken as f64, "{law}");
    }
}

/// Half of them beyond the free amplitude, which is 20 nm.
const BEYOND: [&str; 2] = [
    r#"
[sweep]
"sample.youngs_modulus" = { from = "1 GPa", to = "10 GPa", points = 20, scale = "log" }
"approach.gap" = { from = "15 nm", to = "25 nm", points = 56 }
"#,
    r#"
[uncertain]
"sample.youngs_modulus" = { distribution = "loguniform", from = "1 GPa", to = "10 GPa" }
"approach.gap" = { distribution = "uniform", from = "15 nm", to = "25 nm" }
[design]
kind = "monte-carlo"
samples = 1100
"#,
];

/// Truth: the free oscillation, in closed form, and for the others each instance by itself.
#[test]
fn what_never_touches_has_its_free_oscillation() {
    for (law, swept) in ["hertz", "jkr", "dmt"].into_iter().flat_map(|law| BEYOND.map(|swept| (law, swept))) {
        let scene = scene(law, swept);
        let (ours, cold) = (run(&scene, false, 2), run(&scene, true, 2));
        let plan = &cold.run.plan;
        let mut free = 0;
        for i in 0..plan.len() {
            let (a, b) = (&ours.run.results.get(i), &cold.run.results.get(i));
            // Neighbours may lead to a state that an instance by itself does not find, as of a tip that sticks now and then.
            let found = (a.status, b.status) == (Status::Ok, Status::NotSteady);
            assert!(a.status == b.status || found, "{law}, instance {i}: {:?} for {:?}", a.status, b.status);
            assert_ne!(a.status, Status::NotRun, "{law}, instance {i}");
            if law != "dmt" && plan.case(i as u32).gap > 20.001e-9 {
                let amplitude = plan.driven(i as u32).free_amplitude();
                assert_eq!(
                    (a.status, a.measured.harmonics[0]),
                    (Status::Ok, amplitude),
                    "{law}, instance {i}"
                );
                assert_eq!((a.measured.force_max, ours.run.estimates[i]), (0.0, 0.0), "{law}, instance {i}");
                free += 1;
            }
        }
        assert!(ours.verdict.met() && ours.missing.is_empty(), "{law}: {}", ours.verdict.words());
        assert!(law == "dmt" || free > 400, "{law}: {free}");
    }
}

/// Every number's bits, the status, the estimate.
fn bits(swept: &SweepOutcome, i: usize) -> Vec<u64> {
    let result = &swept.run.results.get(i);
    let mut bits = vec![result.status as u64, swept.run.estimates[i].to_bits()];
    let mut row = vec![0.0; 64];
    for observable in Observable::all() {
        let width = observable.width();
        observable.write(&result.measured, &mut row[..width]);
        bits.extend(row[..width].iter().map(|value: &f64| value.to_bits()));
    }
    bits
}

#[test]
fn threads_change_no_bit_of_a_design() {
    let scene = scene("jkr", DESIGN);
    let (one, two) = (run(&scene, false, 1), run(&scene, false, 2));
    assert!(one.run.neighbour_started() > 0.7, "{}", one.run.neighbour_started());
    assert!((0..one.run.plan.len()).all(|i| bits(&one, i) == bits(&two, i)));
}

#[test]
fn threads_and_order_change_no_bit() {
    let scene = scene("dmt", GRID);
    let one = run(&scene, false, 1);
    let count = one.run.plan.len();
    let all: Vec<_> = (0..count).map(|i| bits(&one, i)).collect();
    let two = run(&scene, false, 2);
    assert!((0..count).all(|i| bits(&two, i) == all[i]), "two threads");
    let mut turned = scene.clone();
    turned.sweep.axes.iter_mut().for_each(|axis| std::sync::Arc::make_mut(&mut axis.values).reverse());
    let back = run(&turned, false, 2);
    // All axes reversed: the instances come in reverse order.
    let other: Vec<usize> = (0..count).filter(|i| bits(&back, count - 1 - i) != all[*i]).collect();
    assert!(
        other.is_empty(),
        "{} of {count} in another order, {:?}",
        other.len(),
        &other[..other.len().min(9)]
    );
}

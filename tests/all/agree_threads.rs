//! An instance's result does not depend on how it is run: threads, neighbours, order, to the bit, whether
//! sums of products round once or twice; the two roundings and the two precisions agree within bounds.

use crate::checks;
use crate::checks::{bounds, worst};
use crate::program::Desk;
use afmsweep::contact::Law;
use afmsweep::engine::{Cpu, Engine, Finished, Progress, on_threads};
use afmsweep::observe::{Observable, Status};
use afmsweep::plan::{Plan, Precision};
use afmsweep::scene::{Scene, Start, SweptAxes, TipShape, Viscosity};
use std::path::Path;
use std::time::{Duration, Instant};

const STARTS: [&str; 2] = ["steady", "rest"];

/// The words of a scene.
fn laws() -> impl Iterator<Item = &'static str> {
    Law::ALL.map(Law::name).into_iter().chain(["auto"])
}

/// Three axes, one of which changes the instrument's drive.
fn sweep(law: &str, start: &str, periods: u32) -> Scene {
    let word = checks::law_word(law);
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
[contact]
law = "{word}"
[drive]
on = "tip"
frequency = "75 kHz"
free_amplitude = "30 nm"
[approach]
gap = "22 nm"
[sweep]
"sample.youngs_modulus" = {{ values = ["300 MPa", "3 GPa"] }}
"drive.frequency" = {{ values = ["74 kHz", "75 kHz"] }}
"approach.gap" = {{ values = ["15 nm", "24 nm", "31 nm"] }}
[run]
start = "{start}"
periods = {periods}
measure = 5
"#
    );
    let mut scene = Scene::parse(Path::new("test.toml"), &text).unwrap_or_else(|error| panic!("{error}"));
    scene.output.observables = Observable::all().collect();
    if law.starts_with("sum") {
        scene.base.contact.outside = checks::outside_forces(law);
    }
    if law.ends_with("-viscous") {
        scene.base.sample.viscosity = Viscosity::RetardationTime(2e-7);
    } else if law.ends_with("-shaped") {
        scene.base.instrument.tip.shape = TipShape::Sphere;
    } else if law.ends_with("-relaxing") {
        scene.base.sample.viscosity = Viscosity::Relaxing { modulus: 6e9, time: 2e-7 };
    }
    scene
}

/// The same, where a rule would take thousands of steps a period in hundreds: the bits tell no more by them.
fn in_few_steps(law: &str, start: &str, periods: u32) -> Scene {
    let mut scene = sweep(law, start, periods);
    if law.contains("viscous") {
        scene.run.steps_per_period = Some(384);
    }
    scene
}

fn run(plan: &Plan, threads: usize) -> Vec<Finished> {
    run_in(plan, threads, false)
}

fn run_in(plan: &Plan, threads: usize, strict: bool) -> Vec<Finished> {
    let run = || Cpu { strict }.run(plan, &Progress::default()).expect("the plan can be run").results;
    on_threads(Some(threads), run).expect("there are threads")
}

/// Every number's bits, and the status.
fn bits(result: &Finished) -> Vec<u64> {
    let mut bits = vec![result.status as u64];
    let mut row = vec![0.0; 64];
    for observable in Observable::all() {
        let width = observable.width();
        observable.write(&result.measured, &mut row[..width]);
        bits.extend(row[..width].iter().map(|value: &f64| value.to_bits()));
    }
    bits
}

fn every_kind(check: impl Fn(&Scene, Precision, &str)) {
    for law in laws() {
        for start in STARTS {
            for precision in [Precision::F32, Precision::F64] {
                let name = format!("{law}, {start}, {}", precision.name());
                check(&in_few_steps(law, start, 30), precision, &name);
            }
        }
    }
}

#[test]
fn threads_change_no_bit() {
    every_kind(|scene, precision, name| {
        let plan = checks::plan_in(scene, None, precision);
        let one: Vec<_> = run(&plan, 1).iter().map(bits).collect();
        let strict: Vec<_> = run_in(&plan, 1, true).iter().map(bits).collect();
        for threads in [2, 5] {
            let more: Vec<_> = run(&plan, threads).iter().map(bits).collect();
            assert_eq!(one, more, "{name}, {threads} threads");
            let more: Vec<_> = run_in(&plan, threads, true).iter().map(bits).collect();
            assert_eq!(strict, more, "{name}, {threads} threads, strict");
        }
        // A test that everything is the same must not be passed by nothing at all.
        let distinct: std::collections::BTreeSet<_> = one.iter().collect();
        let least = if name.starts_with("none") { 2 } else { 6 };
        assert!(distinct.len() >= least, "{name}: only {} distinct results", distinct.len());
    });
}

#[test]
fn an_instance_alone_is_the_same() {
    every_kind(|scene, precision, name| {
        let plan = checks::plan_in(scene, None, precision);
        let all = run(&plan, 2);
        for (instance, result) in all.iter().enumerate() {
            let mut alone = scene.clone();
            alone.base = scene.instance(instance);
            alone.sweep = SweptAxes::default();
            let plan = checks::plan_in(&alone, None, precision);
            assert_eq!(bits(&run(&plan, 1)[0]), bits(result), "{name}, instance {instance}");
        }
    });
}

#[test]
fn order_changes_no_bit() {
    every_kind(|scene, precision, name| {
        let mut turned = scene.clone();
        for axis in &mut turned.sweep.axes {
            std::sync::Arc::make_mut(&mut axis.values).reverse();
        }
        // All axes reversed: the instances come in reverse order.
        let there: Vec<_> = run(&checks::plan_in(scene, None, precision), 2).iter().map(bits).collect();
        let back: Vec<_> =
            run(&checks::plan_in(&turned, None, precision), 2).iter().rev().map(bits).collect();
        assert_eq!(there, back, "{name}");
        turned.sweep.axes.rotate_left(1);
        let plan = checks::plan_in(&turned, None, precision);
        let mixed = run(&plan, 2);
        for (instance, result) in mixed.iter().enumerate() {
            let params = turned.instance(instance);
            let same = (0..scene.len()).find(|&i| scene.instance(i) == params).expect("same instances");
            assert_eq!(bits(result), there[same], "{name}, instance {instance} of the permuted sweep");
        }
    });
}

#[test]
fn what_is_not_asked_for_changes_no_bit() {
    let scene = sweep("dmt", "steady", 30);
    let mut lean = scene.clone();
    lean.output.observables = vec![Observable::Amplitude, Observable::Phase];
    for precision in [Precision::F32, Precision::F64] {
        let full = run(&checks::plan_in(&scene, None, precision), 2);
        let lean = run(&checks::plan_in(&lean, None, precision), 2);
        for (a, b) in full.iter().zip(&lean) {
            assert_eq!(a.measured.harmonics[0].to_bits(), b.measured.harmonics[0].to_bits());
            assert_eq!(a.measured.phase.to_bits(), b.measured.phase.to_bits());
            assert!(b.measured.force_max.is_nan() && b.measured.dissipation.is_nan());
        }
    }
}

/// Rounding once or twice moves last bits only, which a stable response does not amplify.
#[test]
fn the_two_roundings_agree() {
    let (mut largest, mut compared): (f64, _) = (0.0, 0);
    for law in laws() {
        let plan = checks::plan_in(&in_few_steps(law, "steady", 160), None, Precision::F64);
        let (once, twice) = (run(&plan, 2), run_in(&plan, 2, true));
        for (instance, (a, b)) in once.iter().zip(&twice).enumerate() {
            if b.status != Status::Ok {
                continue;
            }
            assert_eq!(a.status, b.status, "{law}, instance {instance}");
            let truth = checks::outcome(&b.measured);
            let errors = checks::errors(&a.measured, &truth, &checks::scales(&plan, instance, &truth));
            largest = largest.max(worst(&errors).1);
            assert!(largest <= bounds::ROUNDING, "{law}, {instance}: {}", checks::show(&errors));
            compared += 1;
        }
    }
    println!("{compared} instances, largest difference {largest:.1e}");
    assert!(compared >= 60, "only {compared} instances compared");
}

#[test]
fn f32_is_as_accurate_as_asked() {
    let mut compared = 0;
    for law in laws() {
        for start in STARTS {
            // The levers of slow contacts: of fast ones a run's own trial of precision says how f32 serves them.
            let mut scene = sweep(law, start, 300);
            scene.run.modes = Some(4);
            let plans =
                [Precision::F32, Precision::F64].map(|precision| checks::plan_in(&scene, None, precision));
            let [rough, fine] = [run(&plans[0], 2), run(&plans[1], 2)];
            for (instance, (a, b)) in rough.iter().zip(&fine).enumerate() {
                if b.status != Status::Ok {
                    continue;
                }
                assert_eq!(a.status, b.status, "{law}, {start}, instance {instance}");
                let truth = checks::outcome(&b.measured);
                let mut steady = plans[1].clone();
                steady.run.start = Start::Steady;
                let scales = checks::scales(&steady, instance, &truth);
                let errors = checks::errors(&a.measured, &truth, &scales);
                let (which, error) = worst(&errors);
                println!("{law}, {start}, instance {instance}: largest difference {error:.1e} ({which})");
                assert!(error <= bounds::SINGLE, "{law}, {start}, {instance}: {}", checks::show(&errors));
                compared += 1;
            }
        }
    }
    assert!(compared >= 60, "only {compared} instances compared");
}

/// Runs of thousands of instances end on many threads: in one of ten a thread had waited for itself.
#[test]
fn runs_on_more_threads_than_cores_end() {
    let desk = Desk::new();
    let axis = |path: &str, ends: &str| format!("\"{path}\" = {{ {ends}, points = 80 }}\n");
    let scene = [
        "[instrument.cantilever]\nstiffness = \"40 N/m\"\nfrequency = \"300 kHz\"\nquality_factor = 100\n",
        "[sample]\nsurface_energy = \"50 mJ/m^2\"\n[drive]\non = \"tip\"\nfrequency = \"resonance\"\nfree_amplitude = \"20 nm\"\n",
        "[run]\nperiods = 2\nmeasure = 1\nmodes = 1\nsteps_per_period = 64\n[sweep]\n",
        &axis("sample.youngs_modulus", "from = \"1 GPa\", to = \"5 GPa\""),
        &axis("approach.gap", "from = \"12 nm\", to = \"16 nm\""),
    ];
    desk.write("many.toml", &scene.concat());
    let options = ["--backend", "cpu", "--threads", "16", "--no-estimate", "--no-audit", "--overwrite"];
    for turn in 0..25 {
        let mut run = desk.command(&[&["run", "many.toml", "-q", "-o", "many.h5"], &options[..]].concat());
        let mut child = run.spawn().unwrap();
        let start = Instant::now();
        let ended = loop {
            match child.try_wait().unwrap() {
                Some(status) => break Some(status),
                None if start.elapsed() > Duration::from_secs(120) => break None,
                None => std::thread::sleep(Duration::from_millis(10)),
            }
        };
        if ended.is_none() {
            child.kill().unwrap();
        }
        assert!(ended.is_some_and(|status| status.success()), "run {turn}: {ended:?}");
    }
}

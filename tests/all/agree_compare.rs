//! Errors and their scales against the independent integrator's and the energy books'.

use crate::checks;
use afmsweep::compare::{Scales, choose, error, worst};
use afmsweep::control;
use afmsweep::engine::{Cpu, Progress};
use afmsweep::observe::{Measured, Observable};
use afmsweep::plan::{Plan, Precision};
use afmsweep::scene::{LawChoice, Scene};
use std::path::Path;

/// The work of the drive from the tip's fundamental alone, against the force's harmonics and all modes.
#[test]
fn work_scales_are_those_of_the_energy_books() {
    let tapping = |law| {
        checks::calibrated(40.0, 300e3, 150.0, 20e-9, 14e-9, |scene| {
            checks::sample(scene, law, 2e9, 0.05, 10e-9);
        })
    };
    let quickstart = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/quickstart.toml");
    let mut coupled = Scene::load(Path::new(quickstart)).unwrap();
    coupled.output.observables = Observable::all().collect();
    for axis in &mut coupled.sweep.axes {
        axis.values = vec![axis.values[axis.values.len() / 2]].into();
    }
    for scene in [tapping(LawChoice::Hertz), tapping(LawChoice::Dmt), tapping(LawChoice::Jkr), coupled] {
        let plan = checks::plan(&scene, None);
        let finished = checks::run(&plan)[0];
        let ours = Scales::of(&plan, 0, &finished.measured);
        let theirs = checks::scales(&plan, 0, &checks::outcome(&finished.measured));
        println!("{ours:?}\n{theirs:?}");
        assert_eq!((ours.length, ours.force), (theirs.length, theirs.force));
        assert!((ours.work / theirs.work - 1.0).abs() < 1e-3, "{} and {}", ours.work, theirs.work);
    }
}

#[test]
fn errors_are_those_of_the_tests_own_table() {
    let scene = checks::calibrated(40.0, 300e3, 150.0, 20e-9, 14e-9, |scene| {
        checks::sample(scene, LawChoice::Jkr, 2e9, 0.05, 10e-9);
    });
    let plan = checks::plan(&scene, None);
    let (fine, coarse) = (checks::one(&scene, Some(1024)).measured, checks::run(&plan)[0].measured);
    let scales = Scales::of(&plan, 0, &fine);
    let truth = checks::outcome(&fine);
    let theirs = checks::errors(&coarse, &truth, &checks::scales(&plan, 0, &truth));
    for (name, expected) in theirs {
        let observable = match name {
            "harmonics" => Observable::HarmonicAmplitude,
            name => Observable::from_name(name).unwrap(),
        };
        let ours = error(observable, &coarse, &fine, &scales);
        // The tests' table leaves the fundamental out of the harmonics.
        let near = (ours - expected).abs() <= 2e-3 * expected || name == "harmonics" && ours >= expected;
        assert!(near, "{name}: {ours:e}, not {expected:e}");
    }
    assert!(worst(&plan.observables, &coarse, &fine, &scales) > 0.0);
}

#[test]
fn what_is_no_number_is_an_infinite_error() {
    let scene = checks::calibrated(40.0, 300e3, 150.0, 20e-9, 14e-9, |_| {});
    let plan = checks::plan(&scene, None);
    let truth = checks::run(&plan)[0].measured;
    let scales = Scales::of(&plan, 0, &truth);
    assert_eq!(worst(&plan.observables, &truth, &truth, &scales), 0.0);
    assert_eq!(error(Observable::ForceMax, &Measured::NONE, &truth, &scales), f64::INFINITY);
    assert_eq!(worst(&plan.observables, &Measured::NONE, &truth, &scales), f64::INFINITY);
    // A graze that one of them misses counts by its depth.
    let missed = Measured { indentation_max: f64::NAN, ..truth };
    let depth = truth.indentation_max / scales.length;
    assert_eq!(error(Observable::IndentationMax, &missed, &truth, &scales), depth);
}

#[test]
fn chosen_instances_hold_the_extremes_and_are_the_same_each_time() {
    let quickstart = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/quickstart.toml");
    let plan = checks::plan(&Scene::load(Path::new(quickstart)).unwrap(), None);
    let chosen = choose(&plan, 8, 1);
    assert_eq!(chosen.len(), 8);
    assert!(chosen.is_sorted() && chosen.windows(2).all(|pair| pair[0] != pair[1]));
    assert_eq!(chosen, choose(&plan, 8, 1));
    assert_ne!(chosen, choose(&plan, 8, 2));
    let modulus = |i: u32| plan.contact(i).modulus;
    let stiffest = plan.cases().map(|case| case.contact.modulus).fold(0.0, f64::max);
    assert!(chosen.iter().any(|i| modulus(*i) == stiffest));
    assert_eq!(choose(&plan, 10_000, 1).len(), plan.len());
}

/// A scale that is measured does not depend on what else is asked for.
#[test]
fn the_mean_force_counts_on_the_largest_one() {
    let text = |observables: &str| {
        let scene = include_str!("../../scenes/lever.toml");
        let (before, _) = scene.split_once("observables = ").unwrap();
        format!("{before}observables = [{observables}]\n").replace("points = 49", "points = 3")
    };
    let scales = |observables: &str| {
        let scene = Scene::parse(Path::new("lever.toml"), &text(observables)).unwrap();
        let plan = Plan::new(&scene, Precision::F64).unwrap();
        let run = control::run(&plan, &Cpu::default(), &Progress::default()).unwrap();
        let of = |i: usize| Scales::of(&run.plan, i, &run.results.get(i).measured).force;
        (0..run.plan.len()).map(of).collect::<Vec<_>>()
    };
    let (alone, beside) = (scales("\"force_mean\""), scales("\"force_mean\", \"force_max\", \"force_min\""));
    for (alone, beside) in alone.iter().zip(&beside) {
        assert!((alone / beside - 1.0).abs() < 1e-3, "{alone:e} {beside:e}");
        assert!(*alone > 1e-10, "{alone:e}");
    }
}

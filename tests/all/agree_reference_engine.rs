//! The reference engine against the confirmed tapping points and the independent integrator.

use crate::checks;
use crate::checks::{Twin, one_mode, sample};
use afmsweep::compare::{Scales, worst};
use afmsweep::control;
use afmsweep::engine::{Cpu, Model, Progress, Reference, solve, solve_near};
use afmsweep::observe::Status;
use afmsweep::scene::{LawChoice, LeverMode, LeverSpec, Scene, Start};
use std::path::Path;
use std::time::Instant;

fn options(tolerance: f64, model: Model) -> Reference {
    Reference { tolerance, model }
}

/// An instance by the reference engine and by the independent integrator, whose largest difference is to
/// stay below `bound`.
fn agree(name: &str, scene: &Scene, model: Model, bound: f64) {
    let plan = checks::plan(scene, None);
    let start = Instant::now();
    let (finished, work) = solve(&plan, 0, &options(1e-13, model)).expect("the instance can be solved");
    let time = start.elapsed().as_secs_f64();
    let twin = if model == Model::Kept { Twin::Kept } else { Twin::Whole };
    let truth = checks::reference(&plan, 0, twin);
    let errors = checks::errors(&finished.measured, &truth, &checks::scales(&plan, 0, &truth));
    let (what, worst) = checks::worst(&errors);
    println!("{name}: {worst:.1e} ({what}); {} periods in {time:.3} s, {work:?}", plan.run.periods);
    println!("  {}", checks::show(&errors));
    assert_eq!(finished.status, Status::Ok, "{name}");
    assert!(worst <= bound, "{name}: {what} off by {worst:e}, bound {bound:e}");
}

#[test]
fn confirmed_points() {
    for file in ["published_dmt.toml", "published_jkr.toml"] {
        let scene = Scene::load(&Path::new("tests/scenes/steady").join(file)).expect("the scene is good");
        agree(file, &scene, Model::Whole, 1e-9);
    }
}

#[test]
fn soft_medium_and_stiff_under_every_law() {
    for law in [LawChoice::Hertz, LawChoice::Dmt, LawChoice::Jkr] {
        for modulus in [50e6, 1e9, 20e9] {
            let scene = one_mode(20.0, 150e3, 20.0, 30e-9, 24e-9, |scene| {
                sample(scene, law, modulus, 0.03, 10e-9);
                scene.base.contact.decay_length = 0.3e-9;
            });
            agree(&format!("{law:?}, {modulus:e} Pa"), &scene, Model::Kept, 1e-9);
        }
    }
}

/// From rest both programs see the transients of every mode, one in closed form, the other as motion.
#[test]
fn two_modes_from_rest() {
    for law in [LawChoice::Hertz, LawChoice::Jkr] {
        let scene = one_mode(5.0, 70e3, 10.0, 30e-9, 22e-9, |scene| {
            let first = LeverMode { stiffness: 5.0, frequency: 70e3, quality_factor: 10.0, drive: 1.0 };
            let second = LeverMode { stiffness: 200.0, frequency: 440e3, quality_factor: 20.0, drive: 1.0 };
            scene.base.instrument.cantilever.lever = LeverSpec::Modes(vec![first, second]);
            sample(scene, law, 500e6, 0.02, 10e-9);
            scene.run.start = Start::Rest;
            (scene.run.periods, scene.run.measure) = (60, 10);
        });
        agree(&format!("two modes from rest, {law:?}"), &scene, Model::Whole, 1e-9);
    }
}

/// Truth: the reference with all modes one by one, as it is with finer steps. Audits have two oscillators in place of the
/// modes far faster than the contact.
#[test]
fn modes_far_faster_than_the_contact_are_two_oscillators() {
    for name in ["soft_0.05_graze", "soft_0.5_hertz", "soft_1_dmt", "tip_mass_light"] {
        let scene =
            Scene::load(&Path::new("tests/hard").join(format!("{name}.toml"))).expect("the scene is good");
        let plan = checks::plan(&scene, None);
        let progress = Progress::default();
        let run = control::run(&plan, &Cpu::default(), &progress).expect("the plan can be run");
        let station = run.found.get(0).expect("it has a periodic state").section;
        let state = |tolerance| {
            let start = Instant::now();
            let found = solve_near(&run.plan, 0, &station, &options(tolerance, Model::Whole), &progress);
            (
                found.expect("it can be looked for").expect("it is found").measured,
                start.elapsed().as_secs_f64(),
            )
        };
        let ((quick, few), (whole, all)) = (state(1e-10), state(1e-12));
        let error = worst(&plan.observables, &quick, &whole, &Scales::of(&plan, 0, &whole));
        println!("{name}: {error:.1e}, {few:.2} s in place of {all:.2} s");
        assert!(error <= 4e-6, "{name}: off by {error:e}");
    }
}

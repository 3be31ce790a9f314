//! The engine against the independent, event-locating integrator of `support`: once with the same
//! oscillators, which shows the error of the steps, once with all modes of the instrument, which
//! shows that of the reduction too.

use crate::checks;
use crate::checks::{Errors, Twin, bounds, calibrated, compare, one_mode, sample, show, worst};
use afmsweep::engine::trace;
use afmsweep::observe::Status;
use afmsweep::scene::{
    ActuatorModel, DriveFrequency, DriveLevel, DriveOn, LawChoice, QualityFactor, Scene, Start,
};

const LAWS: [LawChoice; 3] = [LawChoice::Hertz, LawChoice::Dmt, LawChoice::Jkr];

fn hold(name: &str, scene: &Scene, steps: Option<u32>, what: Twin, bound: f64) -> (Status, Errors) {
    let (status, n, errors) = compare(scene, steps, what);
    println!("{name}, {n} steps, {status:?}: {}", show(&errors));
    let (which, error) = worst(&errors);
    assert!(error <= bound, "{name}, {n} steps: {which} off by {error:e}, bound {bound:e}");
    (status, errors)
}

fn error_of(errors: &Errors, name: &str) -> f64 {
    errors.iter().find(|(other, _)| *other == name).expect("an observable's name").1
}

#[test]
fn one_mode_on_soft_medium_and_stiff_samples() {
    for law in LAWS {
        for (modulus, q, k, frequency) in
            [(10e6, 25.0, 2.0, 45e3), (1e9, 150.0, 10.0, 75e3), (60e9, 400.0, 40.0, 300e3)]
        {
            let scene = one_mode(k, frequency, q, 30e-9, 24e-9, |scene| {
                sample(scene, law, modulus, 0.03, 10e-9);
                // Both run the same periods: steady to 1e-5 is enough.
                scene.run.periods = (4.0 * q) as u32;
            });
            let name = format!("{law:?}, {modulus:.0e} Pa");
            let (status, errors) = hold(&name, &scene, None, Twin::Whole, bounds::STEPS_PLAN);
            assert_eq!(status, Status::Ok, "{name}");
            assert!(error_of(&errors, "amplitude") <= bounds::AMPLITUDE, "{name}");
            assert!(error_of(&errors, "phase") <= bounds::PHASE, "{name}");
            hold(&name, &scene, Some(2048), Twin::Whole, bounds::STEPS_FINE);
        }
    }
}

/// The run starts in the free swing, wider than the one that is measured: nothing of it may show.
/// Here the largest force is the faint pull at the top of the swing.
#[test]
fn extremes_are_those_of_the_measured_part() {
    let scene = one_mode(2.0, 45e3, 25.0, 30e-9, 24e-9, |scene| {
        sample(scene, LawChoice::Dmt, 10e6, 0.03, 10e-9);
    });
    let plan = checks::plan(&scene, None);
    let (force, truth) =
        (checks::one(&scene, None).measured.force_max, checks::reference(&plan, 0, Twin::Whole));
    println!("largest force {force:.6e} N, expected {:.6e} N", truth.force_max);
    assert!((force / truth.force_max - 1.0).abs() < bounds::PULL_AT_TOP);
}

/// The instrument of Table 1 at its resonance with losses, by another model of its rod.
fn table1(law: LawChoice, model: ActuatorModel, frequency: DriveFrequency, level: DriveLevel) -> Scene {
    checks::scene(|scene| {
        let base = &mut scene.base;
        base.instrument.actuator.model = model;
        base.instrument.actuator.quality_factor = 80.0;
        base.instrument.cantilever.quality_factor = QualityFactor::All(200.0);
        base.drive.frequency = frequency;
        base.drive.on = DriveOn::Actuator;
        base.drive.level = level;
        base.approach.gap = 15e-9;
        sample(scene, law, 1e9, 0.03, 10e-9);
        // The first taps: they are compared as well as any others, and are the least regular.
        (scene.run.periods, scene.run.measure) = (40, 3);
    })
}

#[test]
fn instruments_of_many_modes() {
    let (free, voltage) = (DriveLevel::FreeAmplitude(20e-9), DriveLevel::Voltage(2.3));
    let resonance = DriveFrequency::Resonance;
    for law in LAWS {
        let lever = calibrated(10.0, 75e3, 25.0, 30e-9, 24e-9, |scene| {
            sample(scene, law, 1e9, 0.03, 10e-9);
            (scene.run.periods, scene.run.measure) = (40, 3);
        });
        let scenes = [
            ("calibrated lever", lever),
            ("coupled", table1(law, ActuatorModel::Coupled, resonance, voltage)),
            ("prescribed", table1(law, ActuatorModel::Prescribed, resonance, free)),
            ("moving base", table1(law, ActuatorModel::Rigid, resonance, free)),
            ("moving base, 150 kHz", table1(law, ActuatorModel::Rigid, DriveFrequency::Hertz(150e3), free)),
        ];
        for (name, scene) in &scenes {
            let name = format!("{name}, {law:?}");
            hold(&name, scene, None, Twin::Kept, bounds::STEPS_PLAN);
            hold(&name, scene, Some(2048), Twin::Kept, bounds::STEPS_FINE);
            let (_, errors) =
                hold(&format!("{name}, all modes"), scene, None, Twin::Whole, bounds::REDUCTION);
            // What a mode left out does shows in the force's ripple, not in the swing.
            assert!(error_of(&errors, "amplitude") <= bounds::REDUCTION_SWING, "{name}");
            assert!(error_of(&errors, "phase") <= bounds::REDUCTION_SWING, "{name}");
        }
    }
}

/// The paper's run: 15 V at 30 kHz from rest, no damping.
#[test]
fn the_papers_run_from_rest() {
    for law in LAWS {
        let scene = checks::scene(|scene| {
            scene.base.contact.law = law;
            scene.run.start = Start::Rest;
            (scene.run.periods, scene.run.measure) = (6, 2);
        });
        from_rest(&format!("paper, {law:?}"), &scene);
        let scene = checks::scene(|scene| {
            sample(scene, law, 1e9, 0.03, 10e-9);
            scene.base.approach.gap = 5e-9;
            scene.run.start = Start::Rest;
            (scene.run.periods, scene.run.measure) = (6, 2);
        });
        from_rest(&format!("paper on 1 GPa, {law:?}"), &scene);
    }
}

#[test]
fn a_base_that_sets_off_at_once() {
    for law in LAWS {
        let mut scene =
            table1(law, ActuatorModel::Rigid, DriveFrequency::Hertz(150e3), DriveLevel::BaseAmplitude(8e-9));
        scene.run.start = Start::Rest;
        (scene.run.periods, scene.run.measure) = (8, 2);
        from_rest(&format!("moving base from rest, {law:?}"), &scene);
    }
}

/// Travel at samples of the trace, and what is measured, against all modes.
fn from_rest(name: &str, scene: &Scene) {
    let plan = checks::plan(scene, None);
    let (system, mut state, _) = checks::twin(&plan, 0, Twin::Whole);
    let driven = &plan.drives[0];
    println!("{name}: {} of {} modes integrated", system.modes.len(), driven.instrument.modes.len());
    let trace = trace(&plan, 0, None, plan.run.periods, plan.run.periods).expect("traced");
    let mut off: f64 = 0.0;
    let mut now = 0.0;
    for sample in (0..trace.samples.len()).step_by(7) {
        let phase = (sample as f64 + 0.5) * trace.step * driven.free.omega;
        system.advance(&mut state, phase - now, 1e-12);
        now = phase;
        let travel = system.travel(state.phase, &state.x).0;
        off = off.max((trace.samples[sample].travel - travel).abs());
    }
    let scale = driven.free_amplitude();
    println!("{name}: travel off by {:.1e} of {scale:.3e} m", off / scale);
    assert!(off <= bounds::TRAVEL * scale, "{name}: travel off by {:e}", off / scale);
    hold(name, scene, None, Twin::Whole, bounds::REDUCTION_REST);
}

//! The reference engine against closed forms: collisions, linear response in contact, loss per cycle,
//! the lever's energy balance, and the digits that a tolerance buys.

use crate::checks;
use crate::checks::{one_mode, sample};
use afmsweep::engine::{Finished, Model, Reference, Work, solve};
use afmsweep::observe::Status;
use afmsweep::plan::Plan;
use afmsweep::scene::{LawChoice, LeverMode, LeverSpec, Scene};
use nalgebra::Complex;
use std::f64::consts::{PI, TAU};
use std::path::Path;

fn solved(plan: &Plan, tolerance: f64) -> (Finished, Work) {
    let options = Reference { tolerance, ..Reference::default() };
    solve(plan, 0, &options).expect("the instance can be solved")
}

/// Relative difference, printed beside its bound.
fn close(name: &str, value: f64, expected: f64, bound: f64) {
    let error = (value / expected - 1.0).abs();
    println!("{name}: {value:.12e} (expected {expected:.12e}, off by {error:.1e}, bound {bound:.0e})");
    assert!(error <= bound, "{name}: {value:e}, expected {expected:e}, off by {error:e}");
}

/// An undamped, all but undriven mode falls on the sample at the middle of its swing: twice in a period a
/// collision whose largest depth follows from energy and whose length from a quadrature.
#[test]
fn hertz_collision() {
    let (k, frequency, a0) = (2.0, 100e3, 20e-9);
    let scene = one_mode(k, frequency, 1e13, a0, 0.0, |scene| {
        sample(scene, LawChoice::Hertz, 20e9, 0.0, 10e-9);
        (scene.run.periods, scene.run.measure) = (1, 1);
    });
    let plan = checks::plan(&scene, None);
    let contact = plan.contact(0);
    let kappa = contact.modulus * contact.radius.sqrt();
    let omega = TAU * frequency;
    let (mass, speed) = (k / (omega * omega), a0 * omega);
    // m v^2/2 = k d^2/2 + (2/5) kappa d^2.5
    let left = |d: f64| mass * speed * speed - k * d * d - 0.8 * kappa * d.powf(2.5);
    let (mut low, mut high) = (0.0, a0);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if left(middle) > 0.0 { low = middle } else { high = middle }
    }
    let deepest = 0.5 * (low + high);
    // T = 2 int dd/speed(d), with d = deepest (1 - s^2); without the lever 2.943275184323 deepest/speed.
    let span = |k: f64| {
        let c = 0.8 * kappa / mass * deepest.powf(2.5);
        let spring = k / mass * deepest * deepest;
        let at = |s: f64| {
            if s == 0.0 {
                return 2.0 * deepest / (2.0 * spring + 2.5 * c).sqrt();
            }
            let (x, rest) = (1.0 - s * s, (-s * s).ln_1p());
            let energy = spring * (1.0 - x * x) - c * (2.5 * rest).exp_m1();
            2.0 * deepest * s / energy.sqrt()
        };
        let n = 20_000;
        let sum: f64 =
            (1..n).map(|i| at(f64::from(i) / f64::from(n)) * if i % 2 == 1 { 4.0 } else { 2.0 }).sum();
        2.0 * (at(0.0) + sum + at(1.0)) / f64::from(3 * n)
    };
    let bare = (0.8 * kappa / mass * deepest.powf(2.5)).sqrt();
    close("the quadrature itself", span(0.0), 2.943275184323 * deepest / bare, 1e-11);
    let (finished, work) = solved(&plan, 1e-14);
    println!("{work:?}");
    let m = finished.measured;
    assert_eq!(m.contacts, 2.0);
    close("largest indentation", m.indentation_max, deepest, 1e-9);
    close("largest force", m.force_max, kappa * deepest.powf(1.5), 1e-9);
    close("contact time", m.contact_time * TAU / omega, 2.0 * span(k), 1e-9);
    assert!(m.dissipation.abs() < 1e-9 * mass * speed * speed, "{:e}", m.dissipation);
}

/// Two modes held in contact by a negative gap, driven a little: linear response with k_c = df/d delta.
#[test]
fn contact_resonance() {
    let scene = one_mode(5.0, 70e3, 5.0, 60e-15, -4e-9, |scene| {
        let first = LeverMode { stiffness: 5.0, frequency: 70e3, quality_factor: 5.0, drive: 1.0 };
        let second = LeverMode { stiffness: 200.0, frequency: 440e3, quality_factor: 8.0, drive: 1.0 };
        scene.base.instrument.cantilever.lever = LeverSpec::Modes(vec![first, second]);
        sample(scene, LawChoice::Hertz, 100e6, 0.0, 10e-9);
        (scene.run.periods, scene.run.measure) = (70, 2);
    });
    let plan = checks::plan(&scene, None);
    let (driven, case) = (&plan.drives[0], plan.case(0));
    let kappa = case.contact.modulus * case.contact.radius.sqrt();
    let (modes, omega) = (&driven.instrument.modes, driven.free.omega);
    let answer = |omega: f64| -> Complex<f64> {
        let one = |m: &afmsweep::instrument::Mode| {
            let re = m.omega * m.omega - omega * omega;
            m.tip * m.force / Complex::new(re, omega * m.omega / m.quality_factor)
        };
        modes.iter().map(one).sum()
    };
    // At rest: depth = -gap - flexibility kappa depth^1.5.
    let (mut low, mut high) = (0.0, -case.gap);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if middle + case.gap + answer(0.0).re * kappa * middle.powf(1.5) < 0.0 {
            low = middle
        } else {
            high = middle
        }
    }
    let stiffness = 1.5 * kappa * low.sqrt();
    let expected = driven.free.tip / (1.0 + stiffness * answer(omega));
    let (finished, work) = solved(&plan, 1e-14);
    println!("{work:?}, contact stiffness {stiffness:.3} N/m");
    let m = finished.measured;
    // Nonlinear terms: (amplitude/depth)^2, 4e-10.
    close("amplitude", m.harmonics[0], expected.norm(), 1e-8);
    close("phase", m.phase, (-expected.arg().to_degrees()).rem_euclid(360.0), 1e-8);
    close("mean force", m.force_mean, kappa * low.powf(1.5), 1e-9);
    assert_eq!((m.contact_time, m.contacts), (1.0, 0.0));
}

#[test]
fn jkr_loss_per_cycle() {
    for (modulus, gap) in [(100e6, 45e-9), (2e9, 40e-9)] {
        let scene = one_mode(20.0, 75e3, 30.0, 60e-9, gap, |scene| {
            sample(scene, LawChoice::Jkr, modulus, 0.05, 20e-9);
        });
        let plan = checks::plan(&scene, None);
        let contact = plan.contact(0);
        let (k, r, w) = (contact.modulus, contact.radius, contact.work);
        let (finished, work) = solved(&plan, 1e-13);
        println!("{work:?}");
        let m = finished.measured;
        assert_eq!((finished.status, m.contacts), (Status::Ok, 1.0));
        let loss = 1.2749410291014 * PI * w * r * ((PI * w / k).powi(2) * r).cbrt();
        // Errors count on the drive's work; the stiff sample's loss is 1/5000 of it.
        let drive = PI * 20.0 / 30.0 * 60e-9 * m.harmonics[0] * m.phase.to_radians().sin();
        assert!((m.dissipation - loss).abs() < 1e-11 * drive, "{:e}", (m.dissipation - loss) / drive);
        close("loss per cycle", m.dissipation, loss, 1e-8);
        close("largest pull", m.force_min, -1.5 * PI * w * r, 1e-12);
    }
}

/// At resonance: loss = (pi k/Q) (A0 A sin(phi) - sum n^2 A_n^2), PHYSICS of one mode.
#[test]
fn books_of_one_mode() {
    let (k, q, a0) = (10.0, 25.0, 60e-9);
    let scene = one_mode(k, 45e3, q, a0, 30e-9, |scene| sample(scene, LawChoice::Hertz, 2e6, 0.0, 20e-9));
    let (finished, _) = solved(&checks::plan(&scene, None), 1e-13);
    let m = finished.measured;
    let drive = a0 * m.harmonics[0] * m.phase.to_radians().sin();
    let lost: f64 = (1..).zip(&m.harmonics).map(|(n, a)| (f64::from(n) * a).powi(2)).sum();
    let (books, loss) = ((drive - lost) / drive, m.dissipation / (PI * k / q * drive));
    println!("drive less lever {books:.1e} of the drive, loss in the sample {loss:.1e}");
    assert!(m.contacts == 1.0 && lost < drive * (1.0 + 1e-8));
    assert!((books - loss).abs() < 1e-8 && loss.abs() < 1e-10);
}

/// Attraction without contact is smooth: the error after ten periods follows the tolerance.
#[test]
fn tolerance_buys_digits() {
    let scene = one_mode(20.0, 100e3, 10.0, 20e-9, 21.5e-9, |scene| {
        sample(scene, LawChoice::Dmt, 1e9, 0.01, 10e-9);
        scene.base.contact.decay_length = 0.6e-9;
        (scene.run.periods, scene.run.measure) = (10, 1);
    });
    let plan = checks::plan(&scene, None);
    let (truth, _) = solved(&plan, 1e-14);
    for tolerance in [1e-8, 1e-9, 1e-10, 1e-11, 1e-12] {
        let (finished, work) = solved(&plan, tolerance);
        let (m, t) = (finished.measured, truth.measured);
        let error =
            (m.harmonics[0] - t.harmonics[0]).hypot((m.phase - t.phase).to_radians() * t.harmonics[0]);
        println!("tolerance {tolerance:.0e}: off by {:.1e} of the swing, {work:?}", error / 20e-9);
        // Seen: 4 times the tolerance at most, from 170 steps (1e-8) to 290 (1e-12).
        assert!(m.contacts == 0.0 && error / 20e-9 <= 10.0 * tolerance);
    }
}

/// What the reference takes is bounded: four figures of work on a confirmed point, each within a factor of two.
#[test]
fn work_on_a_confirmed_point() {
    let scene = Scene::load(Path::new("tests/scenes/steady/published_dmt.toml")).expect("the scene is good");
    let plan = checks::plan(&scene, None);
    let (_, work) = solved(&plan, 1e-12);
    println!("{work:?}");
    let periods = u64::from(plan.run.periods);
    assert_eq!(work.events, 2 * periods);
    assert!((40 * periods..200 * periods).contains(&work.accepted), "{work:?}");
    assert!(work.rejected < work.accepted);
}

#[test]
fn refusals_say_what_to_give() {
    let plan = checks::plan(&one_mode(1.0, 1e5, 10.0, 1e-9, 1e-9, |_| ()), None);
    let told = |instance: usize, tolerance: f64| {
        let options = Reference { tolerance, model: Model::Kept };
        solve(&plan, instance, &options).map_err(|error| error.to_string()).err().unwrap_or_default()
    };
    assert!(told(1, 1e-12).contains("the plan has 1"), "{}", told(1, 1e-12));
    assert!(told(0, 0.0).contains("1e-14 to 1e-3"));
    assert!(told(0, f64::NAN).contains("1e-14 to 1e-3"));
}

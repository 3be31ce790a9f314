//! The independent integrator of `support` itself against closed forms, and against tapping points
//! that other programs have confirmed: it is what the engine is held against elsewhere.

use crate::support::laws::Law;
use crate::support::oscillator::{Mode, Options, Outcome, State, System};
use afmsweep::contact::{Dmt, Jkr, StaticLaw};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Relative difference, printed beside its bound.
fn close(name: &str, value: f64, expected: f64, tolerance: f64) {
    let error = (value / expected - 1.0).abs();
    println!("{name}: {value:.12e} (expected {expected:.12e}, off by {error:.1e})");
    assert!(error <= tolerance, "{name}: {value:e}, expected {expected:e}, bound {tolerance:e}");
}

/// A free mass (kg) that flies at the sample from `gap` at `speed`; a period is `span` seconds.
fn flight(mass: f64, speed: f64, gap: f64, span: f64, law: Law) -> (System, State) {
    let mode = Mode { omega: 0.0, quality: f64::INFINITY, c: 1.0, b: 1.0 / mass, g: 0.0 };
    let system = System { modes: vec![mode], drive: TAU / span, base: 0.0, gap, law };
    let state = system.state(0.0, vec![0.0, -speed / system.drive]);
    (system, state)
}

#[test]
fn hertz_collision() {
    let (mass, speed, k, r) = (3e-12, 0.02, 5e8, 1.6e-8f64);
    let kappa = k * r.sqrt();
    let deepest = (5.0 * mass * speed * speed / (4.0 * kappa)).powf(0.4);
    let time = 2.943275184323 * deepest / speed;
    let (system, mut state) = flight(mass, speed, 0.7 * deepest, 4.0 * time, Law::Hertz { k, r });
    let out = system.run(&mut state, &Options::default());
    close("largest indentation", out.indentation_max, deepest, 1e-12);
    close("contact time", out.contact_share * 4.0 * time, time, 1e-12);
    close("largest force", out.force_max, kappa * deepest.powf(1.5), 1e-12);
    close("speed on leaving", state.x[1] * system.drive, speed, 1e-12);
    // impulse 2 m v
    close("mean force", out.force_mean * 4.0 * time, 2.0 * mass * speed, 1e-12);
    assert_eq!((out.contacts, state.touch), (1.0, false));
    assert!(out.loss.abs() < 1e-11 * mass * speed * speed);
}

#[test]
fn jkr_collision_loses_the_area_of_its_loop() {
    let (k, r, w) = (1e9, 2e-8, 0.05);
    let loss = 1.2749410291014 * PI * w * r * ((PI * w / k).powi(2) * r).cbrt();
    // sticks at half the energy, escapes at three times
    let mass = 1e-12;
    for (energy, escapes) in [(0.5, false), (3.0, true)] {
        let speed = (2.0 * energy * loss / mass).sqrt();
        let (system, mut state) = flight(mass, speed, 1e-9, 40e-9 / speed, Law::Jkr { k, r, w });
        let out = system.run(&mut state, &Options::default());
        assert_eq!(state.touch, !escapes);
        assert_eq!(out.contacts, 1.0);
        if escapes {
            let left = 0.5 * mass * (state.x[1] * system.drive).powi(2);
            close("loss from kinetic energies", energy * loss - left, loss, 1e-11);
            close("loss from work", out.loss, loss, 1e-11);
            close("largest pull", out.force_min, -1.5 * PI * w * r, 1e-13);
        }
    }
}

#[test]
fn free_decay_and_undamped_swing() {
    let (omega, quality, x0) = (TAU * 3e5, 7.0, 20e-9);
    let free = Mode { omega, quality, c: 1.0, b: 1.0, g: 0.0 };
    let system = System { modes: vec![free], drive: 0.31 * omega, base: 0.0, gap: 1.0, law: Law::None };
    let mut state = system.state(0.0, vec![x0, 0.0]);
    system.advance(&mut state, 5.0, 1e-14);
    let time = 5.0 / system.drive;
    let decay = omega / (2.0 * quality);
    let ring = (omega * omega - decay * decay).sqrt();
    let expected = x0 * (-decay * time).exp() * ((ring * time).cos() + decay / ring * (ring * time).sin());
    close("free decay", state.x[0], expected, 1e-11);

    let mut undamped = system.clone();
    undamped.modes[0].quality = f64::INFINITY;
    let mut state = undamped.state(0.0, vec![x0, 0.0]);
    for _ in 0..100 {
        undamped.advance(&mut state, TAU, 1e-14);
    }
    let angle = omega * 100.0 * TAU / undamped.drive;
    assert!((state.x[0] - x0 * angle.cos()).abs() < 1e-11 * x0);
}

#[test]
fn driven_modes_on_a_moving_base_reach_the_linear_response() {
    let (drive, base) = (TAU * 71e3, 0.4e-9);
    let modes = vec![
        Mode { omega: TAU * 70e3, quality: 20.0, c: 0.9, b: 2.0, g: 3e2 },
        Mode { omega: TAU * 438.9e3, quality: 15.0, c: -1.3, b: 2.0, g: 5e4 },
    ];
    let (mut sine, mut cosine) = (base, 0.0);
    for mode in &modes {
        let (re, im) = (mode.omega.powi(2) - drive.powi(2), drive * mode.omega / mode.quality);
        let gain = mode.c * mode.g / (re * re + im * im);
        sine += gain * re;
        cosine -= gain * im;
    }
    let system = System { modes, drive, base, gap: 1e-6, law: Law::None };
    let lag = (-cosine).atan2(sine).to_degrees().rem_euclid(360.0);
    // from rest, and from the steady state itself
    let mut rest = system.state(0.3, vec![0.0; 4]);
    let settled =
        system.run(&mut rest, &Options { settle: 250, measure: 2, harmonics: 2, ..Options::default() });
    let steady = system.run(&mut system.free_at_top(), &Options::default());
    for out in [settled, steady] {
        close("amplitude", out.amplitude, sine.hypot(cosine), 1e-11);
        close("phase", out.phase, lag, 1e-11);
        assert!(out.offset.abs() < 1e-11 * out.amplitude);
        assert_eq!(out.contacts, 0.0);
    }
    let top = system.free_at_top();
    let (z, rate) = system.travel(top.phase, &top.x);
    close("top of the swing", z, sine.hypot(cosine), 1e-13);
    assert!(rate.abs() < 1e-13 * z);
}

#[test]
fn a_graze_within_one_step_is_seen() {
    // Contact from acos(1 - x) before to after the lowest point, too soft to matter.
    for (short, seen) in [(1e-8, true), (-1e-8, false)] {
        let amplitude = 10e-9;
        let law = Law::Hertz { k: 1e-3, r: 1e-8 };
        let gap = amplitude * (1.0 - short);
        let system = System::one_mode(1.0, TAU * 1e5, 10.0, 0.1 * amplitude, gap, law);
        let out = system.run(&mut system.free_at_top(), &Options::default());
        assert_eq!(out.contacts, if seen { 1.0 } else { 0.0 });
        if seen {
            close("share of a graze", out.contact_share, (2.0 * short).sqrt() / PI, 1e-4);
        }
    }
}

/// Loss in the sample from the lever's energy balance at resonance, all harmonics.
fn loss_by_balance(k: f64, quality: f64, a0: f64, out: &Outcome) -> f64 {
    let damping: f64 = (1..).zip(&out.harmonics).map(|(n, (a, _))| (f64::from(n) * a).powi(2)).sum();
    PI * k / quality * (a0 * out.amplitude * out.phase.to_radians().sin() - damping)
}

/// To one unit of the last digit given (the last one is not always rounded).
fn digits(name: &str, value: f64, expected: f64, last: f64) {
    println!("{name}: {value:.12} (confirmed {expected})");
    assert!((value - expected).abs() <= last, "{name}: {value}, confirmed {expected}");
}

#[test]
fn dmt_tapping_point() {
    let (k, quality, a0, r) = (10.0, 25.0, 60e-9, 20e-9);
    let (hamaker, d0) = (6.4e-20, 0.2e-9);
    let modulus = 4.0 / 3.0 / (0.91 / 130e9 + 0.91 / 70e6);
    let w = hamaker / (12.0 * PI * d0 * d0);
    let law = Law::Dmt { k: modulus, r, w, d0 };
    let system = System::one_mode(k, TAU * 45e3, quality, k * a0 / quality, 39.8e-9, law);
    let options = Options { settle: 300, measure: 1, harmonics: 40, ..Options::default() };
    let out = system.run(&mut system.free_at_top(), &options);
    digits("amplitude, nm", out.amplitude * 1e9, 57.41833265, 1e-8);
    digits("phase, deg", out.phase, 73.14449451, 1e-8);
    digits("largest force, nN", out.force_max * 1e9, 28.4392116, 1e-7);
    digits("mean force, nN", out.force_mean * 1e9, 3.589291697, 1e-9);
    digits("contact share", out.contact_share, 0.2527763, 1e-7);
    // largest pull at contact: H R/(6 D0^2)
    close("smallest force", out.force_min, -hamaker * r / (6.0 * d0 * d0), 1e-13);
    // no loss, by work and by the lever's balance; without harmonics the balance is off by 2.9e-19 J
    let balance = loss_by_balance(k, quality, a0, &out);
    let bare =
        loss_by_balance(k, quality, a0, &Outcome { harmonics: out.harmonics[..1].to_vec(), ..out.clone() });
    println!("loss by work {:e} J, by balance {balance:e} J, without harmonics {bare:e} J", out.loss);
    assert!(out.loss.abs() < 1e-24 && balance.abs() < 1e-23);
    digits("balance without harmonics, 1e-19 J", bare * 1e19, 2.9, 0.1);
    println!("{} evaluations", out.evaluations);
}

#[test]
fn jkr_tapping_point() {
    let (k, quality, a0, r, w) = (5.0, 150.0, 60e-9, 20e-9, 0.05);
    let modulus = 4.0 / 3.0 / (0.75 / 100e6);
    let law = Law::Jkr { k: modulus, r, w };
    let system = System::one_mode(k, TAU * 75e3, quality, k * a0 / quality, 45e-9, law);
    let options = Options { settle: 1500, measure: 2, harmonics: 40, ..Options::default() };
    let out = system.run(&mut system.free_at_top(), &options);
    digits("amplitude, nm", out.amplitude * 1e9, 51.03504654, 1e-8);
    digits("phase, deg", out.phase, 61.86202736, 1e-8);
    digits("largest force, nN", out.force_max * 1e9, 8.427959969, 1e-9);
    digits("contact share", out.contact_share, 0.1692147, 1e-7);
    digits("loss, 1e-17 J", out.loss * 1e17, 1.00110179, 1e-8);
    let area = 1.2749410291014 * PI * w * r * ((PI * w / modulus).powi(2) * r).cbrt();
    close("loss per tap", out.loss_per_tap(), area, 1e-11);
    close("loss by balance", loss_by_balance(k, quality, a0, &out), area, 1e-7);
    close("smallest force", out.force_min, -1.5 * PI * w * r, 1e-13);
    println!("{} evaluations", out.evaluations);
}

#[test]
fn tolerance_buys_digits() {
    // One tap of the JKR case, from the free swing: the end state against the tightest.
    let law = Law::Jkr { k: 1.7e8, r: 2e-8, w: 0.05 };
    let system = System::one_mode(5.0, TAU * 75e3, 150.0, 2e-9, 58e-9, law);
    let end = |tolerance: f64| {
        let mut state = system.free_at(FRAC_PI_2);
        system.advance(&mut state, 3.0 * TAU, tolerance);
        state.x[0]
    };
    let best = end(1e-14);
    let errors = [1e-6, 1e-8, 1e-10, 1e-12].map(|tolerance| (end(tolerance) - best).abs() / 60e-9);
    println!("relative errors at 1e-6, 1e-8, 1e-10, 1e-12: {errors:?}");
    for (error, tolerance) in errors.iter().zip([1e-6, 1e-8, 1e-10, 1e-12]) {
        assert!(*error < 100.0 * tolerance);
    }
}

#[test]
fn both_programs_forces_agree() {
    let (k, r, w, d0) = (1.7e8, 2e-8, 0.05, 0.2e-9);
    let (jkr, dmt) = (Jkr::new(k, r, w), Dmt::new(k, r, w, d0));
    let scale = PI * w * r;
    for i in -240..2000 {
        let delta = f64::from(i) * 1e-11;
        let theirs = Law::Dmt { k, r, w, d0 }.force(delta, delta > 0.0);
        let ours = dmt.force(delta, delta > 0.0);
        assert!((ours - theirs).abs() < 1e-14 * (scale + ours.abs()));
        if delta > jkr.release() {
            let (theirs, ours) = (Law::Jkr { k, r, w }.force(delta, true), jkr.force(delta, true));
            assert!((ours - theirs).abs() < 1e-13 * (scale + ours.abs()), "{delta:e} {ours:e} {theirs:e}");
        }
    }
    close("fold", jkr.release(), Law::Jkr { k, r, w }.release(), 1e-15);
}

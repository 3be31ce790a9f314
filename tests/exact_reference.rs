//! The independent integrator of `support` itself against closed forms, and against tapping points
//! that other programs have confirmed: it is what the engine is held against elsewhere.

mod support;

use std::f64::consts::{FRAC_PI_2, PI, TAU};
use support::laws::Law;
use support::oscillator::{Mode, Options, System};

fn close(name: &str, value: f64, expected: f64, tolerance: f64) {
    let error = (value / expected - 1.0).abs();
    println!("{name}: {value:.12e} (expected {expected:.12e}, off by {error:.1e})");
    assert!(error <= tolerance, "{name}: {value:e}, expected {expected:e}");
}

#[test]
fn dmt_tapping_point() {
    let (k, quality, a0, r) = (10.0, 25.0, 60e-9, 20e-9);
    let (hamaker, d0) = (6.4e-20, 0.2e-9);
    let modulus = 4.0 / 3.0 / (0.91 / 130e9 + 0.91 / 70e6);
    let w = hamaker / (12.0 * PI * d0 * d0);
    let law = Law::Dmt { k: modulus, r, w, d0 };
    let system = System::one_mode(k, TAU * 45e3, quality, k * a0 / quality, 39.8e-9, law);
    let options = Options { settle: 400, measure: 1, harmonics: 20, ..Options::default() };
    let out = system.run(&mut system.free_at_top(), &options);
    println!("{out:?}");
    close("amplitude", out.amplitude, 57.41833265e-9, 1e-10);
}

#[test]
fn jkr_tapping_point() {
    let (k, quality, a0, r) = (5.0, 150.0, 60e-9, 20e-9);
    let modulus = 4.0 / 3.0 / (0.75 / 100e6);
    let law = Law::Jkr { k: modulus, r, w: 0.05 };
    let system = System::one_mode(k, TAU * 75e3, quality, k * a0 / quality, 45e-9, law);
    let options = Options { settle: 1600, measure: 1, harmonics: 20, ..Options::default() };
    let out = system.run(&mut system.free_at_top(), &options);
    println!("{out:?}");
    close("amplitude", out.amplitude, 51.03504654e-9, 1e-10);
}

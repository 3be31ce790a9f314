//! The start of a run: the drive's phase at its first step, and the free motion from there.

use crate::kernel::{Real, Wave};
use crate::plan::Driven;
use crate::scene::Start;
use nalgebra::Complex;
use std::f64::consts::{FRAC_PI_2, TAU};

/// The drive's phase at the run's first instant, rad: zero from rest; in steady free motion the moment when the tip is
/// farthest from the sample.
pub(super) fn phase(driven: &Driven, start: Start) -> f64 {
    match start {
        Start::Rest => 0.0,
        Start::Steady => FRAC_PI_2 - driven.free.angle,
    }
}

/// Amplitudes of cosine and sine of the run's own phase, m: `Im(Z exp(i (theta + phase)))`.
pub(super) fn amplitudes(driven: &Driven, start: Start) -> (f64, f64) {
    match start {
        Start::Rest => (driven.free.tip.im, driven.free.tip.re),
        Start::Steady => (driven.free_amplitude(), 0.0),
    }
}

/// Phasor of harmonic `n` relative to the drive's sine, from the amplitudes relative to the run's phase.
pub(super) fn phasor(cosine: f64, sine: f64, n: usize, phase: f64) -> Complex<f64> {
    Complex::new(sine, cosine) * Complex::from_polar(1.0, -(n as f64) * phase)
}

/// Cosines and sines at the middle of each step of a period, for harmonics 1 to `harmonics`.
pub(super) fn waves<E: Real>(steps: u32, harmonics: usize) -> Vec<Vec<Wave<E>>> {
    let period = 2 * u64::from(steps);
    (1..=harmonics.max(1) as u64)
        .map(|n| {
            (0..u64::from(steps))
                .map(|step| {
                    // Reduced in whole numbers, so that the angle is exact for any harmonic.
                    let angle = TAU * ((n * (2 * step + 1)) % period) as f64 / period as f64;
                    Wave { cosine: E::element(angle.cos()), sine: E::element(angle.sin()) }
                })
                .collect()
        })
        .collect()
}

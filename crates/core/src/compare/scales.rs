//! The error scales of an instance.

use crate::observe::{Measured, Observable};
use crate::plan::{Driven, Plan};
use crate::scene::Start;
use nalgebra::Complex;
use std::f64::consts::PI;

/// Scales that errors are divided by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scales {
    /// Scale of amplitude, harmonics and indentation: the free tip amplitude, m.
    pub length: f64,
    /// Scale of forces: the largest of either sign, N. It is at least the elastic force at the depth to which lengths are
    /// accurate, because a shallower graze has no significant force.
    pub force: f64,
    /// Scale of dissipation and virial: work of the drive in a period, with or without the sample, or the loss, whichever is
    /// largest, J. Runs from rest have no typical period and use the largest force times the free amplitude. NaN if none of
    /// these is requested.
    pub work: f64,
    /// Shift of the resonance, to first order, that an error of the whole free amplitude in the fundamental makes, Hz.
    pub shift: f64,
}

impl Scales {
    /// Scales of an instance with the true measurements `truth`.
    pub fn of(plan: &Plan, instance: usize, truth: &Measured) -> Self {
        let case = plan.case(instance as u32);
        let driven = plan.driven(instance as u32);
        let length = driven.free_amplitude();
        let graze = case.contact.law().elastic_force(plan.run.accuracy * length);
        // Quantities that were not requested are NaN, which max ignores.
        let force = graze.max(truth.force_max.abs()).max(truth.force_min.abs());
        let swing = force * length;
        let works = [Observable::Dissipation, Observable::Virial];
        let asked = plan.observables.iter().any(|one| works.contains(one));
        let work = match plan.run.start {
            _ if !asked => f64::NAN,
            Start::Rest => swing,
            Start::Steady => {
                let tapping = drive_work(driven, tip(truth));
                drive_work(driven, driven.free.tip).abs().max(tapping.abs()).max(truth.dissipation.abs())
            }
        };
        // Without damping there is no work.
        let work = if work > 0.0 || !asked { work } else { swing };
        Self { length, force, work, shift: shift(driven, truth) }
    }
}

/// Computes [`Scales::shift`] from `(f/f0)^2 = 1 - Re((1 - z0/z)/C)/k`. z and z0 are the tip's fundamental with and without
/// the sample, C is the compliance. A small error d of z changes f by at most `f0^2 |z0 d/z^2|/(2 f k |C|)`.
fn shift(driven: &Driven, truth: &Measured) -> f64 {
    let (frequency, stiffness) = driven.free.first_mode;
    let left = truth.harmonics[0] / driven.free_amplitude();
    let of_free = frequency / (2.0 * stiffness * driven.free.compliance.norm());
    of_free / (left * left * (1.0 + truth.frequency_shift / frequency))
}

/// Fundamental of the tip's travel, m: the travel is the imaginary part of it times exp(i omega t).
pub fn tip(measured: &Measured) -> Complex<f64> {
    Complex::from_polar(measured.harmonics[0], -measured.phase.to_radians())
}

/// Work of the drive in a period (J) if the fundamental of the tip's travel is `tip`. It determines the fundamental of the
/// contact force, because the instrument is linear, and the drive works with no other harmonic.
fn drive_work(driven: &Driven, tip: Complex<f64>) -> f64 {
    let (free, instrument) = (&driven.free, &driven.instrument);
    let omega = free.omega;
    let response: Vec<Complex<f64>> = instrument
        .modes
        .iter()
        .map(|mode| {
            let stiffness = (mode.omega - omega) * (mode.omega + omega);
            mode.force / Complex::new(stiffness, omega * mode.omega / mode.quality_factor)
        })
        .collect();
    let moves: Complex<f64> = instrument.modes.iter().zip(&response).map(|(mode, z)| z * mode.tip).sum();
    let force = (tip - free.tip) / moves;
    // A drive through the base counts by its acceleration, -omega^2 level.
    let per_level = if instrument.moving_base { -omega * omega } else { 1.0 };
    let moved: f64 = (instrument.modes.iter().zip(&response).enumerate())
        .map(|(k, (mode, response))| mode.drive * (free.mode(k) + response * force).im)
        .sum();
    let through_base = if instrument.moving_base { force.im } else { 0.0 };
    -PI * free.level * (per_level * moved + through_base)
}

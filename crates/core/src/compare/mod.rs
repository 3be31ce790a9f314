//! Errors of one result of an instance against another, on the scales of `[run] accuracy`.

mod ranking;
mod scales;

pub use ranking::{Ranking, choose, ranked};
pub use scales::{Scales, tip};

use crate::observe::{Measured, Observable, Scale};

/// The numbers of an observable: one, or one per harmonic.
pub fn numbers(observable: Observable, measured: &Measured) -> Vec<f64> {
    let mut row = vec![0.0; observable.width()];
    observable.write(measured, &mut row);
    row
}

/// Error of `ours` against `truth` in one observable, on its scale. For several harmonics, the largest.
pub fn error(observable: Observable, ours: &Measured, truth: &Measured, scales: &Scales) -> f64 {
    error_of(observable, &numbers(observable, ours), truth, scales)
}

/// Error like [`error`], for [`numbers`] from another source.
pub fn error_of(observable: Observable, ours: &[f64], truth: &Measured, scales: &Scales) -> f64 {
    let theirs = numbers(observable, truth);
    let first = |row: &[f64]| *row.first().unwrap_or(&f64::NAN);
    let scale = match observable.scale() {
        Scale::Length | Scale::Depth => scales.length,
        Scale::Force => scales.force,
        Scale::Work => scales.work,
        Scale::WorkOrItself => scales.work.max(first(&theirs).abs()),
        Scale::One => 1.0,
        Scale::Shift => scales.shift,
        // Without travel there is no phase.
        Scale::Phase => return turn(first(ours), first(&theirs)) * share(truth.harmonics[0], scales),
        Scale::DeflectionPhase => {
            return turn(first(ours), first(&theirs)) * share(truth.deflection_amplitude, scales);
        }
    };
    let missed = observable.scale() == Scale::Depth;
    let difference = |(a, b): (&f64, &f64)| match (a.is_nan(), b.is_nan()) {
        (true, true) => 0.0,
        (true, false) if missed => b.abs(),
        (false, true) if missed => a.abs(),
        _ => (a - b).abs(),
    };
    let difference = ours.iter().zip(&theirs).map(difference).fold(0.0, largest);
    if difference == 0.0 { 0.0 } else { difference / scale }
}

/// Distance between two angles in degree, rad.
fn turn(ours: f64, theirs: f64) -> f64 {
    ((ours - theirs + 180.0).rem_euclid(360.0) - 180.0).to_radians().abs()
}

/// Ratio of an amplitude to the free one, at most 1.
fn share(amplitude: f64, scales: &Scales) -> f64 {
    (amplitude / scales.length).min(1.0)
}

/// Largest error of these observables. NaN counts as infinite.
pub fn worst(observables: &[Observable], ours: &Measured, truth: &Measured, scales: &Scales) -> f64 {
    observables.iter().map(|observable| error(*observable, ours, truth, scales)).fold(0.0, largest)
}

fn largest(sofar: f64, error: f64) -> f64 {
    if error.is_nan() { f64::INFINITY } else { sofar.max(error) }
}

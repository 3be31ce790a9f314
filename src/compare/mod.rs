//! Results of one instance side by side: errors on the scales on which `[run] accuracy` counts.

mod choose;
mod scales;

pub use choose::{choose, ranked};
pub use scales::Scales;

use crate::observe::{Measured, Observable};

/// The numbers of an observable: one, or one per harmonic.
pub fn numbers(observable: Observable, measured: &Measured) -> Vec<f64> {
    let mut row = vec![0.0; observable.width()];
    observable.write(measured, &mut row);
    row
}

/// How far `ours` is from `truth` in one observable, on its scale; of several harmonics the largest.
pub fn error(observable: Observable, ours: &Measured, truth: &Measured, scales: &Scales) -> f64 {
    error_of(observable, &numbers(observable, ours), truth, scales)
}

/// The same for [`numbers`] that come from elsewhere. An indentation that only one of the two has counts in
/// full: one of them just misses the sample.
pub fn error_of(observable: Observable, ours: &[f64], truth: &Measured, scales: &Scales) -> f64 {
    let scale = match observable {
        Observable::Amplitude | Observable::IndentationMax | Observable::HarmonicAmplitude => scales.length,
        Observable::ForceMax | Observable::ForceMin | Observable::ForceMean => scales.force,
        Observable::Dissipation => scales.work,
        Observable::Virial => scales.work.max(truth.virial.abs()),
        Observable::ContactTime | Observable::Contacts => 1.0,
        Observable::Phase => {
            let turn = (ours.first().unwrap_or(&f64::NAN) - truth.phase + 180.0).rem_euclid(360.0) - 180.0;
            // Without a travel there is no phase.
            return turn.to_radians().abs() * (truth.harmonics[0] / scales.length).min(1.0);
        }
    };
    let missed = observable == Observable::IndentationMax;
    let difference = |(a, b): (&f64, &f64)| match (a.is_nan(), b.is_nan()) {
        (true, true) => 0.0,
        (true, false) if missed => b.abs(),
        (false, true) if missed => a.abs(),
        _ => (a - b).abs(),
    };
    let difference = ours.iter().zip(&numbers(observable, truth)).map(difference).fold(0.0, largest);
    if difference == 0.0 { 0.0 } else { difference / scale }
}

/// The largest of these observables' errors; what is no number counts as infinite.
pub fn worst(observables: &[Observable], ours: &Measured, truth: &Measured, scales: &Scales) -> f64 {
    observables.iter().map(|observable| error(*observable, ours, truth, scales)).fold(0.0, largest)
}

fn largest(sofar: f64, error: f64) -> f64 {
    if error.is_nan() { f64::INFINITY } else { sofar.max(error) }
}

//! What a solver answers for an instance, how it is measured, and how far it is from the truth.

use crate::problem::Problem;
use crate::random::quantile;
use afmsweep::compare::{Scales, worst};
use afmsweep::engine::Finished;
use afmsweep::observe::{Measured, Status};
use afmsweep::plan::Plan;
use serde::{Deserialize, Serialize};

/// Of the measured periods, in the units of the reduced problem.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Answer {
    /// The travel's fundamental, free motion included.
    pub cosine: f64,
    pub sine: f64,
    /// Largest force on the tip.
    pub force_max: f64,
    /// Loss in the sample per period.
    pub loss: f64,
}

/// Errors of an ensemble: of each instance the worst of its observables, on its scale.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Errors {
    pub median: f64,
    pub p95: f64,
    pub largest: f64,
    pub counted: usize,
}

impl Problem {
    /// Errors of what a solver measured of these instances, where the truth can be used.
    pub fn errors(&self, results: impl Iterator<Item = (usize, Measured)>) -> Errors {
        self.errors_from(&self.truth, results)
    }

    /// The same with another truth, of each instance.
    pub fn errors_from(
        &self,
        truth: &[Finished],
        results: impl Iterator<Item = (usize, Measured)>,
    ) -> Errors {
        Errors::of(&self.plan, truth, results)
    }
}

impl Errors {
    /// Of a plan's instances whose truth can be used.
    pub fn of(plan: &Plan, truth: &[Finished], results: impl Iterator<Item = (usize, Measured)>) -> Self {
        let mut errors: Vec<f64> = results
            .filter(|(i, _)| truth[*i].status == Status::Ok)
            .map(|(i, ours)| {
                let truth = &truth[i].measured;
                worst(&plan.observables, &ours, truth, &Scales::of(plan, i, truth))
            })
            .collect();
        errors.sort_by(f64::total_cmp);
        let [median, p95, largest] = [0.5, 0.95, 1.0].map(|share| quantile(&errors, share));
        Self { median, p95, largest, counted: errors.len() }
    }
}

/// Indentation, its rate and its acceleration, at one place of a path.
pub type Place = [f64; 3];

/// The largest indentation between two places that are `h` apart, by the quintic that both share.
pub fn peak(h: f64, from: &Place, to: &Place) -> f64 {
    if !(from[1] > 0.0 && to[1] < 0.0) {
        return from[0].max(to[0]);
    }
    let at = quintic(h, from, to);
    // Bisection on the rate, finished by a parabola's worth of digits: the peak is flat.
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..30 {
        let middle = 0.5 * (low + high);
        if at(middle).1 > 0.0 { low = middle } else { high = middle }
    }
    at(0.5 * (low + high)).0
}

/// The quintic through two places: value, and rate per share, at the share `u` of the way.
pub fn quintic(h: f64, from: &Place, to: &Place) -> impl Fn(f64) -> (f64, f64) {
    let [a, b, c] = [from[0], h * from[1], 0.5 * h * h * from[2]];
    let rise = to[0] - a - b - c;
    let slope = h * to[1] - b - 2.0 * c;
    let bend = 0.5 * h * h * to[2] - c;
    let d = 10.0 * rise - 4.0 * slope + bend;
    let e = -15.0 * rise + 7.0 * slope - 2.0 * bend;
    let f = 6.0 * rise - 3.0 * slope + bend;
    move |u| {
        let value = a + u * (b + u * (c + u * (d + u * (e + u * f))));
        (value, b + u * (2.0 * c + u * (3.0 * d + u * (4.0 * e + u * 5.0 * f))))
    }
}

//! A quantity before and after observations.

use super::super::axis::PlotAxis;
use super::super::labels::{label, short};
use super::super::shown;
use super::DECADE;
use crate::stats::{Posterior, quantile};
use crate::store::Coordinate;
use afmsweep_data::design::Distribution;

/// What is left out of its panels at either end.
const BEYOND: f64 = 1e-3;
/// Values of a prior that is known by its distribution alone.
const OF_PRIOR: usize = 4000;
/// A median and both ends of what lies 95 % around it.
const SHARES: [f64; 3] = [0.5, 0.025, 0.975];

/// A quantity before and after.
pub(super) struct PriorPosterior<'a> {
    pub units: &'a str,
    /// By row of the posterior.
    pub values: Vec<f64>,
    pub prior: Vec<f64>,
    pub axis: PlotAxis,
    /// Median and 95 % before, and after.
    before: [f64; 3],
    after: [f64; 3],
    long: &'a str,
}

impl<'a> PriorPosterior<'a> {
    pub fn of(one: &'a Coordinate, prior: Option<&Distribution>, posterior: &Posterior) -> Self {
        let values: Vec<f64> = posterior.rows.iter().map(|row| one.values[*row]).collect();
        let mut before: Vec<f64> = match prior {
            None => values.clone(),
            Some(prior) => (0..OF_PRIOR).map(|n| prior.value((n as f64 + 0.5) / OF_PRIOR as f64)).collect(),
        };
        before.sort_by(f64::total_cmp);
        let at = |share: f64| posterior.quantile(&one.values, share);
        let (low, high) = (at(BEYOND), at(1.0 - BEYOND));
        let log = low > 0.0 && high > DECADE * low;
        let brief = short(one);
        let axis = PlotAxis::over([low, high].into_iter(), &one.units, &brief, log, 0.0);
        // Room for what was thought likely before, as far as that went.
        let (first, last) = (axis.scaled(low), axis.scaled(high));
        let room = 0.35 * (last - first);
        let end = |value: Option<&f64>| value.map_or(f64::NAN, |value| axis.scaled(*value));
        let (least, most) = ((first - room).max(end(before.first())), (last + room).min(end(before.last())));
        let axis = if most > least { axis.between(least, most) } else { axis };
        Self {
            before: SHARES.map(|share| quantile(&before, share)),
            after: SHARES.map(at),
            units: &one.units,
            long: label(one),
            prior: before,
            values,
            axis,
        }
    }

    /// How much of what was open before is open after.
    pub fn left(&self) -> f64 {
        (self.after[2] - self.after[1]) / (self.before[2] - self.before[1])
    }

    pub fn sentence(&self) -> String {
        let at = |n: usize| shown(self.after[n], self.units, 3);
        format!("{} {} (95\u{a0}% from {} to {})", self.long, at(0), at(1), at(2))
    }

    pub fn row(&self) -> Vec<String> {
        let cells = [self.before, self.after].concat();
        let cells = cells.iter().map(|value| shown(*value, self.units, 4));
        std::iter::once(self.long.to_owned()).chain(cells).collect()
    }
}

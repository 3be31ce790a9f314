//! Estimates with their 95 % intervals: from replicates where a design has them, by a bootstrap otherwise.

use crate::design::Mix;
use rayon::prelude::*;
use statrs::distribution::{ContinuousCDF, StudentsT};

/// Quantile of the normal distribution that an interval of 95 % reaches to.
pub const NORMAL_95: f64 = 1.959_963_984_540_054;
/// Resamples of a bootstrap: the standard deviation of so many is known to 4 %.
const RESAMPLES: u64 = 300;

/// A number and half the width of its 95 % interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    pub value: f64,
    /// NaN where nothing tells.
    pub half_width: f64,
}

impl Estimate {
    /// Whether the interval holds zero: the number may be nothing but chance.
    pub fn holds_zero(&self) -> bool {
        self.value.abs() <= self.half_width
    }
}

/// What a design tells of the spread of what is estimated from it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Spread {
    /// So many independent scrambles, which base samples belong to in turn: leaving out one after the other (jackknife) and
    /// Student's t. Points of one scramble are balanced, which a bootstrap would not know: there it is too wide.
    Replicates(usize),
    /// Base samples drawn again with the seed, with replacement.
    Bootstrap(u64),
}

impl Spread {
    pub fn name(self) -> &'static str {
        match self {
            Self::Replicates(_) => "replicates",
            Self::Bootstrap(_) => "bootstrap",
        }
    }

    /// What a statistic is of these base samples, with intervals. `units` are their numbers in the design.
    pub fn estimate(self, units: &[u32], statistic: impl Fn(&[u32]) -> Vec<f64> + Sync) -> Vec<Estimate> {
        let values = statistic(units);
        let half_widths = match self {
            Self::Replicates(count) => jackknife(count, units, &statistic, values.len()),
            Self::Bootstrap(seed) => bootstrap(seed, units, &statistic, values.len()),
        };
        values
            .into_iter()
            .zip(half_widths)
            .map(|(value, half_width)| Estimate { value, half_width })
            .collect()
    }
}

/// Half-widths from what the statistic is without one replicate after the other.
fn jackknife(
    count: usize,
    units: &[u32],
    statistic: &(impl Fn(&[u32]) -> Vec<f64> + Sync),
    width: usize,
) -> Vec<f64> {
    let without = |replicate: usize| {
        let others: Vec<u32> =
            units.iter().copied().filter(|unit| *unit as usize % count != replicate).collect();
        statistic(&others)
    };
    let left: Vec<Vec<f64>> = (0..count).into_par_iter().map(without).collect();
    let freedom = count as f64 - 1.0;
    let t = StudentsT::new(0.0, 1.0, freedom).map_or(f64::NAN, |t| t.inverse_cdf(0.975));
    (0..width)
        .map(|n| {
            let mean = left.iter().map(|one| one[n]).sum::<f64>() / count as f64;
            let squares: f64 = left.iter().map(|one| (one[n] - mean).powi(2)).sum();
            t * (freedom / count as f64 * squares).sqrt()
        })
        .collect()
}

/// Half-widths from the standard deviation over resamples.
fn bootstrap(
    seed: u64,
    units: &[u32],
    statistic: &(impl Fn(&[u32]) -> Vec<f64> + Sync),
    width: usize,
) -> Vec<f64> {
    if units.len() < 2 {
        return vec![f64::NAN; width];
    }
    let again = |number: u64| {
        let mix = Mix::new(seed).of(number);
        let drawn = |i: usize| units[mix.of(i as u64).below(units.len() as u64) as usize];
        statistic(&(0..units.len()).map(drawn).collect::<Vec<u32>>())
    };
    let resamples: Vec<Vec<f64>> = (0..RESAMPLES).into_par_iter().map(again).collect();
    (0..width)
        .map(|n| {
            let values: Vec<f64> = resamples.iter().map(|one| one[n]).collect();
            NORMAL_95 * sd(&values)
        })
        .collect()
}

pub fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Standard deviation of a sample (over n - 1).
pub fn sd(values: &[f64]) -> f64 {
    let mean = mean(values);
    let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    (squares / (values.len() as f64 - 1.0)).sqrt()
}

/// A quantile of rising values, linear between them (definition 7 of R. J. Hyndman and Y. Fan, Am. Stat. 50, 361 (1996)).
pub fn quantile(rising: &[f64], share: f64) -> f64 {
    let Some(last) = rising.len().checked_sub(1) else { return f64::NAN };
    let place = share * last as f64;
    let (low, part) = (place.floor() as usize, place.fract());
    rising[low] + part * (rising[(low + 1).min(last)] - rising[low])
}

/// Quantiles of values drawn independently: half-widths from the values that stand where a binomial number of successes
/// may lie, which hold under any distribution.
pub fn quantiles_by_order(rising: &[f64], shares: &[f64]) -> Vec<Estimate> {
    let count = rising.len() as f64;
    let one = |share: &f64| {
        let reach = NORMAL_95 * (count * share * (1.0 - share)).sqrt();
        let at = |place: f64| {
            let place = (place.round().max(0.0) as usize).min(rising.len().saturating_sub(1));
            rising.get(place).copied().unwrap_or(f64::NAN)
        };
        let (low, high) = (at(count * share - reach - 0.5), at(count * share + reach - 0.5));
        Estimate { value: quantile(rising, *share), half_width: 0.5 * (high - low) }
    };
    shares.iter().map(one).collect()
}

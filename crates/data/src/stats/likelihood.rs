//! What observations tell of uncertain parameters: samples of the prior, weighted by a Gaussian likelihood.
//!
//! No sampler: the design's rows are the sample, and each counts by how well its observables agree with what was observed.
//! The effective sample size says whether that is enough.

use super::observable_summary::reasons;
use super::study_samples::status_word;
use super::{StatsError, Study, SummaryOptions};
use crate::design::DesignKind;
use crate::store::Coordinate;
use std::collections::BTreeMap;

/// Fewer effective samples than this tell nothing to be relied on.
pub const FEWEST_EFFECTIVE: f64 = 50.0;

/// Where there are too few effective samples, the message says where the rows lie that agree about as well as the best one: the
/// logarithms of their likelihoods are lower by no more than this, three standard deviations of one value.
const AGREES_WITHIN: f64 = 4.5;

/// What was observed, SI: a value and its standard deviation.
#[derive(Clone, Debug, PartialEq)]
pub struct Observed {
    pub name: String,
    pub value: f64,
    pub sd: f64,
}

/// The weighted samples at a point of the sweep.
#[derive(Clone, Debug)]
pub struct Posterior {
    /// Rows that count, and the weight of each; weights sum to 1.
    pub rows: Vec<usize>,
    pub weights: Vec<f64>,
    /// One over the sum of squared weights (L. Kish, Survey Sampling, 1965): as many samples of equal weight would tell as
    /// much.
    pub effective: f64,
    /// Rows that failed, and were left out.
    pub left_out: usize,
    /// Smallest sum of squared misses, in standard deviations: how well the best row agrees.
    pub best_chi_squared: f64,
}

/// Weighs the rows of a study by what was observed.
///
/// # Errors
/// Unknown observables, a design whose rows are no sample of the parameters, too few effective samples, and more failed
/// rows than the options allow.
pub fn posterior(
    study: &Study,
    point: usize,
    observed: &[Observed],
    options: &SummaryOptions,
) -> Result<Posterior, StatsError> {
    let columns: Vec<(Vec<f64>, &Observed)> = observed
        .iter()
        .map(|one| Ok((study.at(&study.output(&one.name)?.values, point), one)))
        .collect::<Result<_, StatsError>>()?;
    // A row that has no value of an observable, as no indentation without contact, cannot be what was observed: it counts,
    // with no weight.
    let rows = counted(study, &study.at(&study.status, point), options)?;
    let miss = |row: &usize| -> f64 {
        let of = |(values, one): &(Vec<f64>, &Observed)| {
            let miss = (off(values[*row], one.value, is_phase(&one.name)) / one.sd).powi(2);
            if miss.is_nan() { f64::INFINITY } else { miss }
        };
        columns.iter().map(of).sum()
    };
    let chi_squared: Vec<f64> = rows.iter().map(miss).collect();
    let best = chi_squared.iter().copied().fold(f64::INFINITY, f64::min);
    let logs: Vec<f64> = chi_squared.iter().map(|chi| -0.5 * chi).collect();
    weighed(rows, &logs, (best, observed.len()), study)
}

/// The rows that count, by the status of each.
pub(super) fn counted(
    study: &Study,
    status: &[u8],
    options: &SummaryOptions,
) -> Result<Vec<usize>, StatsError> {
    if matches!(study.design.kind, DesignKind::Saltelli | DesignKind::Morris) {
        return Err(StatsError::NoSample { kind: study.design.kind.word() });
    }
    let rows: Vec<usize> = (0..status.len()).filter(|row| options.counts(status[*row])).collect();
    let lost = status.len() - rows.len();
    if lost as f64 <= options.most_left_out * status.len() as f64 && !rows.is_empty() {
        return Ok(rows);
    }
    let mut failed = BTreeMap::new();
    let codes = status.iter().filter(|code| !options.counts(**code));
    codes.for_each(|code| *failed.entry(status_word(*code)).or_insert(0) += 1);
    Err(StatsError::LeftOut {
        output: "what was observed".into(),
        lost,
        rows: status.len(),
        share: 100.0 * options.most_left_out,
        told: reasons(&failed),
    })
}

/// Rows with the logarithms of their likelihoods, of so many rows in all; how well the best of them agrees with how many
/// values of this study.
pub(super) fn weighed(
    rows: Vec<usize>,
    logs: &[f64],
    (best_chi_squared, values): (f64, usize),
    study: &Study,
) -> Result<Posterior, StatsError> {
    let most = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let weights: Vec<f64> = logs.iter().map(|log| (log - most).exp()).collect();
    let sum: f64 = weights.iter().sum();
    let weights: Vec<f64> = weights.iter().map(|weight| weight / sum).collect();
    let effective = 1.0 / weights.iter().map(|weight| weight * weight).sum::<f64>();
    let left_out = study.rows() - rows.len();
    match effective >= FEWEST_EFFECTIVE {
        true => Ok(Posterior { rows, weights, effective, left_out, best_chi_squared }),
        false => Err(StatsError::FewEffective {
            effective: if effective.is_nan() { 0.0 } else { effective },
            rows: rows.len(),
            best: best_chi_squared.sqrt(),
            each: (best_chi_squared / values as f64).sqrt(),
            spans: spans(study, &rows, logs, most),
        }),
    }
}

/// A sentence on where the rows lie that agree about as well as the best one, of each parameter of the study; empty where none
/// has a value of all that was observed.
fn spans(study: &Study, rows: &[usize], logs: &[f64], most: f64) -> String {
    let agree = |log: &&f64| most - **log <= AGREES_WITHIN;
    let near: Vec<usize> = rows.iter().zip(logs).filter(|(_, log)| agree(log)).map(|both| *both.0).collect();
    let span = |one: &Coordinate| {
        let values = near.iter().map(|row| one.values[*row]);
        let (low, high) =
            values.fold((f64::INFINITY, f64::NEG_INFINITY), |ends, at| (ends.0.min(at), ends.1.max(at)));
        format!("{} from {} to {} {}", one.name, four_digits(low), four_digits(high), one.units)
    };
    let all: Vec<String> = study.parameters.iter().filter(|one| one.words.is_empty()).map(span).collect();
    if near.is_empty() { String::new() } else { format!("What agrees best has {}. ", all.join(", ")) }
}

/// A number with the digits that a message needs.
fn four_digits(value: f64) -> f64 {
    format!("{value:.3e}").parse().unwrap_or(value)
}

/// Whether an observable is an angle in degree, which goes round.
pub(super) fn is_phase(name: &str) -> bool {
    name.ends_with("phase")
}

/// How far a value is from another; of phases, in degree, the short way round.
pub(super) fn off(value: f64, other: f64, is_phase: bool) -> f64 {
    let off = value - other;
    if is_phase { off - 360.0 * (off / 360.0).round() } else { off }
}

impl Posterior {
    /// The rows that have more than this share of the largest weight, the others' left out.
    pub fn heavy(&self, share: f64) -> Self {
        let most = self.weights.iter().copied().fold(0.0, f64::max);
        let kept = self.rows.iter().zip(&self.weights).filter(|(_, weight)| **weight > share * most);
        let (rows, weights) = kept.map(|(row, weight)| (*row, *weight)).unzip();
        Self { rows, weights, ..*self }
    }

    /// A weighted quantile of values by row: the least of them that at least `share` of the weight is not above, halfway to
    /// the next.
    pub fn quantile(&self, values: &[f64], share: f64) -> f64 {
        let mut order: Vec<(f64, f64)> =
            self.rows.iter().zip(&self.weights).map(|(row, weight)| (values[*row], *weight)).collect();
        order.retain(|(value, _)| value.is_finite());
        order.sort_by(|a, b| a.0.total_cmp(&b.0));
        let all: f64 = order.iter().map(|(_, weight)| weight).sum();
        let mut below = 0.0;
        let mut before: Option<(f64, f64)> = None;
        for (value, weight) in order {
            // The weight of a value stands at its middle; between values it is linear.
            let middle = (below + 0.5 * weight) / all;
            if middle >= share {
                return match before {
                    Some((at, place)) if middle > place => {
                        at + (value - at) * (share - place) / (middle - place)
                    }
                    _ => value,
                };
            }
            before = Some((value, middle));
            below += weight;
        }
        before.map_or(f64::NAN, |(value, _)| value)
    }

    pub fn mean(&self, values: &[f64]) -> f64 {
        self.rows.iter().zip(&self.weights).map(|(row, weight)| values[*row] * weight).sum()
    }

    pub fn sd(&self, values: &[f64]) -> f64 {
        self.covariance(values, values).sqrt()
    }

    fn covariance(&self, a: &[f64], b: &[f64]) -> f64 {
        let (of_a, of_b) = (self.mean(a), self.mean(b));
        let terms = self.rows.iter().zip(&self.weights);
        terms.map(|(row, weight)| (a[*row] - of_a) * (b[*row] - of_b) * weight).sum()
    }

    /// Linear correlation of two parameters under the weights.
    pub fn correlation(&self, a: &[f64], b: &[f64]) -> f64 {
        let largest = |values: &[f64]| self.rows.iter().map(|row| values[*row].abs()).fold(0.0, f64::max);
        let scale = |values: &[f64]| largest(values).max(f64::MIN_POSITIVE);
        // Squares of SI sizes may leave the range of numbers.
        let (a, b): (Vec<f64>, Vec<f64>) =
            (a.iter().map(|v| v / scale(a)).collect(), b.iter().map(|v| v / scale(b)).collect());
        self.covariance(&a, &b) / (self.covariance(&a, &a) * self.covariance(&b, &b)).sqrt()
    }
}

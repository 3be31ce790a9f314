//! What a study tells of an observable at one point of its sweep.

use super::estimate::{Estimate, Spread, mean, quantile, quantiles_by_order, sd};
use super::study_samples::status_word;
use super::{StatsError, Study, StudyOutput, bins, elementary_effects, saltelli};
use crate::design::DesignKind;
use crate::observe::Status;
use std::collections::BTreeMap;

/// Shares of which quantiles are told.
pub const SHARES: [f64; 7] = [0.025, 0.05, 0.25, 0.5, 0.75, 0.95, 0.975];

/// Fewer rows than this make few bins.
const FEW: usize = 256;
/// Why a row is left out that has no status of its own.
const NO_VALUE: &str = "no_value";
/// Why a row is left out that is whole itself.
const OF_ITS_SAMPLE: &str = "beside_a_failed_row";

/// What is to be done about rows that failed.
#[derive(Clone, Debug)]
pub struct SummaryOptions {
    /// Largest share of rows that may be left out.
    pub most_left_out: f64,
    /// Statuses beside ok whose values count.
    pub kept: Vec<Status>,
}

impl Default for SummaryOptions {
    fn default() -> Self {
        Self { most_left_out: 0.05, kept: Vec::new() }
    }
}

impl SummaryOptions {
    /// Whether the values of an instance of this status count.
    pub fn counts(&self, code: u8) -> bool {
        code == Status::Ok as u8 || self.kept.iter().any(|kept| *kept as u8 == code)
    }
}

/// An observable over the samples at one point.
#[derive(Clone, Debug)]
pub struct Summary {
    /// Rows that count.
    pub count: usize,
    /// Rows that do not, by their status.
    pub left_out: BTreeMap<&'static str, usize>,
    /// Mean, standard deviation and quantiles; none for trajectories, which stand on a grid and are not drawn.
    pub spread: Option<Distributed>,
    pub indices: SensitivityIndices,
    /// What first-order shares of correlated parameters, which overlap, add to.
    pub overlap: Option<f64>,
    /// The same from the first half of the base samples, and from all.
    pub convergence: Vec<Convergence>,
    /// How intervals were come by.
    pub intervals: Spread,
    /// Median and largest estimated error of the simulation, on the scale of accuracy; NaN where nothing is known.
    pub simulation_error: (f64, f64),
}

/// How the output is distributed.
#[derive(Clone, Debug, PartialEq)]
pub struct Distributed {
    pub mean: Estimate,
    pub sd: Estimate,
    /// Of [`SHARES`].
    pub quantiles: Vec<Estimate>,
}

/// What the parameters, or groups of them, have to do with it.
#[derive(Clone, Debug)]
pub enum SensitivityIndices {
    Saltelli(saltelli::SobolIndices),
    Morris(elementary_effects::Effects),
    /// First order by bins.
    Bins(Vec<Estimate>),
}

/// What so many base samples tell.
#[derive(Clone, Debug)]
pub struct Convergence {
    pub samples: usize,
    pub mean: Option<Estimate>,
    /// First order, or mean size of an effect.
    pub first: Vec<Estimate>,
    /// Total, where there is one.
    pub total: Vec<Estimate>,
}

/// An output's rows at a point, sorted into base samples.
struct Rows<'a> {
    study: &'a Study,
    values: Vec<f64>,
    /// Base samples of which every row counts.
    units: Vec<u32>,
    per: usize,
    spread: Spread,
}

/// Tells of an output at a point of the sweep.
///
/// # Errors
/// More rows are left out than the options allow, or none is left.
pub fn summary(
    study: &Study,
    output: &StudyOutput,
    point: usize,
    options: &SummaryOptions,
) -> Result<Summary, StatsError> {
    let (status, values) = (study.at(&study.status, point), study.at(&output.values, point));
    let per = study.design.rows_per_sample();
    let (units, left_out) = sorted(&status, &values, per, options);
    let rows = values.len();
    let lost: usize = left_out.values().sum();
    if lost as f64 > options.most_left_out * rows as f64 || units.is_empty() {
        return Err(StatsError::LeftOut {
            output: output.name.clone(),
            lost,
            rows,
            share: 100.0 * options.most_left_out,
            told: reasons(&left_out),
        });
    }
    let spread = match study.design.replicates {
        1 => Spread::Bootstrap(study.design.seed),
        count => Spread::Replicates(count),
    };
    let errors = study.at(&study.errors, point);
    let of_units = units.iter().flat_map(|unit| *unit as usize * per..(*unit as usize + 1) * per);
    let mut errors: Vec<f64> = of_units.map(|row| errors[row]).filter(|error| !error.is_nan()).collect();
    errors.sort_by(f64::total_cmp);
    let count = units.len() * per;
    let half: Vec<u32> =
        units.iter().copied().filter(|unit| (*unit as usize) < study.design.samples / 2).collect();
    let all = Rows { study, values, units, per, spread };
    let first_half = Rows { units: half, values: all.values.clone(), ..all };
    let (distributed, indices) = (all.distributed(), all.indices());
    let mut convergence = Vec::new();
    if first_half.units.len() >= 2 {
        convergence.push(first_half.convergence(&first_half.distributed(), &first_half.indices()));
    }
    convergence.push(all.convergence(&distributed, &indices));
    let overlap = match &indices {
        SensitivityIndices::Bins(first) if study.correlated() => {
            Some(first.iter().map(|one| one.value).sum())
        }
        _ => None,
    };
    Ok(Summary {
        overlap,
        count,
        left_out,
        spread: distributed,
        indices,
        convergence,
        intervals: spread,
        simulation_error: (quantile(&errors, 0.5), errors.last().copied().unwrap_or(f64::NAN)),
    })
}

/// How many rows are left out by which word, and what each word means.
pub(super) fn reasons(left_out: &BTreeMap<&'static str, usize>) -> String {
    let told = |(word, count): (&&'static str, &usize)| {
        let status = Status::ALL.into_iter().find(|status| status.meaning() == *word);
        let reason = match (*word, status) {
            (NO_VALUE, _) => "nothing to tell there, as the indentation of a tip that never touches",
            (OF_ITS_SAMPLE, _) => "well themselves, but another row of their base sample failed",
            (_, Some(status)) => status.reason(),
            (_, None) => "a status that this program does not know",
        };
        format!("{count} {word} ({reason})")
    };
    left_out.iter().map(told).collect::<Vec<_>>().join(", ")
}

/// The rows of base samples that are ok as a whole, at a point.
pub fn sorted_out(study: &Study, point: usize) -> Vec<usize> {
    let status = study.at(&study.status, point);
    let per = study.design.rows_per_sample();
    let values = vec![0.0; status.len()];
    let (units, _) = sorted(&status, &values, per, &SummaryOptions::default());
    units.iter().flat_map(|unit| *unit as usize * per..(*unit as usize + 1) * per).collect()
}

/// Base samples of which every row counts, and how many rows do not, by why.
fn sorted(
    status: &[u8],
    values: &[f64],
    per: usize,
    options: &SummaryOptions,
) -> (Vec<u32>, BTreeMap<&'static str, usize>) {
    let why = |row: usize| match (options.counts(status[row]), values[row].is_finite()) {
        (false, _) => Some(status_word(status[row])),
        (true, false) => Some(NO_VALUE),
        (true, true) => None,
    };
    let mut left_out = BTreeMap::new();
    let mut units = Vec::new();
    for unit in 0..values.len() / per {
        let rows = unit * per..(unit + 1) * per;
        if rows.clone().all(|row| why(row).is_none()) {
            units.push(unit as u32);
        } else {
            rows.for_each(|row| *left_out.entry(why(row).unwrap_or(OF_ITS_SAMPLE)).or_insert(0) += 1);
        }
    }
    (units, left_out)
}

impl Summary {
    /// A word about shares by bins of which there are few.
    pub fn few_told(&self) -> Option<String> {
        let is_few = matches!(self.indices, SensitivityIndices::Bins(_)) && self.count < FEW;
        is_few.then(|| {
            format!(
                "first-order indices by bins of {} rows come out low, for few bins leave out much: take {FEW} rows or more",
                self.count
            )
        })
    }

    /// Words about shares by bins: that there are few, that they overlap.
    pub fn doubts(&self) -> impl Iterator<Item = String> {
        self.few_told().into_iter().chain(self.overlap_told())
    }

    /// A word about shares that overlap.
    pub fn overlap_told(&self) -> Option<String> {
        self.overlap.map(|sum| format!("correlated: shares overlap and add to {sum:.2}"))
    }
}

impl Rows<'_> {
    /// The values that are drawn from the parameters' distribution, independently of each other: of Saltelli's rows the
    /// first and the last of each base sample.
    fn drawn(&self, units: &[u32]) -> Vec<f64> {
        let own = |unit: &u32| {
            let first = *unit as usize * self.per;
            let last = first + self.per - 1;
            std::iter::once(first).chain((last > first).then_some(last))
        };
        units.iter().flat_map(own).map(|row| self.values[row]).collect()
    }

    fn distributed(&self) -> Option<Distributed> {
        if self.study.design.kind == DesignKind::Morris {
            return None;
        }
        let rising = |units: &[u32]| {
            let mut values = self.drawn(units);
            values.sort_by(f64::total_cmp);
            values
        };
        let all = match self.spread {
            Spread::Replicates(_) => self.spread.estimate(&self.units, |units| {
                let values = rising(units);
                let quantiles = SHARES.iter().map(|share| quantile(&values, *share));
                [mean(&values), sd(&values)].into_iter().chain(quantiles).collect()
            }),
            Spread::Bootstrap(_) => {
                let mut all = self.spread.estimate(&self.units, |units| {
                    let values = self.drawn(units);
                    vec![mean(&values), sd(&values)]
                });
                all.extend(quantiles_by_order(&rising(&self.units), &SHARES));
                all
            }
        };
        let [mean, sd, quantiles @ ..] = &all[..] else { return None };
        Some(Distributed { mean: *mean, sd: *sd, quantiles: quantiles.to_vec() })
    }

    fn indices(&self) -> SensitivityIndices {
        let design = &self.study.design;
        let (groups, spread) = (self.study.groups(), self.spread);
        let parameters: Vec<&[f64]> = self.study.parameters.iter().map(|one| &one.values[..]).collect();
        match design.kind {
            DesignKind::Saltelli => {
                let form = (groups.len(), design.second_order);
                SensitivityIndices::Saltelli(saltelli::indices(&self.values, &self.units, form, spread))
            }
            DesignKind::Morris => {
                let steps = elementary_effects::Steps {
                    groups: &groups,
                    parameters: &parameters,
                    levels: design.levels,
                };
                SensitivityIndices::Morris(elementary_effects::effects(
                    &self.values,
                    &self.units,
                    &steps,
                    spread,
                ))
            }
            _ => SensitivityIndices::Bins(bins::first_order(&self.values, &parameters, &self.units, spread)),
        }
    }

    fn convergence(&self, distributed: &Option<Distributed>, indices: &SensitivityIndices) -> Convergence {
        let (first, total) = match indices {
            SensitivityIndices::Saltelli(indices) => (indices.first.clone(), indices.total.clone()),
            SensitivityIndices::Morris(effects) => (effects.mu_star.clone(), Vec::new()),
            SensitivityIndices::Bins(first) => (first.clone(), Vec::new()),
        };
        let mean = distributed.as_ref().map(|one| one.mean);
        Convergence { samples: self.units.len(), mean, first, total }
    }
}

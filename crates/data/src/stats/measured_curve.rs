//! What a measured curve tells: each sample's own curve is held against it, over all offsets and factors that nobody knows.

use super::curve_pieces::{CurveLine, CurvePlace, Points};
use super::likelihood::{counted, is_phase, off, weighed};
use super::marginal::Marginal;
use super::{Posterior, StatsError, Study, SummaryOptions};
use crate::design::{Distribution, Mix};
use crate::observe::Status;
use crate::store::Coordinate;
use rayon::prelude::*;
use std::sync::Arc;

/// The stream that offsets and factors are drawn from, one of each for a sample.
const STREAM: u64 = 0x0ff5_0e70;
/// Steps over the prior of a factor, from which its likelihood is seen from afar.
const OF_SCALE: usize = 12;
/// Likewise of an offset: at least so many, at most so many, and two for a step of the curve.
const OF_OFFSET: (usize, usize) = (16, 1024);
/// Weights below this share of the largest tell nothing of a quantile.
const LIGHT: f64 = 1e-7;

/// Quantiles of a prediction.
const BAND: [f64; 3] = [0.025, 0.5, 0.975];

/// A measured curve, SI.
#[derive(Clone, Debug, Default)]
pub struct CurveMeasurement {
    /// Where each row was taken, before the offset.
    pub places: Vec<f64>,
    /// The way of each row, as `direction` of the file counts it.
    pub ways: Vec<usize>,
    pub columns: Vec<CurveColumn>,
}

/// An observable by row, with its standard deviations; NaN where a row has none.
#[derive(Clone, Debug, Default)]
pub struct CurveColumn {
    pub name: String,
    pub values: Vec<f64>,
    pub sds: Vec<f64>,
}

/// What is not known of the measurement.
#[derive(Clone, Debug, Default)]
pub struct FreeParameter {
    /// Of what is added to every measured place.
    pub offset: Option<Distribution>,
    /// Of what the model's values are multiplied by to give those measured.
    pub scale: Option<Distribution>,
    /// The observables that it multiplies.
    pub scaled: Vec<String>,
}

/// The curve of a file at a point of the axes beside it.
#[derive(Clone, Copy, Debug)]
pub struct SampleCurve<'a> {
    pub study: &'a Study,
    /// Its axis, among those beside the samples.
    pub axis: usize,
    /// Where all axes beside the samples stand; its own and that of the ways are left open.
    pub at: &'a [usize],
}

/// What was found.
#[derive(Clone, Debug)]
pub struct Fit {
    pub posterior: Posterior,
    /// An offset and a factor of each row of the study, drawn from what the measured curve leaves of them there.
    pub offset: Option<Vec<f64>>,
    pub scale: Option<Vec<f64>>,
    /// Samples of which some points failed, and that count all the same.
    pub bridged: usize,
}

/// The model's curves of one sample: of each way its points, and of each observable a line.
type Lines = Vec<Option<(Points, Vec<CurveLine>)>>;

/// How far a sample's curve is from the measured one at one offset, as a function of the factor f:
/// rest + squares - 2 f products + f^2 models.
#[derive(Clone, Copy, Debug, Default)]
struct Misses {
    rest: f64,
    squares: f64,
    products: f64,
    models: f64,
}

impl Misses {
    fn add(&mut self, other: Self) {
        self.rest += other.rest;
        self.squares += other.squares;
        self.products += other.products;
        self.models += other.models;
    }

    fn at(&self, factor: f64) -> f64 {
        self.rest + (self.squares - 2.0 * factor * self.products + factor * factor * self.models).max(0.0)
    }
}

/// What a sample makes of the measured curve.
struct Told {
    log: f64,
    best: f64,
    offset: f64,
    scale: f64,
    bridged: bool,
}

impl<'a> SampleCurve<'a> {
    pub fn coordinate(&self) -> &'a Coordinate {
        &self.study.beside[self.axis]
    }

    /// Places of its points, rising, and the numbers of these.
    fn rising(&self) -> (Vec<f64>, Vec<usize>) {
        let values = &self.coordinate().values;
        let mut order: Vec<usize> = (0..values.len()).collect();
        order.sort_by(|a, b| values[*a].total_cmp(&values[*b]));
        (order.iter().map(|n| values[*n]).collect(), order)
    }

    /// The instance of a sample at a point of the curve, on a way.
    fn instance(&self, row: usize, way: usize, point: usize) -> usize {
        let mut place = self.at.to_vec();
        place[self.axis] = point;
        if let Some(ways) = self.study.ways() {
            place[ways] = way;
        }
        self.study.instance(self.study.point(&place), row)
    }

    /// The curves of a sample, of these observables; `used` says on which ways something was measured.
    fn lines(&self, row: usize, used: &[bool], outputs: &[usize], options: &SummaryOptions) -> Lines {
        let (places, order) = self.rising();
        let one = |way: usize| {
            let instances: Vec<usize> = order.iter().map(|point| self.instance(row, way, *point)).collect();
            let known = |n: usize| options.counts(self.study.status[instances[n]]);
            let points = Points::of(&places, known, |n| {
                self.jumps((instances[n], instances[n + 1]), way, order[n] < order[n + 1])
            });
            let line = |output: &usize| {
                let output = &self.study.outputs[*output];
                let values = points.numbers.iter().map(|n| output.values[instances[*n]]).collect();
                CurveLine::of(&points, values, is_phase(&output.name))
            };
            let lines = outputs.iter().map(line).collect();
            (points, lines)
        };
        used.iter().enumerate().map(|(way, used)| used.then(|| one(way))).collect()
    }

    /// Whether the state of one of two neighbours was not reached from the other, `rising` where the first comes first along
    /// the curve; of a sweep, whether they are on two branches.
    fn jumps(&self, (a, b): (usize, usize), way: usize, rising: bool) -> bool {
        let study = self.study;
        match (&study.jumps, &study.branches) {
            (Some(jumps), _) => jumps[if rising == (way == 0) { b } else { a }] != 0,
            (None, Some(branches)) => branches[a] != branches[b] && branches[a] != 0 && branches[b] != 0,
            (None, None) => false,
        }
    }
}

impl CurveMeasurement {
    /// Values that were measured.
    pub fn values(&self) -> usize {
        self.columns.iter().map(|column| column.values.iter().filter(|value| value.is_finite()).count()).sum()
    }

    fn ways(&self) -> Vec<bool> {
        let count = self.ways.iter().max().map_or(0, |most| most + 1);
        (0..count).map(|way| self.ways.contains(&way)).collect()
    }

    /// What a row adds at a place of the model. In a jump the side counts that agrees better, with the probability that the
    /// jump, which is somewhere between its points, leaves the row on that side.
    fn row(
        &self,
        row: usize,
        (points, lines): &(Points, Vec<CurveLine>),
        (at, free): (f64, &FreeParameter),
    ) -> Misses {
        let of = |value: &dyn Fn(&CurveLine) -> f64| {
            let mut misses = Misses::default();
            for (column, line) in self.columns.iter().zip(lines) {
                let (seen, sd) = (column.values[row], column.sds[row]);
                if !seen.is_finite() {
                    continue;
                }
                let model = value(line);
                if !model.is_finite() {
                    misses.rest = f64::INFINITY;
                } else if free.scaled.contains(&column.name) {
                    misses.squares += (seen / sd).powi(2);
                    misses.products += seen * model / (sd * sd);
                    misses.models += (model / sd).powi(2);
                } else {
                    misses.rest += (off(model, seen, is_phase(&column.name)) / sd).powi(2);
                }
            }
            misses
        };
        match points.find(at) {
            CurvePlace::Nowhere => Misses { rest: f64::INFINITY, ..Misses::default() },
            CurvePlace::Smooth(before, share) => of(&|line| line.smooth(before, share)),
            CurvePlace::Jump(before, share) => {
                let side = |side: usize, probability: f64| {
                    let mut misses = of(&|line| line.sides(before, share)[side]);
                    misses.rest -= 2.0 * probability.ln();
                    misses
                };
                let (a, b) = (side(0, 1.0 - share), side(1, share));
                if a.at(1.0) <= b.at(1.0) { a } else { b }
            }
        }
    }

    fn misses(&self, lines: &Lines, offset: f64, free: &FreeParameter) -> Misses {
        let mut all = Misses::default();
        for (row, (place, way)) in self.places.iter().zip(&self.ways).enumerate() {
            if let Some(Some(lines)) = lines.get(*way) {
                all.add(self.row(row, lines, (place + offset, free)));
            }
        }
        all
    }
}

impl FreeParameter {
    /// The least and the largest offset.
    pub fn offsets(&self) -> (f64, f64) {
        self.offset.map_or((0.0, 0.0), |prior| (prior.value(0.0), prior.value(1.0)))
    }

    /// The average of the likelihood over the factor, for what is missed at one offset.
    fn over_scale(&self, misses: &Misses) -> Option<(Marginal, Distribution)> {
        let prior = self.scale?;
        Some((Marginal::of(OF_SCALE, |share| -0.5 * misses.at(prior.value(share))), prior))
    }

    fn log(&self, misses: &Misses) -> f64 {
        let log = |factor: f64| -0.5 * misses.at(factor);
        self.scale.map_or_else(
            || log(1.0),
            |prior| Marginal::log_average(OF_SCALE, |share| log(prior.value(share))),
        )
    }

    /// What one sample makes of it. `steps` are those over the prior of the offset.
    fn tell(&self, row: usize, steps: usize, misses: impl Fn(f64) -> Misses) -> Told {
        let stream = Mix::new(STREAM).of(row as u64);
        let (log, offset, at_best) = match self.offset {
            None => (self.log(&misses(0.0)), 0.0, 0.0),
            Some(prior) => {
                let over = Marginal::of(steps, |share| self.log(&misses(prior.value(share))));
                (over.log(), prior.value(over.draw(stream.of(0).share())), prior.value(over.peak.0))
            }
        };
        let scale = self
            .over_scale(&misses(offset))
            .map(|(over, prior)| prior.value(over.draw(stream.of(1).share())));
        let best = misses(at_best);
        let best_scale = self.over_scale(&best).map_or(1.0, |(over, prior)| prior.value(over.peak.0));
        Told { log, best: best.at(best_scale), offset, scale: scale.unwrap_or(1.0), bridged: false }
    }
}

/// Weighs the samples of a study by a measured curve. Rows of it that leave the model's curve under some offset must have
/// been taken out before.
///
/// # Errors
/// As [`super::posterior`].
pub fn curve_posterior(
    curve: &SampleCurve,
    measured: &CurveMeasurement,
    free: &FreeParameter,
    options: &SummaryOptions,
) -> Result<Fit, StatsError> {
    let study = curve.study;
    let outputs = measured.columns.iter().map(|column| study.output_number(&column.name));
    let outputs: Vec<usize> = outputs.collect::<Result<_, _>>()?;
    let used = measured.ways();
    let (least, most) = free.offsets();
    let ends = |way: usize| {
        let places =
            || measured.places.iter().zip(&measured.ways).filter(|(_, of)| **of == way).map(|(at, _)| *at);
        (places().fold(f64::INFINITY, f64::min) + least, places().fold(f64::NEG_INFINITY, f64::max) + most)
    };
    let (places, _) = curve.rising();
    let step = places.windows(2).map(|pair| pair[1] - pair[0]).fold(f64::INFINITY, f64::min);
    let steps = ((2.0 * (most - least) / step) as usize).clamp(OF_OFFSET.0, OF_OFFSET.1);
    let one = |row: usize| -> Result<Told, u8> {
        let lines = curve.lines(row, &used, &outputs, options);
        for (way, lines) in lines.iter().enumerate() {
            let (from, to) = ends(way);
            if lines.as_ref().is_some_and(|(points, _)| !points.hold(from, to)) {
                return Err(curve.failure(row, way, options));
            }
        }
        let bridged = lines.iter().flatten().any(|(points, _)| points.bridged);
        let told = free.tell(row, steps, |offset| measured.misses(&lines, offset, free));
        Ok(Told { bridged, ..told })
    };
    let told: Vec<Result<Told, u8>> = (0..study.rows()).into_par_iter().map(one).collect();
    let status: Vec<u8> = told.iter().map(|told| told.as_ref().err().copied().unwrap_or(0)).collect();
    let rows = counted(study, &status, &SummaryOptions { kept: Vec::new(), ..options.clone() })?;
    let kept: Vec<&Told> = rows.iter().filter_map(|row| told[*row].as_ref().ok()).collect();
    let logs: Vec<f64> = kept.iter().map(|told| told.log).collect();
    let best = kept.iter().map(|told| told.best).fold(f64::INFINITY, f64::min);
    let posterior = weighed(rows, &logs, (best, measured.values()), study)?;
    let by_row = |value: fn(&Told) -> f64| -> Vec<f64> {
        told.iter().map(|told| told.as_ref().map_or(f64::NAN, value)).collect()
    };
    Ok(Fit {
        offset: free.offset.map(|_| by_row(|told| told.offset)),
        scale: free.scale.map(|_| by_row(|told| told.scale)),
        bridged: kept.iter().filter(|told| told.bridged).count(),
        posterior,
    })
}

impl SampleCurve<'_> {
    /// A status of the points that a sample lacks.
    fn failure(&self, row: usize, way: usize, options: &SummaryOptions) -> u8 {
        let points = 0..self.coordinate().values.len();
        let status = points.map(|point| self.study.status[self.instance(row, way, point)]);
        status.filter(|code| !options.counts(*code)).max().unwrap_or(Status::OutOfRange as u8)
    }

    /// What the weighted samples say of an observable where something was or might have been measured, each with its own
    /// offset and factor: at each place the median between both ends of what lies 95 % around it.
    pub fn predicted(
        &self,
        fit: &Fit,
        output: usize,
        (way, places): (usize, &[f64]),
        (free, options): (&FreeParameter, &SummaryOptions),
    ) -> Vec<[f64; 3]> {
        let posterior = fit.posterior.heavy(LIGHT);
        let used: Vec<bool> = (0..=way).map(|one| one == way).collect();
        let scaled = free.scaled.contains(&self.study.outputs[output].name);
        let values = |row: &usize| -> Vec<f64> {
            let lines = self.lines(*row, &used, &[output], options);
            let Some(Some((points, lines))) = lines.last() else { return vec![f64::NAN; places.len()] };
            let offset = fit.offset.as_ref().map_or(0.0, |all| all[*row]);
            let scale = fit.scale.as_ref().filter(|_| scaled).map_or(1.0, |all| all[*row]);
            let value = |place: &f64| match (points.find(place + offset), &lines[0]) {
                (CurvePlace::Smooth(before, share), line) => line.smooth(before, share),
                (CurvePlace::Jump(before, share), line) => {
                    line.sides(before, share)[usize::from(share >= 0.5)]
                }
                (CurvePlace::Nowhere, _) => f64::NAN,
            };
            places.iter().map(|place| scale * value(place)).collect()
        };
        let all: Vec<Vec<f64>> = posterior.rows.par_iter().map(values).collect();
        // As if they were the study's rows: those that count, in their order.
        let alone = Posterior { rows: (0..all.len()).collect(), ..posterior };
        let at = |n: usize| {
            let column: Vec<f64> = all.iter().map(|values| values[n]).collect();
            BAND.map(|share| alone.quantile(&column, share))
        };
        (0..places.len()).map(at).collect()
    }
}

/// The offset or the factor of a fit as a quantity like any other.
pub fn quantity(name: String, long_name: String, units: &str, values: &[f64]) -> Coordinate {
    Coordinate {
        name,
        long_name,
        units: units.to_owned(),
        values: Arc::new(values.to_vec()),
        ..Coordinate::default()
    }
}

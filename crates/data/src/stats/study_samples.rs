//! The samples of a results file as statistics need them: parameters by row, outputs by point of the sweep and row.

use super::{StatsError, mean};
use crate::design::{Design, DesignDescription, DesignKind, Parameter};
use crate::observe::{Observable, Status};
use crate::store::{Coordinate, Results, Variable};

/// Path of the axis of samples.
const SAMPLES: &str = "samples";

/// Correlations of a table's columns below this say nothing, nor those within so many standard errors of none.
const LEAST_CORRELATION: f64 = 0.1;
const BY_CHANCE: f64 = 4.0;

/// A study: the samples of a results file.
#[derive(Clone, Debug)]
pub struct Study {
    pub title: String,
    pub design: DesignDescription,
    /// Values of each parameter of the design, by row; SI.
    pub parameters: Vec<Coordinate>,
    /// Names of the rows, where they have some.
    pub ids: Vec<String>,
    /// The axes beside the samples: the sweep's and the curve's.
    pub beside: Vec<Coordinate>,
    pub outputs: Vec<StudyOutput>,
    pub status: Vec<u8>,
    /// Estimated errors on the scale of accuracy; NaN where nothing is known.
    pub errors: Vec<f64>,
    /// Of a curve: 1 where the state was not reached continuously from the point before.
    pub jumps: Option<Vec<u8>>,
    /// Of a searched run: the branch of each instance.
    pub branches: Option<Vec<u8>>,
    /// Steps in the instances' order: lengths of all axes, and which is that of the samples.
    shape: Vec<usize>,
    samples_at: usize,
}

/// What was measured of every instance.
#[derive(Clone, Debug, PartialEq)]
pub struct StudyOutput {
    pub name: String,
    pub long_name: String,
    pub units: String,
    /// On what its errors count.
    pub error_scale: String,
    /// In the order of the instances.
    pub values: Vec<f64>,
}

impl Study {
    /// # Errors
    /// A file without samples, or with a design that does not fit them.
    pub fn of(results: &Results) -> Result<Self, StatsError> {
        let (parameters, ids, shape, samples_at, beside) = match results.list {
            true => (results.axes.clone(), Vec::new(), results.shape(), 0, Vec::new()),
            false => {
                let at = results.axes.iter().position(|axis| axis.scene_path == SAMPLES);
                let at = at.ok_or(StatsError::NoSamples)?;
                let mut beside = results.axes.clone();
                let samples = beside.remove(at);
                (samples.columns, samples.words, results.shape(), at, beside)
            }
        };
        if parameters.is_empty() {
            return Err(StatsError::NoSamples);
        }
        let rows = shape[samples_at];
        let design = match results.text("design") {
            Some(text) => {
                serde_json::from_str(text).map_err(|e| StatsError::Design { why: e.to_string() })?
            }
            None => listed(&parameters, rows),
        };
        fits(&design, &parameters, rows)?;
        let errors = results.variables.iter().find(|one| one.name == "error_estimate");
        let flags = |name: &str| {
            let found = results.flags.iter().find(|flags| flags.name == name && !results.list);
            found.map(|flags| flags.data.clone())
        };
        Ok(Self {
            title: results.title.clone(),
            design,
            parameters,
            ids,
            beside,
            outputs: outputs(results),
            status: results.status.clone(),
            errors: errors.map_or_else(|| vec![f64::NAN; results.status.len()], |one| one.data.clone()),
            jumps: flags("jump"),
            branches: flags("branch"),
            shape,
            samples_at,
        })
    }

    /// Rows of the design.
    pub fn rows(&self) -> usize {
        self.shape[self.samples_at]
    }

    /// Points of the sweep and the curve beside the samples, at least one.
    pub fn points(&self) -> usize {
        self.status.len() / self.rows().max(1)
    }

    /// The instance of a row at a point.
    pub fn instance(&self, point: usize, row: usize) -> usize {
        let inner: usize = self.shape[self.samples_at + 1..].iter().product();
        (point / inner) * inner * self.rows() + row * inner + point % inner
    }

    /// Where a point stands along each axis beside the samples.
    pub fn place(&self, point: usize) -> Vec<usize> {
        let mut rest = point;
        let mut place = vec![0; self.beside.len()];
        for (at, axis) in place.iter_mut().zip(&self.beside).rev() {
            *at = rest % axis.values.len();
            rest /= axis.values.len();
        }
        place
    }

    /// The point at such a place.
    pub fn point(&self, place: &[usize]) -> usize {
        place.iter().zip(&self.beside).fold(0, |point, (at, axis)| point * axis.values.len() + at)
    }

    /// Which axis beside the samples is a curve's, along which the state was carried.
    pub fn curve(&self) -> Option<usize> {
        self.jumps.as_ref().and_then(|_| self.beside.len().checked_sub(1))
    }

    /// Which axis beside the samples is that of the ways along a curve.
    pub fn ways(&self) -> Option<usize> {
        self.beside.iter().position(|axis| axis.name == "direction")
    }

    /// What stands in each row at a point.
    pub fn at<T: Copy>(&self, values: &[T], point: usize) -> Vec<T> {
        (0..self.rows()).map(|row| values[self.instance(point, row)]).collect()
    }

    /// An output by its name.
    ///
    /// # Errors
    /// There is none of that name.
    pub fn output(&self, name: &str) -> Result<&StudyOutput, StatsError> {
        Ok(&self.outputs[self.output_number(name)?])
    }

    /// Likewise its number.
    ///
    /// # Errors
    /// As [`Study::output`].
    pub fn output_number(&self, name: &str) -> Result<usize, StatsError> {
        self.outputs.iter().position(|one| one.name == name).ok_or_else(|| StatsError::Output {
            name: name.to_owned(),
            known: self.outputs.iter().map(|one| one.name.as_str()).collect::<Vec<_>>().join(", "),
        })
    }

    /// Whether parameters hang together: by the design, or where it is a table by more than chance.
    pub fn correlated(&self) -> bool {
        let chance = (BY_CHANCE / (self.rows() as f64).sqrt()).max(LEAST_CORRELATION);
        let pairs = || {
            let all = &self.parameters;
            all.iter().enumerate().flat_map(move |(n, a)| all[n + 1..].iter().map(move |b| (a, b)))
        };
        let told = !self.design.correlation.is_empty();
        told || (self.design.kind == DesignKind::Table
            && pairs().any(|(a, b)| correlation(&a.values, &b.values).abs() > chance))
    }

    /// Numbers of the parameters in each group.
    pub fn groups(&self) -> Vec<Vec<usize>> {
        let number = |name: &String| self.parameters.iter().position(|one| one.name == *name);
        self.design.groups.iter().map(|group| group.iter().filter_map(number).collect()).collect()
    }
}

/// Of two columns, linear; on the scale of each, as squares of SI sizes may leave the range of numbers.
fn correlation(a: &[f64], b: &[f64]) -> f64 {
    let centred = |values: &[f64]| {
        let middle = mean(values);
        let largest = values.iter().map(|value| (value - middle).abs()).fold(f64::MIN_POSITIVE, f64::max);
        values.iter().map(|value| (value - middle) / largest).collect::<Vec<f64>>()
    };
    let (a, b) = (centred(a), centred(b));
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    product(&a, &b) / (product(&a, &a) * product(&b, &b)).sqrt()
}

/// Samples without a design: as a table.
fn listed(parameters: &[Coordinate], rows: usize) -> DesignDescription {
    let own = |one: &Coordinate| Parameter {
        path: one.scene_path.clone(),
        name: one.name.clone(),
        units: one.units.clone(),
        distribution: None,
    };
    let ends = |one: &Coordinate| {
        let of = |fold: fn(f64, f64) -> f64, start: f64| one.values.iter().copied().fold(start, fold);
        (of(f64::min, f64::INFINITY), of(f64::max, f64::NEG_INFINITY))
    };
    let ends: Vec<(f64, f64)> = parameters.iter().map(ends).collect();
    DesignDescription::new(&Design::table(rows, 0, parameters.iter().map(own).collect()), &ends)
}

/// Refuses a design that is not the file's: one that was edited, or of another version.
fn fits(design: &DesignDescription, parameters: &[Coordinate], rows: usize) -> Result<(), StatsError> {
    let misfit = |why: String| Err(StatsError::Design { why });
    let per = design.kind.rows_per_sample(design.groups.len(), design.second_order);
    if design.rows != rows || design.samples.checked_mul(per) != Some(rows) || rows == 0 {
        return misfit(format!("{} samples of {per} rows, and {rows} rows in the file", design.samples));
    }
    if design.replicates == 0 || !design.samples.is_multiple_of(design.replicates) {
        return misfit(format!("{} samples in {} replicates", design.samples, design.replicates));
    }
    let known = |name: &String| parameters.iter().any(|one| one.name == *name && one.values.len() == rows);
    match design.groups.iter().flatten().find(|name| !known(name)) {
        Some(name) => misfit(format!("the file has no variable {name} over the samples")),
        None if design.kind == DesignKind::Morris && design.levels < 2 => misfit("no levels".into()),
        None => Ok(()),
    }
}

/// Observables of a file; each harmonic by itself.
pub fn outputs(results: &Results) -> Vec<StudyOutput> {
    results.variables.iter().flat_map(of_variable).collect()
}

fn of_variable(variable: &Variable) -> Vec<StudyOutput> {
    if Observable::from_name(&variable.name).is_none() {
        return Vec::new();
    }
    let width = variable.harmonics.unwrap_or(1);
    let one = |n: usize| StudyOutput {
        name: match variable.harmonics {
            Some(_) => format!("{}_{}", variable.name, n + 1),
            None => variable.name.clone(),
        },
        long_name: match variable.harmonics {
            Some(_) => format!("{}, harmonic {}", variable.long_name, n + 1),
            None => variable.long_name.clone(),
        },
        units: variable.units.clone(),
        error_scale: variable.error_scale.clone(),
        values: variable.data.iter().skip(n).step_by(width).copied().collect(),
    };
    (0..width).map(one).collect()
}

/// A status as the file calls it.
pub fn status_word(code: u8) -> &'static str {
    Status::from_code(code).map_or("unknown", Status::meaning)
}

//! The page of an inference: what was found, the prediction over what was measured, all quantities before and after.

use super::super::axis::Axis;
use super::super::labels::{capital, label, short};
use super::super::{ReportError, shown};
use super::{DECADE, INFER, Page, comparison, corner};
use crate::stats::{NORMAL_95, Observed, Posterior, Study, quantile};
use crate::store::Coordinate;
use afmsweep_data::design::Distribution;
use std::path::{Path, PathBuf};

/// Quantities of a corner.
const MOST_IN_CORNER: usize = 7;
/// What is left out of its panels at either end.
const BEYOND: f64 = 1e-3;
/// Values of a prior that is known by its distribution alone.
const OF_PRIOR: usize = 4000;
/// A median and both ends of what lies 95 % around it.
const SHARES: [f64; 3] = [0.5, 0.025, 0.975];

/// What was inferred at a point.
#[derive(Clone, Copy, Debug)]
pub struct Inference<'a> {
    pub study: &'a Study,
    pub posterior: &'a Posterior,
    /// What was not known of the measurement, by row, each with what was known of it before.
    pub free: &'a [(Coordinate, Distribution)],
    pub observed: Observation<'a>,
}

/// What was observed.
#[derive(Clone, Copy, Debug)]
pub enum Observation<'a> {
    Values(&'a [Observed]),
    Curve(&'a Comparison),
}

/// A measured curve beside what the weighted samples say.
#[derive(Clone, Debug)]
pub struct Comparison {
    pub file: String,
    /// What its places are, in words and as a name, and their SI unit.
    pub along: String,
    pub name: String,
    pub units: String,
    /// Rows and values that count, and rows that do not.
    pub rows: usize,
    pub values: usize,
    pub left_out: usize,
    pub observables: Vec<String>,
    pub panels: Vec<Compared>,
}

/// An observable, by its number in the study, measured or not.
#[derive(Clone, Debug)]
pub struct Compared {
    pub output: usize,
    pub ways: Vec<Way>,
}

/// One way along a curve.
#[derive(Clone, Debug)]
pub struct Way {
    /// Empty where there is but one.
    pub name: String,
    /// Place, value and standard deviation of what was measured.
    pub points: Vec<(f64, f64, f64)>,
    /// Places, and 2.5 %, median and 97.5 % of what is predicted there, as it would be measured.
    pub band: Vec<(f64, [f64; 3])>,
}

/// A quantity before and after.
pub(super) struct Known<'a> {
    pub units: &'a str,
    /// By row of the posterior.
    pub values: Vec<f64>,
    pub prior: Vec<f64>,
    pub axis: Axis,
    /// Median and 95 % before, and after.
    before: [f64; 3],
    after: [f64; 3],
    long: &'a str,
}

impl<'a> Known<'a> {
    fn of(one: &'a Coordinate, prior: Option<&Distribution>, posterior: &Posterior) -> Self {
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
        let axis = Axis::over([low, high].into_iter(), &one.units, &brief, log, 0.0);
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
    fn left(&self) -> f64 {
        (self.after[2] - self.after[1]) / (self.before[2] - self.before[1])
    }

    fn sentence(&self) -> String {
        let at = |n: usize| shown(self.after[n], self.units, 3);
        format!("{} {} (95\u{a0}% from {} to {})", self.long, at(0), at(1), at(2))
    }

    fn row(&self) -> Vec<String> {
        let cells = [self.before, self.after].concat();
        let cells = cells.iter().map(|value| shown(*value, self.units, 4));
        std::iter::once(self.long.to_owned()).chain(cells).collect()
    }
}

/// Writes the page of what was inferred at a point; gives its path.
///
/// # Errors
/// As [`super::statistics`].
pub fn inference(inference: &Inference, folder: &Path) -> Result<PathBuf, ReportError> {
    let (study, posterior) = (inference.study, inference.posterior);
    let mut page = Page::new(format!("{}: inference", study.title));
    let parameters = study.parameters.iter().map(|one| Known::of(one, None, posterior));
    let free = inference.free.iter().map(|(one, prior)| Known::of(one, Some(prior), posterior));
    let mut known: Vec<Known> = parameters.chain(free).collect();
    let (parameters, free) = known.split_at(study.parameters.len());
    let mut narrowed: Vec<&Known> = parameters.iter().collect();
    narrowed.sort_by(|a, b| a.left().total_cmp(&b.left()));
    let sentences: Vec<String> = narrowed.into_iter().chain(free).map(Known::sentence).collect();
    page.document.paragraph("Found:", format!("{}.", sentences.join("; ")));
    page.document.paragraph("", from(inference));
    if let Observation::Curve(curve) = inference.observed {
        page.document.heading("What was measured, and what is predicted");
        for panel in &curve.panels {
            let output = &study.outputs[panel.output];
            let title = format!("{} over {}", capital(&super::called(output)), curve.along);
            let svg = comparison::draw(&title, output, (&curve.along, &curve.units), &panel.ways)?;
            page.figure(&format!("{}_predicted", output.name), &title, svg);
        }
    }
    page.document.heading("Before and after");
    page.document.table("", table(inference, &known));
    // Where not all have room what is told of the measurement has some.
    let spare = known.len().saturating_sub(MOST_IN_CORNER);
    if spare > 0 {
        let kept = study.parameters.len().saturating_sub(spare);
        known.drain(kept..study.parameters.len());
    }
    let title = "What the quantities are after the observations, and before (grey)";
    page.figure("corner", title, corner::draw(title, &known, posterior)?);
    page.save(folder, INFER)
}

/// What it was inferred from, and by how much.
fn from(inference: &Inference) -> String {
    let posterior = inference.posterior;
    let failed = match posterior.left_out {
        0 => String::new(),
        count => format!(" {count} rows that failed are not among them."),
    };
    let weight =
        format!("{} rows count as {:.0} of equal weight.{failed}", posterior.rows.len(), posterior.effective);
    match inference.observed {
        Observation::Values(_) => weight,
        Observation::Curve(curve) => format!(
            "From {} values of {} at {} places of {}{}. {weight} The best row misses by {:.2} standard deviations at each value.",
            curve.values,
            curve.observables.join(", ").replace('_', " "),
            curve.rows,
            curve.file,
            match curve.left_out {
                0 => String::new(),
                count => format!(", of which {count} more were left out"),
            },
            (posterior.best_chi_squared.max(0.0) / curve.values as f64).sqrt()
        ),
    }
}

/// What was observed, then each quantity before and after.
fn table(inference: &Inference, known: &[Known]) -> Vec<Vec<String>> {
    let head = ["", "before", "95 % from", "to", "after", "95 % from", "to"];
    let mut rows = vec![head.map(str::to_owned).to_vec()];
    let study = inference.study;
    if let Observation::Values(observed) = inference.observed {
        for one in observed {
            let Ok(output) = study.output(&one.name) else { continue };
            let half = NORMAL_95 * one.sd;
            let cells =
                [one.value, one.value - half, one.value + half].map(|value| shown(value, &output.units, 4));
            let blank = || std::iter::repeat_n(String::new(), 3);
            rows.push(
                std::iter::once(format!("observed: {}", output.long_name))
                    .chain(blank())
                    .chain(cells)
                    .collect(),
            );
        }
    }
    rows.extend(known.iter().map(Known::row));
    rows
}

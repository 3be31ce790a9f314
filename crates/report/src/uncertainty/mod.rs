//! Pages of uncertainty studies: distributions, indices, scatter, bands, corners.

mod comparison;
mod corner;
pub(super) mod density;
mod histogram;
mod inference_page;
mod prior_posterior;
mod shares;

use super::band::{self, Bands};
use super::labels::{brief, capital, caption, ends, short};
use super::{Document, ReportError, save, shown};
use crate::stats::{Estimate, SHARES, SensitivityIndices, Study, StudyOutput, Summary};
use crate::store::Coordinate;
pub use comparison::{Compared, Comparison, PredictionPath};
use density::Side;
pub use inference_page::{Inference, Observation, inference};
use shares::IndexRow;
use std::path::{Path, PathBuf};

/// Found in the pages of `stats` and of `infer`: such a folder may be written again.
const STATS: &str = "afmsweep stats";
const INFER: &str = "afmsweep infer";
/// Points of a sweep that have pictures of their own, and parameters that have scatter pictures.
const MOST_POINTS: usize = 6;
const MOST_PARAMETERS: usize = 12;
/// A parameter whose largest value is so many times its least has a logarithmic axis.
const DECADE: f64 = 8.0;

/// What is told of every observable at every point, in the order of the points; none where it could not be told.
pub type StudySummaries<'a> = [Vec<(&'a StudyOutput, Option<Summary>)>];

/// A page while it is filled.
struct Page {
    document: Document,
    files: Vec<(String, String)>,
}

impl Page {
    fn new(title: String) -> Self {
        Self { document: Document { title, ..Document::default() }, files: Vec::new() }
    }

    fn figure(&mut self, name: &str, caption: &str, svg: String) {
        let file = format!("{name}.svg");
        self.document.picture(&file, caption, &svg);
        self.files.push((file, svg));
    }

    fn save(self, folder: &Path, generator: &str) -> Result<PathBuf, ReportError> {
        let mut files = vec![
            ("index.html".to_owned(), self.document.html(generator)),
            ("report.md".to_owned(), self.document.markdown()),
        ];
        files.extend(self.files);
        save(folder, generator, &files)?;
        Ok(folder.join("index.html"))
    }
}

/// Writes the page of a study's statistics; gives its path.
///
/// # Errors
/// A folder that holds other things, what the disk says, and a picture that cannot be drawn.
pub fn statistics(study: &Study, told: &StudySummaries, folder: &Path) -> Result<PathBuf, ReportError> {
    let mut page = Page::new(format!("{}: statistics", study.title));
    let design = &study.design;
    page.document.paragraph(
        "",
        format!(
            "{} base samples of kind {}, {} rows{}. Intervals are of 95 %.",
            design.samples,
            design.kind.word(),
            design.rows,
            if design.replicates > 1 { format!(", {} replicates", design.replicates) } else { String::new() }
        ),
    );
    bands(&mut page, study, told);
    let every = told.len().div_ceil(MOST_POINTS).max(1);
    for (point, observables) in told.iter().enumerate().step_by(every) {
        let at = place(study, point);
        // Beside bands single points are folded: the page would be many screens long.
        let whole = over(study).map(|_| std::mem::take(&mut page.document));
        if whole.is_none() && !at.is_empty() {
            page.document.heading(&at);
        }
        for (output, summary) in observables {
            page.document.heading(&capital(&output.long_name));
            match summary {
                Some(summary) => observable(&mut page, study, (point, output), summary),
                None => page.document.paragraph(&output.name, "too many rows failed: nothing is told"),
            }
        }
        if let Some(whole) = whole {
            let inside = std::mem::replace(&mut page.document, whole);
            page.document.fold(&at, inside);
        }
    }
    if every > 1 {
        let left = told.len() - told.len().div_ceil(every);
        let left = format!("{left} points of the sweep have no pictures of their own.");
        page.document.paragraph("", left);
    }
    page.save(folder, STATS)
}

/// Where a point of the sweep stands.
fn place(study: &Study, point: usize) -> String {
    words(study, point).collect::<Vec<_>>().join(", ")
}

/// What each axis beside the samples stands at.
fn words(study: &Study, point: usize) -> impl Iterator<Item = String> + '_ {
    study.beside.iter().zip(study.place(point)).map(|(axis, at)| caption(axis, axis.values[at]))
}

fn observable(page: &mut Page, study: &Study, (point, output): (usize, &StudyOutput), summary: &Summary) {
    let stem = if study.points() == 1 { output.name.clone() } else { format!("{}_{point}", output.name) };
    let (status, all) = (study.at(&study.status, point), study.at(&output.values, point));
    let counts = |row: &usize| status[*row] == 0 && all[*row].is_finite();
    let (kept, failed): (Vec<usize>, Vec<usize>) = (0..all.len()).partition(|row| counts(row));
    let values: Vec<f64> = kept.iter().map(|row| all[*row]).collect();
    let left_out: Vec<String> =
        summary.left_out.iter().map(|(word, count)| format!("{count} {}", word.replace('_', " "))).collect();
    if let Some(spread) = &summary.spread {
        let chosen = [0.025, 0.5, 0.975];
        let quantiles: Vec<(f64, f64)> = SHARES
            .iter()
            .zip(&spread.quantiles)
            .filter(|(share, _)| chosen.contains(share))
            .map(|(share, one)| (*share, one.value))
            .collect();
        let label = called(output);
        let label = (label.as_str(), output.units.as_str());
        let svg =
            histogram::draw(&capital(&output.long_name), &values, label, &quantiles, &left_out.join(", "));
        let caption = format!(
            "{}: mean {}, standard deviation {}",
            capital(&output.long_name),
            with_interval(&spread.mean, &output.units),
            with_interval(&spread.sd, &output.units)
        );
        page.figure(&format!("{stem}_distribution"), &caption, svg);
    }
    page.document.table("", numbers(output, summary));
    decides(page, study, (&stem, output), summary);
    for parameter in study.parameters.iter().take(MOST_PARAMETERS) {
        let at = |rows: &[usize]| rows.iter().map(|row| parameter.values[*row]).collect::<Vec<f64>>();
        let (x, failed) = (at(&kept), at(&failed));
        let (across, up) = (short(parameter), called(output));
        let y = Side { values: &values, label: &up, units: &output.units, log: false };
        let heading = format!("{} over {}", capital(&up), across);
        let svg = density::draw(&heading, &side(parameter, &across, &x), &y, &failed);
        page.figure(&format!("{stem}_{}", parameter.name), &heading, svg);
    }
}

/// What is known of an observable as a table: estimates, the mean from half of the samples, the simulation's own error.
fn numbers(output: &StudyOutput, summary: &Summary) -> Vec<Vec<String>> {
    let mut rows = vec![["", "value", "± (95 %)"].map(str::to_owned).to_vec()];
    let mut say = |words: String, one: &Estimate| {
        rows.push(vec![words, shown(one.value, &output.units, 5), shown(one.half_width, &output.units, 2)]);
    };
    if let Some(spread) = &summary.spread {
        say("mean".into(), &spread.mean);
        if let Some(half) = summary.convergence.first().filter(|_| summary.convergence.len() > 1)
            && let Some(mean) = &half.mean
        {
            say(format!("mean of the first {} samples", half.samples), mean);
        }
        say("standard deviation".into(), &spread.sd);
        for (share, one) in SHARES.iter().zip(&spread.quantiles) {
            say(format!("{} % below", 100.0 * share), one);
        }
    }
    let (median, largest) = summary.simulation_error;
    if largest.is_finite() {
        let words = format!("error of the simulation, on the scale of accuracy ({})", output.error_scale);
        rows.push(vec![words, format!("median {median:.1e}"), format!("largest {largest:.1e}")]);
    }
    rows.push(vec!["rows that count".into(), summary.count.to_string(), String::new()]);
    for (word, count) in &summary.left_out {
        rows.push(vec![format!("left out: {}", word.replace('_', " ")), count.to_string(), String::new()]);
    }
    rows
}

/// The side of a parameter, of these of its values.
fn side<'a>(parameter: &'a Coordinate, label: &'a str, values: &'a [f64]) -> Side<'a> {
    let (least, most) = ends(values.iter().copied());
    Side { values, label, units: &parameter.units, log: least > 0.0 && most > DECADE * least }
}

/// What an observable is called where there is little room.
fn called(output: &StudyOutput) -> String {
    brief(&output.long_name, &output.name)
}

fn with_interval(one: &Estimate, units: &str) -> String {
    format!("{} ± {}", shown(one.value, units, 4), shown(one.half_width, units, 2))
}

/// The picture of indices or effects.
fn decides(page: &mut Page, study: &Study, (stem, output): (&str, &StudyOutput), summary: &Summary) {
    let names = study.design.group_names();
    let title = format!("What decides: {}", output.long_name);
    let row = |word, values| IndexRow { word, values };
    let shares = ("share of the variance", "1");
    let (rows, axis) = match &summary.indices {
        SensitivityIndices::Saltelli(all) => {
            (vec![row("first order S1", &all.first), row("total ST", &all.total)], shares)
        }
        SensitivityIndices::Morris(effects) => (
            vec![row("mean size of an effect", &effects.mu_star)],
            ("effect of a step over all levels", output.units.as_str()),
        ),
        SensitivityIndices::Bins(first) => (vec![row("first order S1, by bins", first)], shares),
    };
    let svg = shares::draw(&title, &names, &rows, axis);
    let lost = |row: &IndexRow| {
        let zero = names.iter().zip(row.values).filter(|(_, one)| one.holds_zero());
        let zero: Vec<&str> = zero.map(|(name, _)| name.as_str()).collect();
        (!zero.is_empty()).then(|| format!("{} ({})", zero.join(", "), row.word))
    };
    let lost: Vec<String> = rows.iter().filter_map(lost).collect();
    let caption = match lost.is_empty() {
        true => title,
        false => format!("{title}. Not told apart from zero: {}", lost.join("; ")),
    };
    let doubts: String = summary.doubts().map(|told| format!(". {}", capital(&told))).collect();
    let caption = caption + &doubts;
    page.figure(&format!("{stem}_indices"), &caption, svg);
}

/// The axis that bands are drawn over: the last one of the sweep.
fn over(study: &Study) -> Option<&Coordinate> {
    study.beside.last().filter(|axis| axis.values.len() > 1)
}

/// Quantiles of each observable over the last axis of the sweep.
fn bands(page: &mut Page, study: &Study, told: &StudySummaries) {
    let Some(axis) = over(study) else { return };
    let length = axis.values.len();
    for (number, (output, _)) in told.first().into_iter().flatten().enumerate() {
        for (first, row) in told.chunks(length).enumerate().take(MOST_POINTS) {
            let spread = |point: &Vec<(&StudyOutput, Option<Summary>)>| {
                let spread = point.get(number).and_then(|(_, told)| told.as_ref()?.spread.as_ref());
                // 5, 25, 50, 75 and 95 %.
                [1, 2, 3, 4, 5].map(|n| spread.map_or(f64::NAN, |spread| spread.quantiles[n].value))
            };
            let points = row.iter().map(spread).collect();
            let others = study.beside.len() - 1;
            let at: String =
                words(study, first * length).take(others).map(|word| format!(", {word}")).collect();
            let heading = format!("{} over {}{at}", capital(&called(output)), short(axis));
            let chart = Bands {
                title: &heading,
                x: axis,
                label: &called(output),
                units: &output.units,
                series: vec![band::BandSeries { name: String::new(), points }],
            };
            page.figure(&format!("{}_bands_{first}", output.name), &heading, chart.draw());
        }
    }
}

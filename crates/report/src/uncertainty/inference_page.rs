//! The page of an inference: what was found, the prediction over what was measured, all quantities before and after.

use super::super::labels::capital;
use super::super::{ReportError, shown};
use super::comparison::{self, Comparison};
use super::prior_posterior::PriorPosterior;
use super::{INFER, Page, corner};
use crate::stats::{NORMAL_95, Observed, Posterior, Study};
use crate::store::Coordinate;
use afmsweep_data::design::Distribution;
use std::path::{Path, PathBuf};

/// Quantities of a corner.
const MOST_IN_CORNER: usize = 7;

/// What was inferred at a point.
#[derive(Clone, Debug)]
pub struct Inference<'a> {
    pub study: &'a Study,
    pub posterior: &'a Posterior,
    /// What was not known of the measurement, by row, each with what was known of it before.
    pub free: &'a [(Coordinate, Distribution)],
    pub observed: Observation<'a>,
    /// What makes the answer doubtful, as a sentence.
    pub warning: Option<String>,
}

/// What was observed.
#[derive(Clone, Copy, Debug)]
pub enum Observation<'a> {
    Values(&'a [Observed]),
    Curve(&'a Comparison),
}

/// Writes the page of what was inferred at a point; gives its path.
///
/// # Errors
/// As [`super::statistics`].
pub fn inference(inference: &Inference, folder: &Path) -> Result<PathBuf, ReportError> {
    let (study, posterior) = (inference.study, inference.posterior);
    let mut page = Page::new(format!("{}: inference", study.title));
    let parameters = study.parameters.iter().map(|one| PriorPosterior::of(one, None, posterior));
    let free = inference.free.iter().map(|(one, prior)| PriorPosterior::of(one, Some(prior), posterior));
    let mut known: Vec<PriorPosterior> = parameters.chain(free).collect();
    let (parameters, free) = known.split_at(study.parameters.len());
    let mut narrowed: Vec<&PriorPosterior> = parameters.iter().collect();
    narrowed.sort_by(|a, b| a.left().total_cmp(&b.left()));
    let sentences: Vec<String> = narrowed.into_iter().chain(free).map(PriorPosterior::sentence).collect();
    if let Some(warning) = &inference.warning {
        page.document.paragraph("Not to be trusted:", warning.clone());
    }
    page.document.paragraph("Found:", format!("{}.", sentences.join("; ")));
    page.document.paragraph("", from(inference));
    if let Observation::Curve(curve) = inference.observed {
        page.document.heading("What was measured, and what is predicted");
        for panel in &curve.panels {
            let output = &study.outputs[panel.output];
            let title = format!("{} over {}", capital(&super::called(output)), curve.along);
            let svg = comparison::draw(&title, output, (&curve.along, &curve.units), &panel.ways);
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
    page.figure("corner", title, corner::draw(title, &known, posterior));
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
fn table(inference: &Inference, known: &[PriorPosterior]) -> Vec<Vec<String>> {
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
    rows.extend(known.iter().map(PriorPosterior::row));
    rows
}

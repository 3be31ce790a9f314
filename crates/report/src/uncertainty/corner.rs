//! What quantities are after observations: each by itself on the diagonal, with what was known before; each pair below it,
//! and their correlation above.

use super::super::axis::PlotAxis;
use super::super::canvas::{Anchor, GREY, INK, picture, text_width};
use super::super::frame::{Frame, left_margin, title};
use super::density;
use super::histogram::Bars;
use super::prior_posterior::PriorPosterior;
use crate::stats::Posterior;

/// Side of a panel, and what lies between two.
const PANEL: f64 = 165.0;
const GAP: f64 = 14.0;
/// Bars have room for so many times the samples that count.
const FINE: f64 = 4.0;

/// A corner of panels.
pub(super) fn draw(heading: &str, known: &[PriorPosterior], posterior: &Posterior) -> String {
    let left = known.iter().map(|one| left_margin(&one.axis, PANEL)).fold(0.0, f64::max);
    let size = known.len() as f64 * (PANEL + GAP);
    let top = 40.0;
    picture((left + size + 20.0, top + size + 52.0), |canvas| {
        title(canvas, heading, left, left + size);
        let place = |row: usize, column: usize| {
            (left + column as f64 * (PANEL + GAP), top + row as f64 * (PANEL + GAP))
        };
        for (row, up) in known.iter().enumerate() {
            for (column, across) in known.iter().enumerate().take(row + 1) {
                let own = row == column;
                let (left, top) = place(row, column);
                let (x, y) = (&across.axis, &up.axis);
                let frame = Frame { canvas, left, top, width: PANEL, height: PANEL, x, y };
                let lowest = row + 1 == known.len();
                match own {
                    true => alone(&frame, across, posterior),
                    false => {
                        pair(&frame, across, up, &posterior.weights);
                        let (x, y) = place(column, row);
                        let number = correlation(across, up, &posterior.weights);
                        let at = (x + PANEL / 2.0, y + PANEL / 2.0);
                        canvas.text(&number, at, 16.0, Anchor::Middle, INK);
                    }
                }
                frame.ticks(lowest, column == 0 && !own);
                if lowest {
                    below(&frame, x);
                }
            }
        }
    })
}

/// A quantity by itself: bars after, a line before. `frame` has its own axis upwards, and lends its place.
fn alone(frame: &Frame, known: &PriorPosterior, posterior: &Posterior) {
    let bars = |values: &[f64], weights: &[f64]| {
        Bars::over(known.axis.clone(), values, weights, FINE * posterior.effective)
    };
    let (after, before) = (bars(&known.values, &posterior.weights), bars(&known.prior, &[]));
    let most = after.shares.iter().chain(&before.shares).copied();
    let y = PlotAxis::over([0.0].into_iter().chain(most), "1", "", false, 0.02);
    let frame = Frame { y: &y, ..*frame };
    after.draw(&frame);
    let wide = frame.width / before.shares.len() as f64;
    let step = |(n, share): (usize, &f64)| {
        let up = frame.top + (1.0 - y.place(*share)) * frame.height;
        [(frame.left + n as f64 * wide, up), (frame.left + (n + 1) as f64 * wide, up)]
    };
    let line: Vec<(f64, f64)> = before.shares.iter().enumerate().flat_map(step).collect();
    frame.canvas.line(&line, GREY, 1.3)
}

/// A pair of quantities, where both are in their panels.
fn pair(frame: &Frame, across: &PriorPosterior, up: &PriorPosterior, weights: &[f64]) {
    let inside = |axis: &PlotAxis, value: f64| (0.0..=1.0).contains(&axis.place(value));
    let shown: Vec<usize> = (0..weights.len())
        .filter(|n| inside(frame.x, across.values[*n]) && inside(frame.y, up.values[*n]))
        .collect();
    let pick = |values: &[f64]| shown.iter().map(|n| values[*n]).collect::<Vec<f64>>();
    density::rows(frame, &pick(&across.values), &pick(&up.values), &pick(weights))
}

/// The correlation of two quantities after the observations, as a number of two digits.
fn correlation(a: &PriorPosterior, b: &PriorPosterior, weights: &[f64]) -> String {
    let mean = |values: &[f64]| values.iter().zip(weights).map(|(value, weight)| value * weight).sum::<f64>();
    let centred = |values: &[f64]| {
        let middle = mean(values);
        let largest = values.iter().map(|value| (value - middle).abs()).fold(f64::MIN_POSITIVE, f64::max);
        values.iter().map(|value| (value - middle) / largest).collect::<Vec<f64>>()
    };
    let (a, b) = (centred(&a.values), centred(&b.values));
    let product = |a: &[f64], b: &[f64]| mean(&a.iter().zip(b).map(|(a, b)| a * b).collect::<Vec<f64>>());
    let together = product(&a, &b) / (product(&a, &a) * product(&b, &b)).sqrt();
    if together.is_finite() { format!("{together:.2}").replace('-', "−") } else { String::new() }
}

/// The words below a panel, in letters small enough for it, or else what stands before their comma.
fn below(frame: &Frame, axis: &PlotAxis) {
    let brief = match (axis.label.split_once(", "), axis.unit.text.as_str()) {
        (Some((first, _)), "") => first.to_owned(),
        (Some((first, _)), unit) => format!("{first} ({unit})"),
        (None, _) => axis.label.clone(),
    };
    let fits = |text: &str, size: f64| text_width(text, size) <= frame.width + 8.0;
    let sizes = [12.0, 11.0, 10.0];
    let size = |text: &str| sizes.into_iter().find(|size| fits(text, *size));
    let (text, size) = match size(&axis.label) {
        Some(size) => (&axis.label, size),
        None => (&brief, size(&brief).unwrap_or(9.0)),
    };
    let at = (frame.left + frame.width / 2.0, frame.top + frame.height + 34.0);
    frame.canvas.text(text, at, size, Anchor::Middle, INK)
}

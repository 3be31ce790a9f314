//! Indices or effects of every quantity with their intervals.

use super::super::axis::PlotAxis;
use super::super::canvas::{Anchor, INK, LINES, picture, text_width};
use super::super::frame::{Frame, KEY_ROW, Legend, SMALL, key, title};
use crate::stats::Estimate;

/// What is drawn of each quantity: a word for the key, and a value for each.
pub(super) struct IndexRow<'a> {
    pub word: &'a str,
    pub values: &'a [Estimate],
}

/// Dots with intervals, one line for each quantity.
pub(super) fn draw(
    heading: &str,
    names: &[String],
    rows: &[IndexRow],
    (label, units): (&str, &str),
) -> String {
    let ends = rows.iter().flat_map(|row| row.values).flat_map(|one| {
        let half = if one.half_width.is_finite() { one.half_width } else { 0.0 };
        [one.value - half, one.value + half]
    });
    let ends: Vec<f64> = ends.chain([0.0]).collect();
    let x = PlotAxis::over(ends.iter().copied(), units, label, false, 0.04);
    let y = PlotAxis::over([0.0, 1.0].into_iter(), "1", "", false, 0.0);
    let (width, step) = (460.0, 16.0 + 12.0 * rows.len() as f64);
    let left = 16.0 + names.iter().map(|name| text_width(name, SMALL)).fold(0.0, f64::max);
    let height = step * names.len() as f64;
    let entries: Vec<(Legend, String)> = rows
        .iter()
        .enumerate()
        .map(|(n, row)| (Legend::Dot(LINES[n % LINES.len()]), row.word.to_owned()))
        .collect();
    let top = 36.0 + KEY_ROW;
    picture((left + width + 24.0, top + height + 52.0), |canvas| {
        title(canvas, heading, 8.0, left + width);
        key(canvas, (left, 42.0), left + width, &entries);
        let frame = Frame { canvas, left, top, width, height, x: &x, y: &y };
        for (place, _) in x.ticks(7).0 {
            let at = left + place * width;
            canvas.line(&[(at, top), (at, top + height)], super::super::canvas::PALE, 0.8);
        }
        let zero = left + x.place(0.0) * width;
        canvas.line(&[(zero, top), (zero, top + height)], INK, 0.8);
        for (n, name) in names.iter().enumerate() {
            let middle = top + (n as f64 + 0.5) * step;
            canvas.text(name, (left - 8.0, middle), SMALL, Anchor::Right, INK);
            for (r, row) in rows.iter().enumerate() {
                let Some(one) = row.values.get(n).filter(|one| one.value.is_finite()) else { continue };
                let at = middle + 12.0 * (r as f64 - 0.5 * (rows.len() as f64 - 1.0));
                let place = |value: f64| left + x.place(value) * width;
                let shade = LINES[r % LINES.len()];
                if one.half_width.is_finite() {
                    let ends = (place(one.value - one.half_width), place(one.value + one.half_width));
                    canvas.line(&[(ends.0, at), (ends.1, at)], shade, 1.6);
                    for end in [ends.0, ends.1] {
                        canvas.line(&[(end, at - 3.0), (end, at + 3.0)], shade, 1.6);
                    }
                }
                canvas.dot((place(one.value), at), 3.0, shade);
            }
        }
        frame.ticks(true, false);
        frame.x_label(left + width / 2.0)
    })
}

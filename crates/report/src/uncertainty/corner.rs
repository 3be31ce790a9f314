//! What parameters are after observations: each by itself on the diagonal, each pair below it.

use super::super::ReportError;
use super::super::axis::Axis;
use super::super::canvas::{Anchor, INK, picture, text_width};
use super::super::frame::{Frame, left_margin, title};
use super::density::{self, Side};
use super::histogram::Bars;

/// A corner of panels; `weights` has one for each row.
pub(super) fn draw(heading: &str, sides: &[Side], weights: &[f64]) -> Result<String, ReportError> {
    let (panel, gap) = (165.0, 14.0);
    let bars: Vec<Bars> =
        sides.iter().map(|one| Bars::of(one.values, weights, (one.label, one.units), one.log)).collect();
    let left = bars.iter().map(|one| left_margin(&one.axis, panel)).fold(0.0, f64::max);
    let count = sides.len() as f64;
    let size = count * (panel + gap);
    let top = 40.0;
    picture((left + size + 20.0, top + size + 52.0), |canvas| {
        title(canvas, heading, left, left + size)?;
        for (row, up) in bars.iter().enumerate() {
            for (column, across) in bars.iter().enumerate().take(row + 1) {
                let own = row == column;
                let shares =
                    Axis::over([0.0].into_iter().chain(across.shares.iter().copied()), "1", "", false, 0.02);
                let frame = Frame {
                    canvas,
                    left: left + column as f64 * (panel + gap),
                    top: top + row as f64 * (panel + gap),
                    width: panel,
                    height: panel,
                    x: &across.axis,
                    y: if own { &shares } else { &up.axis },
                };
                match own {
                    true => across.draw(&frame)?,
                    false => density::rows(&frame, sides[column].values, sides[row].values, weights)?,
                }
                let lowest = row + 1 == sides.len();
                frame.ticks(lowest, column == 0 && !own)?;
                if lowest {
                    below(&frame, &across.axis)?;
                }
            }
        }
        Ok(())
    })
}

/// The words below a panel, in letters small enough for it, or else what stands before their comma.
fn below(frame: &Frame, axis: &Axis) -> Result<(), ReportError> {
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

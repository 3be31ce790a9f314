//! One instance over time: travel, indentation and force in panels above each other.

use super::ReportError;
use super::axis::PlotAxis;
use super::canvas::{Anchor, INK, LINES, PALE, picture};
use super::frame::{Frame, KEY_ROW, Legend, SMALL, key, left_margin, title};
use crate::store::Waveforms;

/// One quantity over time.
struct Panel<'a> {
    label: &'a str,
    units: &'a str,
    /// Names and values.
    lines: Vec<(&'a str, &'a [f64])>,
}

/// The picture of row `row` of the waveforms. Contact is where the tip is inside the sample; where it `sticks`, as under JKR, which
/// has no force without contact, also where a force holds it outside.
pub(super) fn draw(
    waveforms: &Waveforms,
    row: usize,
    heading: &str,
    sticks: bool,
) -> Result<String, ReportError> {
    let nothing = Vec::new();
    let of = |rows: &'_ [Vec<f64>]| rows.get(row).cloned().unwrap_or_default();
    let time = waveforms.time.get(row).or(waveforms.time.first()).unwrap_or(&nothing);
    let (tip, top_of_rod) = (of(&waveforms.tip_travel), of(&waveforms.actuator_top));
    let (indentation, force) = (of(&waveforms.indentation), of(&waveforms.force));
    let touches = |(depth, force): (&f64, &f64)| *depth > 0.0 || (sticks && *force != 0.0);
    let in_contact: Vec<bool> = indentation.iter().zip(&force).map(touches).collect();
    let t_axis = PlotAxis::over(time.iter().copied(), "s", "time", false, 0.0);
    // A base at rest is no line.
    let moves = top_of_rod.iter().any(|value| value.is_finite() && *value != 0.0);
    let base: Option<(&str, &[f64])> = moves.then_some(("actuator's top, or the base", &top_of_rod));
    let travels = [("tip", tip.as_slice())].into_iter().chain(base).collect();
    let panels = [
        Panel { label: "travel", units: "m", lines: travels },
        Panel {
            label: "indentation",
            units: "m",
            lines: vec![("indentation, negative for a gap", &indentation)],
        },
        Panel { label: "force on the tip", units: "N", lines: vec![("force", &force)] },
    ];
    let axes: Vec<PlotAxis> = panels.iter().map(Panel::axis).collect();
    let (width, height, gap, first) = (640.0, 150.0, 16.0, 68.0);
    let left = axes.iter().map(|axis| left_margin(axis, height)).fold(0.0, f64::max);
    let total_width = left + width + 24.0;
    let bottom = first + 3.0 * (height + gap) - gap;
    picture((total_width, bottom + 52.0), |canvas| {
        title(canvas, heading, left, total_width)?;
        key(canvas, (left, first - KEY_ROW), left + width, &panels[0].entries())?;
        for (number, (panel, y_axis)) in panels.iter().zip(&axes).enumerate() {
            let top = first + number as f64 * (height + gap);
            let frame = Frame { canvas, left, top, width, height, x: &t_axis, y: y_axis };
            contact(&frame, time, &in_contact)?;
            panel.draw(&frame, time)?;
            frame.edges(number == 2, true)?;
        }
        Ok(())
    })
}

impl Panel<'_> {
    fn axis(&self) -> PlotAxis {
        let values = self.lines.iter().flat_map(|(_, values)| values.iter().copied());
        PlotAxis::over(values, self.units, self.label, false, 0.08)
    }

    /// What the key says of its lines, and of the shades behind all panels.
    fn entries(&self) -> Vec<(Legend, String)> {
        let lines = self.lines.iter().enumerate().map(|(number, (name, _))| match number {
            0 => (Legend::Line(LINES[0]), (*name).to_owned()),
            _ => (Legend::Dashes(LINES[number]), (*name).to_owned()),
        });
        lines.chain([(Legend::Swatch(PALE), "in contact".to_owned())]).collect()
    }

    /// Draws the grid, the line of zero and the panel's lines.
    fn draw(&self, frame: &Frame, time: &[f64]) -> Result<(), ReportError> {
        frame.grid()?;
        let (left, right) = (frame.left, frame.left + frame.width);
        let zero = frame.y.place(0.0);
        if (0.0..=1.0).contains(&zero) {
            let y = frame.top + (1.0 - zero) * frame.height;
            frame.canvas.line(&[(left, y), (right, y)], INK, 0.8)?;
        }
        for (number, (_, values)) in self.lines.iter().enumerate() {
            let mut piece = Vec::new();
            for at in time.iter().zip(*values).map(|(&t, &value)| frame.at(t, value)) {
                if at.0.is_finite() && at.1.is_finite() {
                    piece.push(at);
                } else {
                    stroke(frame, &mut piece, number)?;
                }
            }
            stroke(frame, &mut piece, number)?;
        }
        if self.lines.iter().all(|(_, values)| !values.iter().any(|value| value.is_finite())) {
            let middle = (left + frame.width / 2.0, frame.top + frame.height / 2.0);
            frame.canvas.text("no values", middle, SMALL, Anchor::Middle, INK)?;
        }
        Ok(())
    }
}

fn stroke(frame: &Frame, piece: &mut Vec<(f64, f64)>, number: usize) -> Result<(), ReportError> {
    match number {
        0 => frame.canvas.line(piece, LINES[0], 1.6)?,
        _ => frame.canvas.dashes(piece, LINES[number % LINES.len()], 1.6)?,
    }
    piece.clear();
    Ok(())
}

/// Shades the times in contact.
fn contact(frame: &Frame, time: &[f64], in_contact: &[bool]) -> Result<(), ReportError> {
    let mut start = None;
    for (&t, touches) in time.iter().zip(in_contact) {
        match (touches, start) {
            (true, None) => start = Some(t),
            (false, Some(from)) => {
                shade(frame, from, t)?;
                start = None;
            }
            _ => {}
        }
    }
    match (start, time.last()) {
        (Some(from), Some(&to)) => shade(frame, from, to),
        _ => Ok(()),
    }
}

fn shade(frame: &Frame, from: f64, to: f64) -> Result<(), ReportError> {
    let (a, b) = (frame.at(from, f64::NAN).0, frame.at(to, f64::NAN).0);
    if a.is_finite() && b.is_finite() {
        frame.canvas.rectangle((a, frame.top), (b, frame.top + frame.height), PALE)?;
    }
    Ok(())
}

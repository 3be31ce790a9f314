//! One instance over time: travel, indentation and force in panels above each other.

use super::axis::PlotAxis;
use super::canvas::{LINES, PALE};
use super::frame::{Frame, Legend, pieces};
use super::stack::Stack;
use crate::store::Waveforms;

const LAYOUT: Stack = Stack { width: 640.0, gap: 16.0, top: 48.0, key: Some(48.0), beyond: 24.0 };

/// One quantity over time.
struct Panel<'a> {
    label: &'a str,
    units: &'a str,
    /// Names and values.
    lines: Vec<(&'a str, &'a [f64])>,
}

/// The picture of row `row` of the waveforms. Contact is where the tip is inside the sample; where it `sticks`, as under JKR, which
/// has no force without contact, also where a force holds it outside.
pub(super) fn draw(waveforms: &Waveforms, row: usize, heading: &str, sticks: bool) -> String {
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
    let places: Vec<(&PlotAxis, f64)> = axes.iter().map(|axis| (axis, 150.0)).collect();
    LAYOUT.draw((heading, &panels[0].entries()), &t_axis, &places, |number, frame| {
        contact(frame, time, &in_contact);
        panels[number].draw(frame, time);
        frame.edges(number == 2, true)
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
    fn draw(&self, frame: &Frame, time: &[f64]) {
        frame.grid();
        frame.zeros(false);
        for (number, (_, values)) in self.lines.iter().enumerate() {
            let places: Vec<(f64, f64)> =
                time.iter().zip(*values).map(|(&t, &value)| frame.at(t, value)).collect();
            let pen = (LINES[number % LINES.len()], 1.6);
            pieces(&places).for_each(|piece| frame.canvas.stroke(piece, pen, number > 0));
        }
        if self.lines.iter().all(|(_, values)| !values.iter().any(|value| value.is_finite())) {
            frame.words("no values");
        }
    }
}

/// Shades the times in contact.
fn contact(frame: &Frame, time: &[f64], in_contact: &[bool]) {
    let mut start = None;
    for (&t, touches) in time.iter().zip(in_contact) {
        match (touches, start) {
            (true, None) => start = Some(t),
            (false, Some(from)) => {
                shade(frame, from, t);
                start = None;
            }
            _ => {}
        }
    }
    if let (Some(from), Some(&to)) = (start, time.last()) {
        shade(frame, from, to);
    }
}

fn shade(frame: &Frame, from: f64, to: f64) {
    let (a, b) = (frame.at(from, f64::NAN).0, frame.at(to, f64::NAN).0);
    if a.is_finite() && b.is_finite() {
        frame.canvas.rectangle((a, frame.top), (b, frame.top + frame.height), PALE);
    }
}

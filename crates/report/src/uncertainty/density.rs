//! Where two quantities lie together: each row as a dot where they are few, shares of them by colour where they are many.

use super::super::axis::PlotAxis;
use super::super::canvas::{GREY, LINES};
use super::super::frame::{Frame, Legend, colour, is_place};
use super::super::raster::{self, CLEAR, FINER, Pixel, solid};
use super::super::stack::Stack;

const LAYOUT: Stack = Stack { width: 420.0, gap: 0.0, top: 36.0, key: Some(42.0), beyond: 0.0 };
/// Rows that are drawn as dots.
const DOTS: usize = 1500;
/// Cells each way.
const CELLS: usize = 48;
/// Cells each way for weighted rows, of which fewer count.
const WEIGHTED: usize = 24;

/// Draws rows (x, y), with weights or without, into a frame.
pub(in super::super) fn rows(frame: &Frame, x: &[f64], y: &[f64], weights: &[f64]) {
    if weights.is_empty() && x.len() <= DOTS {
        let radius = if x.len() > 300 { 1.3 } else { 2.2 };
        for (x, y) in x.iter().zip(y) {
            let at = frame.at(*x, *y);
            if is_place(&at) {
                frame.canvas.dot(at, radius, LINES[0]);
            }
        }
        return;
    }
    let cells = if weights.is_empty() { CELLS } else { WEIGHTED };
    let mut shares = vec![0.0; cells * cells];
    for (n, (x, y)) in x.iter().zip(y).enumerate() {
        let (across, up) = (frame.x.place(*x), frame.y.place(*y));
        if is_place(&(across, up)) {
            let cell = |place: f64| ((place * cells as f64) as usize).min(cells - 1);
            shares[cell(up) * cells + cell(across)] += weights.get(n).copied().unwrap_or(1.0);
        }
    }
    let most = shares.iter().copied().fold(0.0, f64::max);
    // By the root: rare cells are seen too.
    let shade = |share: f64| if share > 1e-3 * most { solid(colour((share / most).sqrt())) } else { CLEAR };
    let (wide, high) = ((frame.width * FINER) as usize, (frame.height * FINER) as usize);
    let at =
        |row: usize, column: usize| shares[(high - 1 - row) * cells / high * cells + column * cells / wide];
    let pixels = (0..high).flat_map(|row| (0..wide).map(move |column| (row, column)));
    let colours: Vec<Pixel> = pixels.map(|(row, column)| shade(at(row, column))).collect();
    let end = (frame.left + frame.width, frame.top + frame.height);
    frame.canvas.image((frame.left, frame.top), end, &raster::image(wide, high, &colours));
}

/// An axis of a picture: its values by row, label, unit, and whether it is logarithmic.
pub(super) struct Side<'a> {
    pub values: &'a [f64],
    pub label: &'a str,
    pub units: &'a str,
    pub log: bool,
}

impl Side<'_> {
    pub fn axis(&self, margin: f64) -> PlotAxis {
        PlotAxis::over(self.values.iter().copied(), self.units, self.label, self.log, margin)
    }
}

/// A picture of an observable over a parameter; rows that failed are strokes at the lower edge, at their parameter.
pub(super) fn draw(heading: &str, x: &Side, y: &Side, failed: &[f64]) -> String {
    let (x_axis, y_axis) = (x.axis(0.0), y.axis(0.02));
    let entries: Vec<(Legend, String)> = match failed.len() {
        0 => Vec::new(),
        count => vec![(Legend::Tick(GREY), format!("{count} left out"))],
    };
    LAYOUT.draw((heading, &entries), &x_axis, &[(&y_axis, 300.0)], |_, frame| {
        frame.grid();
        rows(frame, x.values, y.values, &[]);
        let bottom = frame.top + frame.height;
        for value in failed.iter().take(DOTS) {
            let at = frame.at(*value, f64::NAN).0;
            if (frame.left..=frame.left + frame.width).contains(&at) {
                frame.canvas.line(&[(at, bottom - 8.0), (at, bottom)], GREY, 1.0);
            }
        }
        frame.edges(true, true)
    })
}

//! Values over two axes as coloured cells, alone or as panels over slices of further axes.

use super::ReportError;
use super::axis::{Axis, is_log_spaced, spans_decades};
use super::canvas::{Anchor, Canvas, INK, PALE, WHITE, picture};
use super::frame::{
    DOUBTFUL, Frame, KEY_ROW, Key, LABEL, NOTHING, SMALL, State, Tally, colour, key, key_rows, left_margin,
    mark, title, upward,
};
use crate::store::Coordinate;
use plotters::style::RGBColor;

/// The colour of a value that is nothing within its error.
const NONE: RGBColor = RGBColor(176, 176, 176);
/// Cells along an axis at most; finer grids are averaged.
const MOST_CELLS: usize = 128;

/// One field: a row of values for each value of the y axis.
pub struct Panel {
    pub caption: String,
    /// The x axis runs fastest.
    pub values: Vec<(f64, State)>,
    /// Lines over the cells, in SI units of the axes: the `i`-th goes by the `i`-th name of
    /// [`Heatmap::lines`]. What lies outside the axes is left out.
    pub lines: Vec<Vec<(f64, f64)>>,
}

/// Panels in rows of `columns`, on common axes and one colour scale.
pub struct Heatmap<'a> {
    pub title: String,
    /// SI unit of the values, as the results file writes it.
    pub units: &'a str,
    /// What the values are, for the colour bar.
    pub long_name: &'a str,
    pub x: &'a Coordinate,
    pub y: &'a Coordinate,
    pub columns: usize,
    pub panels: Vec<Panel>,
    /// Names of the lines over the cells: the first is drawn through, the others dashed.
    pub lines: Vec<String>,
}

/// The cells along one axis: where they end and which values they show.
struct Cells {
    axis: Axis,
    /// Ends on the axis' scale, one more than there are cells.
    edges: Vec<f64>,
    members: Vec<Vec<usize>>,
}

impl Cells {
    fn along(coordinate: &Coordinate) -> Self {
        let name = short(coordinate);
        let values = &coordinate.values;
        let mut order: Vec<usize> = (0..values.len()).collect();
        order.sort_by(|&a, &b| values[a].total_cmp(&values[b]));
        let usable = values.iter().all(|value| value.is_finite())
            && order.windows(2).all(|pair| values[pair[0]] < values[pair[1]]);
        // Values that occur twice or are not finite have no place of their own; their number has.
        let (axis, places) = if usable {
            let log = is_log_spaced(values);
            let axis = Axis::over(values.iter().copied(), &coordinate.units, &name, log, 0.0);
            let places: Vec<f64> = order.iter().map(|&i| axis.scaled(values[i])).collect();
            (axis, places)
        } else {
            order.sort_unstable();
            let places: Vec<f64> = (0..values.len()).map(|i| i as f64).collect();
            let label = format!("{name}, number of the value");
            (Axis::over(places.iter().copied(), "1", &label, false, 0.0), places)
        };
        let mut edges: Vec<f64> = places.windows(2).map(|pair| (pair[0] + pair[1]) / 2.0).collect();
        let (first, last) = match places.as_slice() {
            [] => (0.0, 1.0),
            [only] => (only - 0.5 * only.abs().max(1e-3), only + 0.5 * only.abs().max(1e-3)),
            [a, b] => (a - (b - a) / 2.0, b + (b - a) / 2.0),
            [a, b, .., y, z] => (a - (b - a) / 2.0, z + (z - y) / 2.0),
            [a, b, c] => (a - (b - a) / 2.0, c + (c - b) / 2.0),
        };
        edges.insert(0, first);
        edges.push(last);
        let block = values.len().div_ceil(MOST_CELLS).max(1);
        let members: Vec<Vec<usize>> = order.chunks(block).map(<[usize]>::to_vec).collect();
        let mut ends: Vec<f64> = (0..members.len()).map(|i| edges[i * block]).collect();
        ends.push(last);
        Self { axis: axis.between(first, last), edges: ends, members }
    }
}

/// What an axis is called beside it: its label, or its name in the file where that is too long.
pub(super) fn short(coordinate: &Coordinate) -> String {
    brief(label(coordinate), &coordinate.name)
}

/// A label that fits an axis, or else the words of this name.
pub(super) fn brief(label: &str, name: &str) -> String {
    const ROOM: usize = 28;
    if label.chars().count() <= ROOM {
        return label.to_owned();
    }
    let words = name.replace('_', " ");
    ["approach ", "drive "].iter().find_map(|part| words.strip_prefix(part)).unwrap_or(&words).to_owned()
}

/// What an axis is called.
pub(super) fn label(coordinate: &Coordinate) -> &str {
    if coordinate.long_name.is_empty() { &coordinate.name } else { &coordinate.long_name }
}

impl Heatmap<'_> {
    /// The picture as SVG.
    ///
    /// # Errors
    /// [`ReportError::Draw`].
    pub fn draw(&self) -> Result<String, ReportError> {
        let (across, up) = (Cells::along(self.x), Cells::along(self.y));
        let all = || self.panels.iter().flat_map(|panel| &panel.values);
        let shown = all().filter(|(_, state)| state.has_value()).map(|(value, _)| *value);
        let bar = Axis::over(shown.clone(), self.units, self.long_name, spans_decades(shown), 0.0);
        let columns = self.columns.clamp(1, self.panels.len().max(1));
        let rows = self.panels.len().div_ceil(columns);
        let single = self.panels.len() == 1;
        let (width, height) = match (single, columns) {
            (true, _) => (520.0, 400.0),
            (_, 1..=2) => (300.0, 240.0),
            _ => (230.0, 200.0),
        };
        let captions = if single { 0.0 } else { 20.0 };
        let (left, top, gap) = (left_margin(&up.axis, height), 40.0, 28.0);
        let field = (columns as f64 * (width + gap) - gap, rows as f64 * (height + captions + gap) - gap);
        let bar_left = left + field.0 + 22.0;
        let bar_labels = left_margin(&bar, field.1);
        let total_width = bar_left + 18.0 + bar_labels + 6.0;
        let entries = self.entries(all().map(|(_, state)| *state), across.members.len() * up.members.len());
        let key_top = top + field.1 + 64.0;
        let total = (total_width, key_top + key_rows(total_width - left, &entries) * KEY_ROW);
        picture(total, |canvas| {
            title(canvas, &self.title, left, total_width)?;
            for (number, panel) in self.panels.iter().enumerate() {
                let (row, column) = (number / columns, number % columns);
                let frame = Frame {
                    canvas,
                    left: left + column as f64 * (width + gap),
                    top: top + row as f64 * (height + captions + gap) + captions,
                    width,
                    height,
                    x: &across.axis,
                    y: &up.axis,
                };
                let caption_at = (frame.left + width / 2.0, frame.top - 10.0);
                canvas.text(&panel.caption, caption_at, SMALL, Anchor::Middle, INK)?;
                self.cells(&frame, panel, &across, &up, &bar)?;
                overlay(&frame, &panel.lines)?;
                let lowest = number + columns >= self.panels.len();
                frame.ticks(lowest, column == 0)?;
                // One label for all columns, below the lowest row.
                if number + 1 == self.panels.len() {
                    frame.x_label(left + field.0 / 2.0)?;
                }
            }
            colour_bar(canvas, &bar, (bar_left, top + captions), field.1 - captions)?;
            key(canvas, (left, key_top), total_width, &entries)
        })
    }

    fn cells(
        &self,
        frame: &Frame,
        panel: &Panel,
        across: &Cells,
        up: &Cells,
        bar: &Axis,
    ) -> Result<(), ReportError> {
        let canvas = frame.canvas;
        let x_at = |edge: f64| frame.left + frame.x.place_scaled(edge) * frame.width;
        let y_at = |edge: f64| frame.top + (1.0 - frame.y.place_scaled(edge)) * frame.height;
        let marks = across.members.len() * up.members.len() <= 2500;
        let mut doubtful = Vec::new();
        for (row, ys) in up.members.iter().enumerate() {
            let mut run = None;
            let (bottom, top) = (y_at(up.edges[row]), y_at(up.edges[row + 1]));
            for (column, xs) in across.members.iter().enumerate() {
                let (left, right) = (x_at(across.edges[column]), x_at(across.edges[column + 1]));
                let members = ys.iter().flat_map(|&y| xs.iter().map(move |&x| (x, y)));
                let cell = members.filter_map(|(x, y)| panel.values.get(y * self.x.values.len() + x));
                let (value, state) = merge(cell);
                // Over a pixel of the neighbours drawn next, or the background shows through the seams.
                let end = (frame.left + frame.width, frame.top);
                let (a, b) = ((left, bottom), ((right + 1.0).min(end.0), (top - 1.0).max(end.1)));
                let shade = match state {
                    State::Failed => None,
                    State::Empty => Some(PALE),
                    State::Zero => Some(NONE),
                    State::Good | State::Doubtful => Some(colour(bar.place(value))),
                };
                // Neighbours of one colour are one rectangle.
                match (shade, &mut run) {
                    (Some(shade), Some((_, end, same))) if shade == *same => *end = b,
                    _ => {
                        fill(canvas, run.take())?;
                        match shade {
                            Some(shade) => run = Some((a, b, shade)),
                            None => canvas.hatched(a, b)?,
                        }
                    }
                }
                if state == State::Doubtful && marks {
                    doubtful.push(((left + right) / 2.0, (bottom + top) / 2.0));
                }
            }
            fill(canvas, run)?;
        }
        doubtful.into_iter().try_for_each(|at| mark(canvas, at))
    }

    fn entries(&self, states: impl Iterator<Item = State>, cells: usize) -> Vec<(Key, String)> {
        let tally = Tally::of(states);
        let mut entries: Vec<(Key, String)> = Vec::new();
        for (number, name) in self.lines.iter().enumerate() {
            let sample = if number == 0 { Key::Line(INK) } else { Key::Dashes(INK) };
            entries.push((sample, name.clone()));
        }
        if tally.zero > 0 {
            entries.push((Key::Swatch(NONE), format!("{NOTHING} ({})", tally.zero)));
        }
        if tally.empty > 0 {
            entries.push((Key::Swatch(PALE), format!("no value, nothing failed ({})", tally.empty)));
        }
        if tally.failed > 0 {
            entries.push((Key::Hatched, format!("failed ({})", tally.failed)));
        }
        if tally.doubtful > 0 {
            let unmarked = if cells > 2500 { ", not marked" } else { "" };
            let text = format!("{DOUBTFUL} ({}{unmarked})", tally.doubtful);
            entries.push((Key::Marked(colour(0.4)), text));
        }
        if self.x.values.len().max(self.y.values.len()) > MOST_CELLS {
            let text = "each cell is the mean of its neighbouring instances that have a value".to_owned();
            entries.push((Key::Swatch(colour(0.6)), text));
        }
        entries
    }
}

/// Corners and colour of cells to be drawn as one.
type Run = ((f64, f64), (f64, f64), RGBColor);

fn fill(canvas: &Canvas, run: Option<Run>) -> Result<(), ReportError> {
    run.map_or(Ok(()), |(a, b, shade)| canvas.rectangle(a, b, shade))
}

/// Lines over the cells: dark on a light border, to be seen on any colour.
fn overlay(frame: &Frame, lines: &[Vec<(f64, f64)>]) -> Result<(), ReportError> {
    let inside = |(x, y): (f64, f64)| {
        let (right, bottom) = (frame.left + frame.width, frame.top + frame.height);
        (frame.left..=right).contains(&x) && (frame.top..=bottom).contains(&y)
    };
    for (number, line) in lines.iter().enumerate() {
        let places: Vec<(f64, f64)> = line.iter().map(|&(x, y)| frame.at(x, y)).collect();
        for piece in places.split(|&at| !inside(at)) {
            frame.canvas.line(piece, WHITE, 3.6)?;
            match number {
                0 => frame.canvas.line(piece, INK, 1.6)?,
                _ => frame.canvas.dashes(piece, INK, 1.6)?,
            }
        }
    }
    Ok(())
}

/// The mean of a cell's values, and what most of its instances are.
fn merge<'a>(cell: impl Iterator<Item = &'a (f64, State)>) -> (f64, State) {
    let (mut sum, mut good, mut doubtful, mut zero, mut empty, mut failed) = (0.0, 0, 0, 0, 0, 0);
    for (value, state) in cell {
        match state {
            State::Good => good += 1,
            State::Doubtful => doubtful += 1,
            State::Zero => zero += 1,
            State::Empty => empty += 1,
            State::Failed => failed += 1,
        }
        if state.has_value() {
            sum += value;
        }
    }
    let valued = good + doubtful;
    let state = if zero > valued && zero >= empty + failed {
        State::Zero
    } else if valued == 0 || valued < empty + failed {
        if failed >= empty { State::Failed } else { State::Empty }
    } else if doubtful > good {
        State::Doubtful
    } else {
        State::Good
    };
    (sum / f64::from(valued.max(1)), state)
}

fn colour_bar(canvas: &Canvas, bar: &Axis, (left, top): (f64, f64), height: f64) -> Result<(), ReportError> {
    const STEPS: usize = 100;
    let (width, bottom) = (18.0, top + height);
    for step in 0..STEPS {
        let from = bottom - height * step as f64 / STEPS as f64;
        let to = bottom - height * (step + 1) as f64 / STEPS as f64;
        let shade = colour((step as f64 + 0.5) / STEPS as f64);
        canvas.rectangle((left, from), (left + width, (to - 1.0).max(top)), shade)?;
    }
    canvas.outline((left, top), (left + width, bottom), INK, 1.0)?;
    let (ticks, small) = bar.ticks((height / 45.0) as usize + 1);
    for (place, text) in &ticks {
        let y = bottom - place * height;
        canvas.line(&[(left + width, y), (left + width + 5.0, y)], INK, 1.0)?;
        canvas.text(text, (left + width + 8.0, y), SMALL, Anchor::Left, INK)?;
    }
    for place in small {
        let y = bottom - place * height;
        canvas.line(&[(left + width, y), (left + width + 3.0, y)], INK, 0.8)?;
    }
    let x = left + width + left_margin(bar, height) - LABEL * 0.6;
    upward(canvas, bar, (x, top + height / 2.0), height)
}

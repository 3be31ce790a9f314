//! Values over one axis as curves, and values of a list as clouds of points.

use super::ReportError;
use super::axis::{Axis, is_log_spaced, spans_decades};
use super::canvas::{GREY, LINES, picture};
use super::frame::{DOUBTFUL, Frame, KEY_ROW, Key, NOTHING, State, Tally, key, key_rows, left_margin, title};
use super::heatmap::short;
use crate::store::Coordinate;
use plotters::style::RGBColor;

/// Points of a cloud at most; more would only make ink.
const MOST_POINTS: usize = 3000;
/// Markers on a curve are drawn up to this many points.
const MOST_MARKERS: usize = 80;

/// One curve or cloud: a value and its state for each instance.
pub(super) struct Series {
    pub name: String,
    pub values: Vec<(f64, State)>,
}

/// Curves over `x`, joined where neighbours have values.
pub(super) fn curves(
    heading: &str,
    units: &str,
    long_name: &str,
    x: &Coordinate,
    series: &[Series],
) -> Result<String, ReportError> {
    let x_axis = Axis::over(x.values.iter().copied(), &x.units, &short(x), is_log_spaced(&x.values), 0.03);
    let y_axis = values_axis(series, units, long_name);
    let mut order: Vec<usize> = (0..x.values.len()).filter(|&i| x.values[i].is_finite()).collect();
    order.sort_by(|&a, &b| x.values[a].total_cmp(&x.values[b]));
    let entries: Vec<(Key, String)> = line_entries(series).into_iter().chain(state_entries(series)).collect();
    let (width, height, top) = (560.0, 360.0, 40.0);
    let left = left_margin(&y_axis, height);
    let total_width = left + width + 28.0;
    let key_top = top + height + 64.0;
    let total = (total_width, key_top + key_rows(width, &entries) * KEY_ROW);
    picture(total, |canvas| {
        title(canvas, heading, left, total_width)?;
        let frame = Frame { canvas, left, top, width, height, x: &x_axis, y: &y_axis };
        frame.grid()?;
        for (number, one) in series.iter().enumerate() {
            let points: Vec<Point> = order.iter().map(|&i| Point::of(x.values[i], one.values[i])).collect();
            draw_line(&frame, &points, number)?;
            draw_markers(&frame, &points, LINES[number % LINES.len()])?;
        }
        frame.edges(true, true)?;
        key(canvas, (left, key_top), left + width, &entries)
    })
}

/// One value of a curve.
struct Point {
    x: f64,
    value: f64,
    state: State,
}

impl Point {
    fn of(x: f64, value: (f64, State)) -> Self {
        let (value, state) = drawn(value);
        Self { x, value, state }
    }

    /// Its place on the picture, if it has one.
    fn place(&self, frame: &Frame) -> Option<(f64, f64)> {
        let at = frame.at(self.x, self.value);
        let shown = self.state.has_value() || self.state == State::Zero;
        (shown && at.0.is_finite() && at.1.is_finite()).then_some(at)
    }
}

/// Joins the points that are neighbours; under the first curve, signs stand for those without a place.
fn draw_line(frame: &Frame, points: &[Point], number: usize) -> Result<(), ReportError> {
    let mut piece: Vec<(f64, f64)> = Vec::new();
    for point in points {
        if let Some(at) = point.place(frame) {
            piece.push(at);
            continue;
        }
        draw_piece(frame, &mut piece, number)?;
        let x = frame.at(point.x, f64::NAN).0;
        if x.is_finite() && number == 0 {
            absent(frame, x, point.state)?;
        }
    }
    draw_piece(frame, &mut piece, number)
}

fn draw_markers(frame: &Frame, points: &[Point], shade: RGBColor) -> Result<(), ReportError> {
    for point in points {
        let Some(at) = point.place(frame) else { continue };
        match point.state {
            State::Doubtful => frame.canvas.ring(at, 3.5, shade)?,
            State::Zero => frame.canvas.dot(at, 2.6, GREY)?,
            _ if points.len() <= MOST_MARKERS => frame.canvas.dot(at, 2.6, shade)?,
            _ => {}
        }
    }
    Ok(())
}

/// Where a value stands: one that is nothing, at 0.
fn drawn((value, state): (f64, State)) -> (f64, State) {
    (if state == State::Zero { 0.0 } else { value }, state)
}

fn line_key(number: usize) -> Key {
    let shade = LINES[number % LINES.len()];
    if number < LINES.len() { Key::Line(shade) } else { Key::Dashes(shade) }
}

/// Colours come again after the sixth curve; dashes then tell the curves apart.
fn draw_piece(frame: &Frame, piece: &mut Vec<(f64, f64)>, number: usize) -> Result<(), ReportError> {
    let shade = LINES[number % LINES.len()];
    if number < LINES.len() {
        frame.canvas.line(piece, shade, 1.8)?;
    } else {
        frame.canvas.dashes(piece, shade, 1.8)?;
    }
    piece.clear();
    Ok(())
}

/// A sign at the lower edge for an instance without a value.
fn absent(frame: &Frame, x: f64, state: State) -> Result<(), ReportError> {
    let y = frame.top + frame.height - 8.0;
    match state {
        State::Failed => frame.canvas.cross((x, y), 3.5, GREY),
        _ => frame.canvas.line(&[(x, y - 4.0), (x, y + 4.0)], GREY, 1.3),
    }
}

fn values_axis(series: &[Series], units: &str, long_name: &str) -> Axis {
    let values = series.iter().flat_map(|one| &one.values);
    let shown = values.filter(|(_, state)| state.has_value()).map(|(value, _)| *value);
    let log = spans_decades(shown.clone());
    // What is nothing stands at 0, which has no place on a logarithmic axis.
    let zero = series.iter().flat_map(|one| &one.values).any(|(_, state)| *state == State::Zero);
    Axis::over(shown.chain((zero && !log).then_some(0.0)), units, long_name, log, 0.06)
}

/// Names of the curves where there are several.
fn line_entries(series: &[Series]) -> Vec<(Key, String)> {
    if series.len() < 2 {
        return Vec::new();
    }
    series.iter().enumerate().map(|(number, one)| (line_key(number), one.name.clone())).collect()
}

fn state_entries(series: &[Series]) -> Vec<(Key, String)> {
    let tally = Tally::of(series.iter().flat_map(|one| &one.values).map(|(_, state)| *state));
    let mut entries = Vec::new();
    if tally.doubtful > 0 {
        entries.push((Key::Ring(LINES[0]), format!("{DOUBTFUL} ({})", tally.doubtful)));
    }
    if tally.zero > 0 {
        entries.push((Key::Dot(GREY), format!("{NOTHING} ({})", tally.zero)));
    }
    if tally.failed > 0 {
        entries.push((Key::Cross(GREY), format!("failed ({})", tally.failed)));
    }
    if tally.empty > 0 {
        entries.push((Key::Tick(GREY), format!("no value, nothing failed ({})", tally.empty)));
    }
    entries
}

/// One panel for each parameter of a list.
pub(super) fn scatter(
    heading: &str,
    units: &str,
    long_name: &str,
    parameters: &[Coordinate],
    series: &Series,
) -> Result<String, ReportError> {
    let y_axis = values_axis(std::slice::from_ref(series), units, long_name);
    let count = series.values.len();
    let every = count.div_ceil(MOST_POINTS).max(1);
    let columns = parameters.len().clamp(1, 3);
    let rows = parameters.len().div_ceil(columns);
    let (width, height) = if columns == 1 { (560.0, 360.0) } else { (270.0, 230.0) };
    let (left, top, gap, down) = (left_margin(&y_axis, height), 40.0, 22.0, 62.0);
    let mut entries = state_entries(std::slice::from_ref(series));
    if every > 1 {
        entries.insert(0, (Key::Dot(LINES[0]), format!("every {every}th of {count} instances")));
    }
    let field = columns as f64 * (width + gap) - gap;
    let total_width = left + field + 28.0;
    let key_top = top + rows as f64 * (height + down) + 4.0;
    let total = (total_width, key_top + key_rows(field, &entries) * KEY_ROW);
    picture(total, |canvas| {
        title(canvas, heading, left, total_width)?;
        for (number, parameter) in parameters.iter().enumerate() {
            let log = is_log_spaced(&parameter.values);
            let values = parameter.values.iter().copied();
            let x_axis = Axis::over(values, &parameter.units, &short(parameter), log, 0.04);
            let (row, column) = (number / columns, number % columns);
            let frame = Frame {
                canvas,
                left: left + column as f64 * (width + gap),
                top: top + row as f64 * (height + down),
                width,
                height,
                x: &x_axis,
                y: &y_axis,
            };
            frame.grid()?;
            for (&(value, state), &x) in series.values.iter().zip(&parameter.values).step_by(every) {
                let (value, state) = drawn((value, state));
                let at = frame.at(x, value);
                if !at.0.is_finite() {
                    continue;
                }
                match state {
                    State::Good if at.1.is_finite() => canvas.dot(at, 2.4, LINES[0])?,
                    State::Zero if at.1.is_finite() => canvas.dot(at, 2.4, GREY)?,
                    State::Doubtful if at.1.is_finite() => canvas.ring(at, 3.0, LINES[0])?,
                    state => absent(&frame, at.0, state)?,
                }
            }
            frame.edges(true, column == 0)?;
        }
        key(canvas, (left, key_top), left + field, &entries)
    })
}

//! Values over one axis as curves, and values of a list as clouds of points.

use super::ReportError;
use super::axis::{Axis, is_log_spaced, spans_decades};
use super::canvas::{Anchor, GREY, INK, LINES, WHITE, picture};
use super::frame::{
    DOUBTFUL, Frame, KEY_ROW, Key, NOTHING, SMALL, State, Tally, colour, key, key_rows, left_margin, title,
};
use super::hover::{Hover, Told};
use super::labels::short;
use super::labels::shown;
use super::raster::Dots;
use crate::store::Coordinate;
use plotters::style::RGBColor;

/// Points of a picture that are shapes of their own; more are one image.
const MOST_SHAPES: usize = 2000;
/// Points of one panel that the pointer is told of at most.
const MOST_TOLD: usize = 500;
/// The colour of points in an image: it is seen on a light and on a dark page.
const BOTH: RGBColor = RGBColor(20, 115, 195);
/// Markers on a curve are drawn up to this many points.
const MOST_MARKERS: usize = 80;

/// Radius of the dot on a point that was reached by a jump.
const JUMP: f64 = 4.2;

/// One curve or cloud: a value and its state for each instance.
#[derive(Default)]
pub(super) struct Series {
    pub name: String,
    pub values: Vec<(f64, State)>,
    /// A second state's: dashed, in the colour of the series before it.
    pub second: bool,
    /// Of a curve that is followed: the points that were reached by a jump.
    pub jumps: Vec<bool>,
}

/// Curves side by side on common axes.
pub(super) struct Curves<'a> {
    pub heading: &'a str,
    /// SI unit of the values, as the results file writes it.
    pub units: &'a str,
    pub long_name: &'a str,
    pub x: &'a Coordinate,
    /// Panels in a row.
    pub columns: usize,
    /// What the curves differ by; empty for one curve.
    pub by: String,
    /// Captions and curves; the same curves in every panel.
    pub panels: Vec<(String, Vec<Series>)>,
}

impl Curves<'_> {
    /// The picture, and what lies where in it.
    pub fn draw(&self) -> Result<(String, Hover), ReportError> {
        let x = self.x;
        let x_axis =
            Axis::over(x.values.iter().copied(), &x.units, &short(x), is_log_spaced(&x.values), 0.03);
        let all = || self.panels.iter().flat_map(|(_, series)| series);
        let y_axis = values_axis(all(), self.units, self.long_name);
        let mut order: Vec<usize> = (0..x.values.len()).filter(|&i| x.values[i].is_finite()).collect();
        order.sort_by(|&a, &b| x.values[a].total_cmp(&x.values[b]));
        let lines = self.panels.first().map_or(Vec::new(), |(_, series)| line_entries(&self.by, series));
        let mut entries: Vec<(Key, String)> = lines.into_iter().chain(state_entries(all())).collect();
        if all().any(|one| one.jumps.contains(&true)) {
            entries.push((Key::Dot(INK), "reached by a jump".to_owned()));
        }
        let columns = self.columns.clamp(1, self.panels.len().max(1));
        let rows = self.panels.len().div_ceil(columns);
        let (width, height) = if columns == 1 { (560.0, 360.0) } else { (270.0, 230.0) };
        let captions = if self.panels.len() > 1 { 20.0 } else { 0.0 };
        let (left, top, gap, down) = (left_margin(&y_axis, height), 40.0, 22.0, 24.0 + captions);
        let field = (columns as f64 * (width + gap) - gap, rows as f64 * (height + down) - 24.0);
        let total_width = left + field.0 + 28.0;
        let key_top = top + field.1 + 64.0;
        let total = (total_width, key_top + key_rows(field.0, &entries) * KEY_ROW);
        let mut hover = Hover::default();
        let svg = picture(total, |canvas| {
            title(canvas, self.heading, left, total_width)?;
            for (number, (caption, series)) in self.panels.iter().enumerate() {
                let (row, column) = (number / columns, number % columns);
                let frame = Frame {
                    canvas,
                    left: left + column as f64 * (width + gap),
                    top: top + row as f64 * (height + down) + captions,
                    width,
                    height,
                    x: &x_axis,
                    y: &y_axis,
                };
                let middle = (frame.left + width / 2.0, frame.top - 10.0);
                canvas.text(caption, middle, SMALL, Anchor::Middle, INK)?;
                frame.grid()?;
                hover.points(self.series(&frame, series, &order)?);
                frame.ticks(number + columns >= self.panels.len(), column == 0)?;
            }
            // One label for all columns, below the lowest row.
            let below = Frame { canvas, left, top, width, height: field.1, x: &x_axis, y: &y_axis };
            below.x_label(left + field.0 / 2.0)?;
            key(canvas, (left, key_top), left + field.0, &entries)
        })?;
        Ok((svg, hover))
    }

    /// The curves of one panel; gives its points with what they stand for.
    fn series(&self, frame: &Frame, series: &[Series], order: &[usize]) -> Result<Vec<Told>, ReportError> {
        let mut told = Vec::new();
        for (number, one) in series.iter().enumerate() {
            let points: Vec<Point> =
                order.iter().map(|&i| Point::of(self.x.values[i], one.values[i])).collect();
            let pen = Pen::of(series, number);
            draw_line(frame, &points, &pen)?;
            draw_markers(frame, &points, &pen)?;
            for (point, _) in points.iter().zip(order).filter(|(_, i)| one.jumps.get(**i) == Some(&true)) {
                point.place(frame).map_or(Ok(()), |at| frame.canvas.dot(at, JUMP, pen.shade))?;
            }
            for (point, i) in points.iter().zip(order) {
                let Some(at) = point.place(frame) else { continue };
                let name = if one.name.is_empty() { String::new() } else { format!(", {}", one.name) };
                let second = if one.second { ", second state" } else { "" };
                let x = shown(self.x, self.x.values[*i]);
                told.push((at, format!("{x}{name}{second}: {}", frame.y.unit.value(point.value))));
            }
        }
        Ok(told)
    }
}

/// How a curve is drawn.
struct Pen {
    shade: RGBColor,
    dashed: bool,
    /// Whether signs stand for points without a place: below the first curve.
    signs: bool,
}

impl Pen {
    /// Of the curve of this number. A second state shares the colour of its first.
    fn of(series: &[Series], number: usize) -> Self {
        let first = |series: &[Series]| series.iter().filter(|one| !one.second).count();
        let place = first(&series[..=number]).max(1) - 1;
        Self { shade: shade(place, first(series)), dashed: series[number].second, signs: number == 0 }
    }
}

/// Colours told apart, or, of more curves than there are, from dark to light in their order.
fn shade(place: usize, count: usize) -> RGBColor {
    match count {
        0..=LINES_AT_MOST => LINES[place % LINES.len()],
        _ => colour(0.92 * place as f64 / (count - 1) as f64),
    }
}

const LINES_AT_MOST: usize = LINES.len();

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

/// Joins the points that are neighbours; to one that is doubtful there is no line.
fn draw_line(frame: &Frame, points: &[Point], pen: &Pen) -> Result<(), ReportError> {
    let mut piece: Vec<(f64, f64)> = Vec::new();
    for point in points {
        if let Some(at) = point.place(frame) {
            match point.state {
                State::Doubtful => draw_piece(frame, &mut piece, pen)?,
                _ => piece.push(at),
            }
            continue;
        }
        draw_piece(frame, &mut piece, pen)?;
        let x = frame.at(point.x, f64::NAN).0;
        if x.is_finite() && pen.signs {
            absent(frame, x, point.state)?;
        }
    }
    draw_piece(frame, &mut piece, pen)
}

fn draw_markers(frame: &Frame, points: &[Point], pen: &Pen) -> Result<(), ReportError> {
    for (number, point) in points.iter().enumerate() {
        let Some(at) = point.place(frame) else { continue };
        let beside = |i: Option<usize>| {
            i.and_then(|i| points.get(i)).is_some_and(|point| point.place(frame).is_some())
        };
        let alone = !beside(number.checked_sub(1)) && !beside(Some(number + 1));
        match point.state {
            State::Doubtful => frame.canvas.ring(at, 3.5, pen.shade)?,
            State::Zero => frame.canvas.dot(at, 2.6, GREY)?,
            _ if points.len() <= MOST_MARKERS || alone => frame.canvas.dot(at, 2.6, pen.shade)?,
            _ => {}
        }
    }
    Ok(())
}

/// Where a value stands: one that is nothing, at 0.
fn drawn((value, state): (f64, State)) -> (f64, State) {
    (if state == State::Zero { 0.0 } else { value }, state)
}

fn draw_piece(frame: &Frame, piece: &mut Vec<(f64, f64)>, pen: &Pen) -> Result<(), ReportError> {
    match pen.dashed {
        true => frame.canvas.dashes(piece, pen.shade, 1.8)?,
        false => frame.canvas.line(piece, pen.shade, 1.8)?,
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

fn values_axis<'a>(series: impl Iterator<Item = &'a Series>, units: &str, long_name: &str) -> Axis {
    let all: Vec<(f64, State)> = series.flat_map(|one| one.values.iter().copied()).collect();
    let shown = all.iter().filter(|(_, state)| state.has_value()).map(|(value, _)| *value);
    let log = spans_decades(shown.clone());
    // What is nothing stands at 0, which has no place on a logarithmic axis.
    let zero = all.iter().any(|(_, state)| *state == State::Zero);
    Axis::over(shown.chain((zero && !log).then_some(0.0)), units, long_name, log, 0.06)
}

/// Names of the curves where there are several, the first with what they differ by.
fn line_entries(by: &str, series: &[Series]) -> Vec<(Key, String)> {
    let several = series.iter().filter(|one| !one.second).count() > 1;
    let name = |(number, one): (usize, &Series)| {
        let name = if number == 0 { format!("{by} {}", one.name) } else { one.name.clone() };
        (several && !one.second).then(|| (Key::Line(Pen::of(series, number).shade), name.trim().to_owned()))
    };
    let second = series.iter().any(|one| one.second && one.values.iter().any(|value| value.1.has_value()));
    let dashes =
        second.then(|| (Key::Dashes(if several { GREY } else { LINES[0] }), "second state".to_owned()));
    series.iter().enumerate().filter_map(name).chain(dashes).collect()
}

fn state_entries<'a>(series: impl Iterator<Item = &'a Series>) -> Vec<(Key, String)> {
    let first = series.filter(|one| !one.second);
    let tally = Tally::of(first.flat_map(|one| &one.values).map(|(_, state)| *state));
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

/// One panel for each parameter of a list, and what lies where in it.
pub(super) fn scatter(
    heading: &str,
    (units, long_name): (&str, &str),
    parameters: &[Coordinate],
    series: &Series,
) -> Result<(String, Hover), ReportError> {
    let y_axis = values_axis(std::iter::once(series), units, long_name);
    let count = series.values.len();
    let columns = if parameters.len() == 4 { 2 } else { parameters.len().clamp(1, 3) };
    let rows = parameters.len().div_ceil(columns);
    let (width, height) = if columns == 1 { (560.0, 360.0) } else { (270.0, 230.0) };
    let (left, top, gap, down) = (left_margin(&y_axis, height), 40.0, 22.0, 62.0);
    let entries = state_entries(std::iter::once(series));
    let shapes = count * parameters.len() <= MOST_SHAPES;
    let field = columns as f64 * (width + gap) - gap;
    let total_width = left + field + 28.0;
    let key_top = top + rows as f64 * (height + down) + 4.0;
    let total = (total_width, key_top + key_rows(field, &entries) * KEY_ROW);
    let mut hover = Hover::default();
    let svg = picture(total, |canvas| {
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
            hover.points(cloud(&frame, parameter, series, shapes)?);
            frame.edges(true, column == 0)?;
        }
        key(canvas, (left, key_top), left + field, &entries)
    })?;
    Ok((svg, hover))
}

/// The points of one panel, as shapes or as one image; gives some of them with what they stand for.
fn cloud(
    frame: &Frame,
    parameter: &Coordinate,
    series: &Series,
    shapes: bool,
) -> Result<Vec<Told>, ReportError> {
    let mut told = Vec::new();
    let mut dots = Dots::new(frame.width, frame.height);
    let every = series.values.len().div_ceil(MOST_TOLD).max(1);
    for (number, (&value, &x)) in series.values.iter().zip(parameter.values.iter()).enumerate() {
        let (value, state) = drawn(value);
        let at = frame.at(x, value);
        if !at.0.is_finite() {
            continue;
        }
        let inside = (at.0 - frame.left, at.1 - frame.top);
        match state {
            State::Good | State::Zero if at.1.is_finite() => {
                let shade = match state {
                    State::Zero => GREY,
                    _ if shapes => LINES[0],
                    _ => BOTH,
                };
                if shapes { frame.canvas.dot(at, 2.4, shade)? } else { dots.dot(inside, 1.8, shade) }
            }
            State::Doubtful if at.1.is_finite() && shapes => frame.canvas.ring(at, 3.0, LINES[0])?,
            State::Doubtful if at.1.is_finite() => {
                dots.dot(inside, 3.0, LINES[0]);
                dots.dot(inside, 1.7, WHITE);
            }
            state if shapes => absent(frame, at.0, state)?,
            _ => dots.dot((inside.0, frame.height - 4.0), 1.5, GREY),
        }
        if at.1.is_finite() && number.is_multiple_of(every) {
            let (x, value) = (shown(parameter, x), frame.y.unit.value(value));
            told.push((at, format!("instance {number}, {x}: {value}")));
        }
    }
    if !shapes {
        let end = (frame.left + frame.width, frame.top + frame.height);
        frame.canvas.image((frame.left, frame.top), end, dots.image()?)?;
    }
    Ok(told)
}

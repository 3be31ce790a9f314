//! Values over one axis as curves, and values of a list as clouds of points.

use super::axis::{PlotAxis, least_of_decades};
use super::canvas::{Anchor, BACK, GREY, INK, LINES, Rgb, picture};
use super::frame::{
    Frame, KEY_ROW, Legend, SMALL, State, Tally, colour, is_place, key, key_rows, left_margin, title,
};
use super::hover::{Hint, Hover};
use super::labels::{label, shown};
use crate::store::Coordinate;

/// Markers on a curve are drawn up to this many points.
const MOST_MARKERS: usize = 80;
/// Radius of the dot on a point that was reached by a jump.
const JUMP: f64 = 4.2;
/// Pixels between symbols of several series at one place.
const BESIDE: f64 = 8.0;
/// Width of a line, and of one on the first branch where colours tell other things.
const WIDE: f64 = 1.8;
const THIN: f64 = 0.8;

/// One curve: a value and its state for each instance.
#[derive(Default)]
pub(super) struct Curve {
    pub name: String,
    pub values: Vec<(f64, State)>,
    /// A second state's: dashed, in the colour of the series before it.
    pub second: bool,
    /// Of a curve that is followed: the points that were reached by a jump.
    pub jumps: Vec<bool>,
    /// Likewise: the points from which none leads to the next one.
    pub torn: Vec<bool>,
    /// The branch of each point, by its number in [`CurvePlot::branches`]; empty where the file does not tell.
    pub branch: Vec<u8>,
}

/// How values over an axis are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Style {
    Lines,
    /// Without lines: nothing lies between names.
    Symbols,
    /// Upright lines from the lower end: nothing lies between orders.
    Sticks,
}

/// Curves side by side on common axes.
pub(super) struct CurvePlot<'a> {
    pub heading: &'a str,
    /// SI unit of the values, as the results file writes it.
    pub units: &'a str,
    pub long_name: &'a str,
    pub x: &'a Coordinate,
    /// Panels in a row.
    pub columns: usize,
    /// What the curves differ by; empty for one curve.
    pub by: String,
    /// Whether the curves are ways there and back, of which the second is dashed.
    pub ways: bool,
    /// Words for branches by their number; none where the file does not tell.
    pub branches: Vec<String>,
    pub style: Style,
    /// Captions and curves; the same curves in every panel.
    pub panels: Vec<(String, Vec<Curve>)>,
}

impl CurvePlot<'_> {
    /// The picture, and what lies where in it.
    pub fn draw(&self) -> (String, Hover) {
        let x = self.x;
        let x_axis = match self.style {
            Style::Sticks => PlotAxis::over(x.values.iter().copied(), &x.units, label(x), false, 0.06),
            _ => PlotAxis::of(x, 0.03),
        };
        let all = || self.panels.iter().flat_map(|(_, series)| series);
        let y_axis = values_axis(all(), self.units, self.long_name);
        let mut order: Vec<usize> = (0..x.values.len()).filter(|&i| x.values[i].is_finite()).collect();
        order.sort_by(|&a, &b| x.values[a].total_cmp(&x.values[b]));
        let lines = self.panels.first().map_or(Vec::new(), |(_, series)| self.line_entries(series));
        let mut entries: Vec<(Legend, String)> = lines.into_iter().chain(state_entries(all())).collect();
        if all().any(|one| one.jumps.contains(&true)) {
            entries.push((Legend::Dot(INK), "reached by a jump".to_owned()));
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
            title(canvas, self.heading, left, total_width);
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
                canvas.text(caption, middle, SMALL, Anchor::Middle, INK);
                frame.grid();
                hover.points(self.series(&frame, series, &order));
                frame.ticks(number + columns >= self.panels.len(), column == 0);
            }
            // One label for all columns, below the lowest row.
            let below = Frame { canvas, left, top, width, height: field.1, x: &x_axis, y: &y_axis };
            below.x_label(left + field.0 / 2.0);
            key(canvas, (left, key_top), left + field.0, &entries)
        });
        (svg, hover)
    }

    /// The curves of one panel; gives its points with what they stand for.
    fn series(&self, frame: &Frame, series: &[Curve], order: &[usize]) -> Vec<Hint> {
        let mut told = Vec::new();
        for (number, one) in series.iter().enumerate() {
            let pen = self.pen(series, number);
            let points: Vec<Point> = order.iter().map(|&i| self.point(one, i, &pen)).collect();
            match self.style {
                Style::Lines => draw_line(frame, &points, &pen),
                style => draw_apart(frame, &points, style),
            }
            draw_markers(frame, &points, self.style != Style::Lines);
            for (point, i) in points.iter().zip(order) {
                if let Some(at) = point.place(frame).filter(|_| one.jumps.get(*i) == Some(&true)) {
                    frame.canvas.dot(at, JUMP, point.shade);
                }
            }
            for (point, i) in points.iter().zip(order) {
                let Some(at) = point.place(frame) else { continue };
                let name = if one.name.is_empty() { String::new() } else { format!(", {}", one.name) };
                let second = if one.second { ", second state" } else { "" };
                let x = shown(self.x, self.x.values[*i]);
                told.push((at, format!("{x}{name}{second}: {}", frame.y.unit.value(point.value))));
            }
        }
        told
    }

    fn point(&self, series: &Curve, i: usize, pen: &Pen) -> Point {
        let (value, state) = drawn(series.values[i]);
        let branch = series.branch.get(i).copied().unwrap_or(0);
        let own = if pen.by_branch { LINES[usize::from(branch.max(1) - 1) % LINES.len()] } else { pen.shade };
        let torn = series.torn.get(i) == Some(&true);
        let shade = if state == State::Excluded { BACK } else { own };
        let thin = pen.thin && branch == 1;
        Point { x: self.x.values[i], value, state, place: i, shift: pen.shift, torn, branch, shade, thin }
    }

    /// How the curve of this number is drawn. A second state shares the colour of its first; a single curve has the colours
    /// of its branches.
    fn pen(&self, series: &[Curve], number: usize) -> Pen {
        let first = |series: &[Curve]| series.iter().filter(|one| !one.second).count();
        let (place, count) = (first(&series[..=number]).max(1) - 1, first(series));
        let several = self.has_branches();
        Pen {
            shade: shade(place, count),
            dashed: series[number].second || (self.ways && place == 1),
            signs: number == 0,
            by_branch: several && (count == 1 || self.ways),
            thin: several && count > 1 && !self.ways,
            shift: match self.style {
                Style::Lines => 0.0,
                _ => BESIDE * (place as f64 - 0.5 * (count as f64 - 1.0)),
            },
        }
    }

    /// Whether points are on different branches.
    fn has_branches(&self) -> bool {
        let all = || self.panels.iter().flat_map(|(_, series)| series).flat_map(|one| &one.branch);
        !self.branches.is_empty() && [1, 2].iter().all(|branch| all().any(|one| one == branch))
    }

    /// Names of the curves where there are several, the first with what they differ by, and of the branches.
    fn line_entries(&self, series: &[Curve]) -> Vec<(Legend, String)> {
        let several = series.iter().filter(|one| !one.second).count() > 1;
        let name = |(number, one): (usize, &Curve)| {
            let name = if number == 0 { format!("{} {}", self.by, one.name) } else { one.name.clone() };
            let pen = self.pen(series, number);
            let shade = if pen.by_branch { GREY } else { pen.shade };
            let sample = match self.style {
                Style::Symbols => Legend::Dot(shade),
                _ if pen.dashed => Legend::Dashes(shade),
                _ => Legend::Line(shade),
            };
            (several && !one.second).then(|| (sample, name.trim().to_owned()))
        };
        let mut entries: Vec<(Legend, String)> = series.iter().enumerate().filter_map(name).collect();
        if self.has_branches() {
            let words = self.branches.iter().enumerate().skip(1);
            let thin = several && !self.ways;
            entries.extend(words.filter(|(code, _)| !thin || *code == 1).map(|(code, word)| match thin {
                true => (Legend::Thin(GREY), format!("thin: {word}")),
                false => (Legend::Line(LINES[(code - 1) % LINES.len()]), word.clone()),
            }));
        }
        let has_second = |one: &Curve| one.second && one.values.iter().any(|value| value.1.has_value());
        if series.iter().any(has_second) {
            let shade = if several || self.has_branches() { GREY } else { LINES[0] };
            entries.push((Legend::Dashes(shade), "second state".to_owned()));
        }
        entries
    }
}

/// How a curve is drawn.
struct Pen {
    shade: Rgb,
    dashed: bool,
    /// Whether signs stand for points without a place: below the first curve.
    signs: bool,
    /// Whether each point has the colour of its branch, or the lines of the first branch are thin.
    by_branch: bool,
    thin: bool,
    /// Pixels to the right of its place.
    shift: f64,
}

/// Colours told apart, or, of more curves than there are, from dark to light in their order: neither so dark nor so light
/// that they are lost on a dark or on a light page.
fn shade(place: usize, count: usize) -> Rgb {
    match count {
        0..=LINES_AT_MOST => LINES[place % LINES.len()],
        _ => colour(0.3 + 0.55 * place as f64 / (count - 1) as f64),
    }
}

const LINES_AT_MOST: usize = LINES.len();

/// One value of a curve.
struct Point {
    x: f64,
    value: f64,
    state: State,
    /// Its number along the axis.
    place: usize,
    shift: f64,
    torn: bool,
    branch: u8,
    shade: Rgb,
    thin: bool,
}

impl Point {
    /// Its place on the picture, if it has one. What lies far below the rest stands at the lower edge.
    fn place(&self, frame: &Frame) -> Option<(f64, f64)> {
        let (x, y) = frame.at(self.x, self.value);
        let shown = self.state.has_value() || matches!(self.state, State::Zero | State::Excluded);
        let at = (x + self.shift, y.clamp(frame.top, frame.top + frame.height));
        (shown && is_place(&at)).then_some(at)
    }

    /// Whether a line leads to its neighbour: not across a jump, and not from one branch to another.
    fn joins(&self, other: &Self) -> bool {
        let first = if self.place < other.place { self } else { other };
        !first.torn && (self.branch == other.branch || self.branch == 0 || other.branch == 0)
    }
}

/// Joins the points that are neighbours; to one that is doubtful there is no line.
fn draw_line(frame: &Frame, points: &[Point], pen: &Pen) {
    // Points of one look, and the look of each piece.
    let mut piece: Vec<(f64, f64)> = Vec::new();
    let mut look = (pen.shade, false);
    let mut before: Option<&Point> = None;
    for point in points {
        let place = point.place(frame);
        let x = frame.at(point.x, f64::NAN).0;
        if place.is_none() && x.is_finite() && pen.signs {
            absent(frame, x, point.state);
        }
        let Some(at) = place.filter(|_| !matches!(point.state, State::Doubtful(_))) else {
            draw_piece(frame, &mut piece, look, pen);
            before = None;
            continue;
        };
        match before.filter(|before| before.joins(point)) {
            None => draw_piece(frame, &mut piece, look, pen),
            Some(before) => {
                let back = if before.state == State::Excluded { before } else { point };
                let next = (back.shade, point.thin);
                if next != look && piece.len() > 1 {
                    let last = piece.last().copied();
                    draw_piece(frame, &mut piece, look, pen);
                    piece.extend(last);
                }
                look = next;
            }
        }
        piece.push(at);
        before = Some(point);
    }
    draw_piece(frame, &mut piece, look, pen)
}

/// Symbols or sticks without lines between them.
fn draw_apart(frame: &Frame, points: &[Point], style: Style) {
    for point in points {
        match point.place(frame) {
            Some(at) if style == Style::Sticks => {
                let zero = frame.top + (1.0 - frame.y.place(0.0)) * frame.height;
                let bottom = frame.top + frame.height;
                let foot = if zero.is_finite() { zero.clamp(frame.top, bottom) } else { bottom };
                frame.canvas.line(&[(at.0, foot), at], point.shade, 2.4);
            }
            None => absent(frame, frame.at(point.x, f64::NAN).0 + point.shift, point.state),
            _ => {}
        }
    }
}

fn draw_markers(frame: &Frame, points: &[Point], always: bool) {
    for (number, point) in points.iter().enumerate() {
        let Some(at) = point.place(frame) else { continue };
        let beside = |i: Option<usize>| {
            let other = i.and_then(|i| points.get(i));
            other.is_some_and(|other| other.place(frame).is_some() && other.joins(point))
        };
        let alone = !beside(number.checked_sub(1)) && !beside(Some(number + 1));
        let radius = if always { 3.6 } else { 2.6 };
        match point.state {
            State::Doubtful(_) => frame.canvas.ring(at, 3.5, point.shade),
            State::Zero => frame.canvas.dot(at, radius, GREY),
            _ if always || points.len() <= MOST_MARKERS || alone => frame.canvas.dot(at, radius, point.shade),
            _ => {}
        }
    }
}

/// Where a value stands: one that is nothing, at 0.
pub(super) fn drawn((value, state): (f64, State)) -> (f64, State) {
    (if state == State::Zero { 0.0 } else { value }, state)
}

fn draw_piece(frame: &Frame, piece: &mut Vec<(f64, f64)>, (shade, thin): (Rgb, bool), pen: &Pen) {
    let width = if thin { THIN } else { WIDE };
    frame.canvas.stroke(piece, (shade, width), pen.dashed);
    piece.clear();
}

/// A sign at the lower edge for an instance without a value.
pub(super) fn absent(frame: &Frame, x: f64, state: State) {
    let y = frame.top + frame.height - 8.0;
    match state {
        State::Failed(_) => frame.canvas.cross((x, y), 3.5, GREY),
        _ => frame.canvas.line(&[(x, y - 4.0), (x, y + 4.0)], GREY, 1.3),
    }
}

/// The axis of the values, those outside the limits among them.
pub(super) fn values_axis<'a>(
    series: impl Iterator<Item = &'a Curve>,
    units: &str,
    long_name: &str,
) -> PlotAxis {
    let all: Vec<(f64, State)> = series.flat_map(|one| one.values.iter().copied()).collect();
    let is_drawn = |state: State| state.has_value() || state == State::Excluded;
    let shown = || all.iter().filter(|one| is_drawn(one.1)).map(|one| one.0);
    let least = least_of_decades(shown());
    // What is nothing stands at 0, which has no place on a logarithmic axis.
    let zero = least.is_none() && all.iter().any(|(_, state)| *state == State::Zero);
    let kept = shown().filter(|value| least.is_none_or(|least| *value >= least));
    PlotAxis::over(kept.chain(zero.then_some(0.0)), units, long_name, least.is_some(), 0.06)
}

/// What a key says of points that are no plain values.
pub(super) fn state_entries<'a>(series: impl Iterator<Item = &'a Curve>) -> Vec<(Legend, String)> {
    let first = series.filter(|one| !one.second);
    let tally = Tally::of(first.flat_map(|one| &one.values).map(|(_, state)| *state));
    tally.entries([
        Legend::Ring(LINES[0]),
        Legend::Dot(GREY),
        Legend::Tick(GREY),
        Legend::Cross(GREY),
        Legend::Dot(BACK),
    ])
}

//! Values of a list as clouds of points, a panel for each parameter; of very many, how dense they lie.

use super::axis::PlotAxis;
use super::canvas::{BACK, GREY, LINES, picture};
use super::curve_picture::{Curve, absent, drawn, state_entries, values_axis};
use super::frame::{Frame, KEY_ROW, Legend, State, colour, is_place, key, key_rows, left_margin, title};
use super::hover::{Hint, Hover};
use super::labels::shown;
use super::raster::Dots;
use super::uncertainty::density;
use crate::store::Coordinate;

/// Points of a picture that are shapes of their own; of more the density is drawn.
const MOST_SHAPES: usize = 2000;
/// Points of one panel that the pointer is told of at most.
const MOST_TOLD: usize = 500;

/// One panel for each parameter of a list, and what lies where in it.
pub(super) fn draw(
    heading: &str,
    (units, long_name): (&str, &str),
    parameters: &[Coordinate],
    series: &Curve,
) -> (String, Hover) {
    let y_axis = values_axis(std::iter::once(series), units, long_name);
    let count = series.values.len();
    let columns = if parameters.len() == 4 { 2 } else { parameters.len().clamp(1, 3) };
    let rows = parameters.len().div_ceil(columns);
    let (width, height) = if columns == 1 { (560.0, 360.0) } else { (270.0, 230.0) };
    let (left, top, gap, down) = (left_margin(&y_axis, height), 40.0, 22.0, 62.0);
    let mut entries = state_entries(std::iter::once(series));
    let shapes = count <= MOST_SHAPES;
    if !shapes {
        entries.insert(0, (Legend::Swatch(colour(1.0)), "where most lie; dark: few".to_owned()));
    }
    let field = columns as f64 * (width + gap) - gap;
    let total_width = left + field + 28.0;
    let key_top = top + rows as f64 * (height + down) + 4.0;
    let total = (total_width, key_top + key_rows(field, &entries) * KEY_ROW);
    let mut hover = Hover::default();
    let svg = picture(total, |canvas| {
        title(canvas, heading, left, total_width);
        for (number, parameter) in parameters.iter().enumerate() {
            let x_axis = PlotAxis::of(parameter, 0.04);
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
            frame.grid();
            match shapes {
                true => cloud(&frame, parameter, series),
                false => dense(&frame, parameter, series),
            }
            hover.points(told(&frame, parameter, series));
            frame.edges(true, column == 0);
        }
        key(canvas, (left, key_top), left + field, &entries)
    });
    (svg, hover)
}

/// The points of one panel as shapes.
fn cloud(frame: &Frame, parameter: &Coordinate, series: &Curve) {
    for (&value, &x) in series.values.iter().zip(parameter.values.iter()) {
        let (value, state) = drawn(value);
        let at = frame.at(x, value);
        if !at.0.is_finite() {
            continue;
        }
        match state {
            State::Good if at.1.is_finite() => frame.canvas.dot(at, 2.4, LINES[0]),
            State::Excluded if at.1.is_finite() => frame.canvas.dot(at, 2.0, BACK),
            State::Zero if at.1.is_finite() => frame.canvas.dot(at, 2.4, GREY),
            State::Doubtful(_) if at.1.is_finite() => frame.canvas.ring(at, 3.0, LINES[0]),
            state => absent(frame, at.0, state),
        }
    }
}

/// Where the points of one panel lie how densely, over those outside the limits.
fn dense(frame: &Frame, parameter: &Coordinate, series: &Curve) {
    let (mut x, mut y, mut lost) = (Vec::new(), Vec::new(), Vec::new());
    let mut back = Dots::new(frame.width, frame.height);
    let mut any_back = false;
    for (&value, &at) in series.values.iter().zip(parameter.values.iter()) {
        let (value, state) = drawn(value);
        let place = frame.at(at, value);
        match state {
            State::Excluded if is_place(&place) => {
                back.dot((place.0 - frame.left, place.1 - frame.top), 1.6, GREY);
                any_back = true;
            }
            State::Failed(_) | State::Empty | State::Excluded => lost.push((place.0, state)),
            _ => {
                x.push(at);
                y.push(value);
            }
        }
    }
    let end = (frame.left + frame.width, frame.top + frame.height);
    if any_back {
        frame.canvas.image((frame.left, frame.top), end, &back.image());
    }
    density::rows(frame, &x, &y, &[]);
    let every = lost.len().div_ceil(MOST_TOLD / 2).max(1);
    let some = lost.into_iter().step_by(every).filter(|(x, _)| x.is_finite());
    some.into_iter().for_each(|(x, state)| absent(frame, x, state))
}

/// Some of the points with what they stand for.
fn told(frame: &Frame, parameter: &Coordinate, series: &Curve) -> Vec<Hint> {
    let every = series.values.len().div_ceil(MOST_TOLD).max(1);
    let one = |(number, (&value, &x)): (usize, (&(f64, State), &f64))| {
        let (value, _) = drawn(value);
        let at = frame.at(x, value);
        let text = || format!("instance {number}, {}: {}", shown(parameter, x), frame.y.unit.value(value));
        is_place(&at).then(|| (at, text()))
    };
    series.values.iter().zip(parameter.values.iter()).enumerate().step_by(every).filter_map(one).collect()
}

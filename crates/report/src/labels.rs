//! Words for axes, values and texts.

use super::quantity_text::DisplayUnit;
use crate::store::{Coordinate, Variable};

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

/// What a variable is called: in full, and where there is little room.
pub(super) fn names(variable: &Variable) -> (&str, String) {
    let label = if variable.long_name.is_empty() { &variable.name } else { &variable.long_name };
    (label, brief(label, &variable.name))
}

/// The least and the largest of some values; infinities, the wrong way round, of none.
pub(super) fn ends(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let ends = (f64::INFINITY, f64::NEG_INFINITY);
    values.fold(ends, |(low, high), value| (low.min(value), high.max(value)))
}

/// A value of an axis in the unit that fits it; zero, which none fits, in the axis' own.
pub(super) fn shown(axis: &Coordinate, value: f64) -> String {
    if let Some(word) = axis.words.get(value as usize) {
        return word.clone();
    }
    let largest = axis.values.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
    let unit = DisplayUnit::fitting(&axis.units, if value == 0.0 { largest } else { value.abs() });
    unit.digits(value, digits(&axis.values).max(4))
}

/// Digits that tell neighbouring values apart; samples in no order have none.
fn digits(values: &[f64]) -> usize {
    let rises = values.first() <= values.last();
    if values.windows(2).any(|pair| (pair[0] < pair[1]) != rises && pair[0] != pair[1]) {
        return 0;
    }
    let apart = values.windows(2).filter(|pair| pair[0] != pair[1]);
    apart.map(|pair| telling(pair[0], pair[1])).max().unwrap_or(0)
}

/// Digits that tell one value from another, with one to spare.
pub(super) fn telling(one: f64, other: f64) -> usize {
    let ratio = one.abs().max(other.abs()) / (one - other).abs();
    if ratio.is_finite() { (ratio.log10().ceil().max(0.0) as usize + 1).min(12) } else { 0 }
}

/// `2 nm to 5 nm`, in the unit of the larger, with as many digits as tell both ends apart; the one value where they are
/// all the same.
pub(super) fn span(values: impl Iterator<Item = f64>, units: &str) -> Option<String> {
    let (low, high) = ends(values.filter(|value| value.is_finite()));
    if low > high {
        return None;
    }
    let fitting = |value: f64| if value == 0.0 { low.abs().max(high.abs()) } else { value.abs() };
    let digits = telling(low, high).clamp(3, 7);
    let show = |value: f64| DisplayUnit::fitting(units, fitting(value)).digits(value, digits);
    Some(if show(low) == show(high) { show(high) } else { format!("{} to {}", show(low), show(high)) })
}

/// A value that says of what it is: `tip radius 5 nm`; a way along a curve says so itself.
pub(super) fn caption(axis: &Coordinate, value: f64) -> String {
    match axis.name.as_str() {
        "direction" => shown(axis, value),
        _ => format!("{} {}", short(axis), shown(axis, value)),
    }
}

/// First letter large.
pub fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

/// Texts shown in full at the page's end.
pub(super) fn is_long(text: &str) -> bool {
    text.len() > 200 || text.trim().contains('\n')
}

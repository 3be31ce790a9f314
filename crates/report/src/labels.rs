//! Words for axes, values and texts.

use super::quantity::Unit;
use crate::store::Coordinate;

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

/// A value of an axis in the unit that fits it; zero, which none fits, in the axis' own.
pub(super) fn shown(axis: &Coordinate, value: f64) -> String {
    if let Some(word) = axis.words.get(value as usize) {
        return word.clone();
    }
    let largest = axis.values.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
    Unit::fitting(&axis.units, if value == 0.0 { largest } else { value.abs() }).value(value)
}

/// First letter large.
pub(super) fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

/// Texts shown in full at the page's end.
pub(super) fn is_long(text: &str) -> bool {
    text.len() > 200 || text.trim().contains('\n')
}

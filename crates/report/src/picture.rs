//! One picture of a page, and the states that it shows.

use super::error_floor::errors;
use super::frame::State;
use super::hover::Hover;
use super::labels::shown;
use crate::observe::Observable;
use crate::store::{Coordinate, NO_STATE, Results, Variable};
use std::sync::Arc;

/// What a picture is about, and so where it stands on the page.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PictureKind {
    /// What a user asked for: observables, waveforms, force curves.
    Asked,
    /// Spectra, which stand below a heading of their own.
    Spectrum,
    /// How it was computed: estimates, periods, multipliers.
    Computed,
}

impl PictureKind {
    pub fn of(variable: &Variable) -> Self {
        let computed = variable.error_scale.is_empty() && Observable::from_name(&variable.name).is_none();
        if computed { Self::Computed } else { Self::Asked }
    }
}

/// One picture of the page.
pub(super) struct Picture {
    pub kind: PictureKind,
    /// Of its files, without folder and ending.
    pub name: String,
    pub title: String,
    /// What was left out or fixed; may be empty.
    pub note: String,
    pub svg: String,
    pub hover: Hover,
    /// Its numbers; none where they would be too many.
    pub csv: Option<String>,
}

impl Picture {
    /// The name of the picture's own file.
    pub fn file(&self) -> String {
        format!("{}.svg", self.name)
    }
}

/// A variable's values with what became of each.
pub(super) fn states(results: &Results, variable: &Variable) -> Vec<(f64, State)> {
    let harmonics = variable.harmonics.unwrap_or(1).max(1);
    let errors = errors(results, variable);
    let state = |(number, &value): (usize, &f64)| {
        let i = number / harmonics;
        let state = State::of(results.status.get(i).copied().unwrap_or_default(), value);
        let error = errors.as_ref().and_then(|all| all.get(i)).copied().unwrap_or(f64::NAN);
        (value, state.within(value, error))
    };
    variable.data.iter().enumerate().map(state).collect()
}

/// The same of the second states, where there are any with this variable.
pub(super) fn second_states(results: &Results, variable: &Variable) -> Option<Vec<(f64, State)>> {
    let branch = results.other_branch.as_ref()?;
    if branch.status.iter().all(|code| *code == NO_STATE) {
        return None;
    }
    let second = branch.variables.iter().find(|one| one.name == variable.name)?;
    let harmonics = second.harmonics.unwrap_or(1).max(1);
    let state = |(number, &value): (usize, &f64)| match branch.status.get(number / harmonics) {
        None | Some(&NO_STATE) => (f64::NAN, State::Empty),
        Some(status) => (value, State::of(*status, value)),
    };
    Some(second.data.iter().enumerate().map(state).collect())
}

/// The value of each axis at an instance.
pub(super) fn case(results: &Results, instance: usize) -> Vec<String> {
    places(results, instance).into_iter().map(|(axis, at)| shown(axis, axis.values[at])).collect()
}

/// Each axis, and the number of its value at an instance.
pub(super) fn places(results: &Results, instance: usize) -> Vec<(&Coordinate, usize)> {
    let mut rest = instance;
    let mut found = Vec::new();
    for axis in results.axes.iter().rev() {
        let length = axis.values.len().max(1);
        found.push((axis, if results.list { instance } else { rest % length }));
        rest /= length;
    }
    found.reverse();
    found.retain(|(axis, at)| *at < axis.values.len());
    found
}

/// Whole numbers as an axis.
pub(super) fn numbers(name: &str, long_name: &str, numbers: std::ops::Range<usize>) -> Coordinate {
    Coordinate {
        name: name.into(),
        units: "1".into(),
        long_name: long_name.into(),
        values: Arc::new(numbers.map(|number| number as f64).collect()),
        ..Coordinate::default()
    }
}

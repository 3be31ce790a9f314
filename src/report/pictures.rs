//! Which pictures a results file gets.

use super::ReportError;
use super::floor::{SCALES, errors};
use super::force_curve;
use super::frame::State;
use super::quantity::Unit;
use super::{variable, waveform};
use crate::store::{Coordinate, ForceCurve, Results, Variable};

/// Pictures of single instances at most, of each kind.
const MOST_INSTANCES: usize = 24;

/// One picture of the page.
pub(super) struct Picture {
    /// Without folder, with `.svg`.
    pub file: String,
    pub title: String,
    /// What was left out or fixed; may be empty.
    pub note: String,
    pub svg: String,
}

/// What a page shows, and what it does not: a line for each.
pub(super) struct Drawn {
    pub pictures: Vec<Picture>,
    pub left_out: Vec<String>,
}

/// All pictures: one for each variable that varies by more than its error, then waveforms, then force curves.
pub(super) fn all(results: &Results) -> Result<Drawn, ReportError> {
    let (mut pictures, mut undrawn) = (Vec::new(), Vec::new());
    for one in results.variables.iter().filter(|one| !SCALES.contains(&one.name.as_str())) {
        match says_nothing(results, one) {
            Some(line) => undrawn.push(line),
            None => pictures.extend(variable::draw(results, one)?),
        }
    }
    if let Some(waveforms) = &results.waveforms {
        for (row, instance) in waveforms.instances.iter().enumerate().take(MOST_INSTANCES) {
            let title = format!("Waveform of instance {instance}");
            let svg = waveform::draw(waveforms, row, &with_case(results, &title, *instance))?;
            let note = left_out(row, waveforms.instances.len(), "waveforms");
            pictures.push(Picture { file: format!("waveform_{instance}.svg"), title, note, svg });
        }
    }
    let mut instances: Vec<u64> = results.force_curves.iter().map(|curve| curve.instance).collect();
    instances.dedup();
    instances.sort_unstable();
    instances.dedup();
    for (row, instance) in instances.iter().enumerate().take(MOST_INSTANCES) {
        let curves: Vec<&ForceCurve> =
            results.force_curves.iter().filter(|curve| curve.instance == *instance).collect();
        let title = format!("Force curve of instance {instance}");
        let svg = force_curve::draw(&curves, &with_case(results, &title, *instance))?;
        let note = left_out(row, instances.len(), "force curves");
        pictures.push(Picture { file: format!("force_curve_{instance}.svg"), title, note, svg });
    }
    Ok(Drawn { pictures, left_out: undrawn })
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

/// Why a variable of several instances needs no picture: it is nothing within its error everywhere, or the same.
fn says_nothing(results: &Results, variable: &Variable) -> Option<String> {
    if results.status.len() < 2 {
        return None;
    }
    let name = capital(if variable.long_name.is_empty() { &variable.name } else { &variable.long_name });
    let states = states(results, variable);
    let zeros = states.iter().filter(|(_, state)| *state == State::Zero).count();
    let values: Vec<f64> = states.iter().filter(|one| one.1.has_value()).map(|one| one.0).collect();
    let (low, high) = values
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(*value), high.max(*value)));
    match (zeros, values.len()) {
        (0, 0 | 1) => None,
        (zeros, 0) => Some(format!("{name}: 0 within its error in all {zeros} instances that have a value.")),
        (0, count) if high - low <= SAME * low.abs().max(high.abs()) => {
            let value = Unit::fitting(&variable.units, high.abs()).value(high);
            Some(format!("{name}: the same in all {count} instances that have a value, {value}."))
        }
        _ => None,
    }
}

/// Values that differ by less than this share of themselves are the same.
const SAME: f64 = 1e-9;

fn left_out(row: usize, count: usize, what: &str) -> String {
    if row + 1 == MOST_INSTANCES && count > MOST_INSTANCES {
        format!("The other {} {what} are in the results file.", count - MOST_INSTANCES)
    } else {
        String::new()
    }
}

/// A title with the swept values of that instance.
fn with_case(results: &Results, title: &str, instance: u64) -> String {
    let Ok(mut rest) = usize::try_from(instance) else { return title.to_owned() };
    let mut parts = Vec::new();
    for axis in results.axes.iter().rev() {
        let length = axis.values.len().max(1);
        let at = if results.list { rest } else { rest % length };
        if !results.list {
            rest /= length;
        }
        if let Some(value) = axis.values.get(at) {
            parts.push(shown(axis, *value));
        }
    }
    parts.reverse();
    if parts.is_empty() { title.to_owned() } else { format!("{title}: {}", parts.join(", ")) }
}

/// A value of an axis in the unit that fits it; zero, which none fits, in the axis' own.
pub(super) fn shown(axis: &Coordinate, value: f64) -> String {
    let largest = axis.values.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
    Unit::fitting(&axis.units, if value == 0.0 { largest } else { value.abs() }).value(value)
}

/// First letter large.
pub(super) fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

//! Which pictures a results file gets.

use super::ReportError;
use super::curve::{self, Series};
use super::floor::{SCALES, errors};
use super::force_curve;
use super::frame::State;
use super::heatmap::{Heatmap, Panel, brief, label};
use super::quantity::Unit;
use super::waveform;
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
    for variable in results.variables.iter().filter(|one| !SCALES.contains(&one.name.as_str())) {
        match says_nothing(results, variable) {
            Some(line) => undrawn.push(line),
            None => pictures.extend(of_variable(results, variable)?),
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
fn shown(axis: &Coordinate, value: f64) -> String {
    let largest = axis.values.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
    Unit::fitting(&axis.units, if value == 0.0 { largest } else { value.abs() }).value(value)
}

fn of_variable(results: &Results, variable: &Variable) -> Result<Option<Picture>, ReportError> {
    let harmonics = variable.harmonics.unwrap_or(1).max(1);
    let name = if variable.long_name.is_empty() { &variable.name } else { &variable.long_name };
    let states = states(results, variable);
    // A variable's values, one harmonic at a time, with what became of each instance.
    let of_harmonic = |harmonic: usize| -> Vec<(f64, State)> {
        states.iter().skip(harmonic).step_by(harmonics).copied().collect()
    };
    let axis_name = brief(name, &variable.name);
    let all_series = |most: usize| -> Vec<Series> {
        (0..harmonics.min(most))
            .map(|k| Series { name: format!("harmonic {}", k + 1), values: of_harmonic(k) })
            .collect()
    };
    let mut note = String::new();
    let heading = capital(name);
    let units = variable.units.as_str();
    // Axes of a single value say nothing in a picture; the page's tables name them.
    let axes: Vec<&Coordinate> = results.axes.iter().collect();
    let svg = match (results.list, axes.as_slice()) {
        (true, []) | (false, []) if harmonics == 1 && results.status.len() == 1 => return Ok(None),
        (_, []) if harmonics > 1 => {
            let orders = Coordinate {
                name: "harmonic".into(),
                units: "1".into(),
                long_name: "harmonic of the drive frequency".into(),
                values: (1..=harmonics).map(|k| k as f64).collect(),
            };
            let values = states.iter().take(harmonics).copied().collect();
            curve::curves(&heading, units, &axis_name, &orders, &[Series { name: String::new(), values }])?
        }
        (true, parameters) => {
            if harmonics > 1 {
                note = format!("The first of {harmonics} harmonics.");
            }
            let numbers;
            let own: Vec<Coordinate> = if parameters.is_empty() {
                numbers = Coordinate {
                    name: "instance".into(),
                    units: "1".into(),
                    long_name: "instance number".into(),
                    values: (0..results.status.len()).map(|i| i as f64).collect(),
                };
                vec![numbers]
            } else {
                parameters.iter().map(|&axis| axis.clone()).collect()
            };
            let series = Series { name: String::new(), values: of_harmonic(0) };
            curve::scatter(&heading, units, &axis_name, &own, &series)?
        }
        (false, []) => return Ok(None),
        (false, [x]) => {
            if harmonics > 6 {
                note = format!("The first 6 of {harmonics} harmonics.");
            }
            curve::curves(&heading, units, &axis_name, x, &all_series(6))?
        }
        (false, [y, x]) => {
            if harmonics > 6 {
                note = format!("The first 6 of {harmonics} harmonics.");
            }
            let panels: Vec<Panel> = all_series(6)
                .into_iter()
                .map(|one| Panel {
                    caption: if harmonics > 1 { one.name } else { String::new() },
                    values: one.values,
                    lines: Vec::new(),
                })
                .collect();
            let columns = if panels.len() > 2 { 3 } else { panels.len() };
            Heatmap {
                title: heading.clone(),
                units,
                long_name: &axis_name,
                x,
                y,
                columns,
                panels,
                lines: Vec::new(),
            }
            .draw()?
        }
        (false, [slow @ .., y, x]) => {
            let (columns, panels, fixed) = slices(slow, y, x, harmonics, &of_harmonic);
            note = fixed;
            let named: Vec<&str> = slow.iter().take(2).map(|axis| label(axis)).collect();
            let title = format!("{heading}, by {}", named.join(" and "));
            Heatmap { title, units, long_name: &axis_name, x, y, columns, panels, lines: Vec::new() }
                .draw()?
        }
    };
    Ok(Some(Picture { file: format!("{}.svg", file_name(&variable.name)), title: heading, note, svg }))
}

/// Panels over slices of the slowest axis (columns) and of the next one or the harmonics (rows).
fn slices(
    slow: &[&Coordinate],
    y: &Coordinate,
    x: &Coordinate,
    harmonics: usize,
    of_harmonic: &dyn Fn(usize) -> Vec<(f64, State)>,
) -> (usize, Vec<Panel>, String) {
    let plane = x.values.len() * y.values.len();
    let mut notes = Vec::new();
    let chosen: Vec<Vec<usize>> = slow
        .iter()
        .enumerate()
        .map(|(depth, axis)| {
            let most = match depth {
                0 => 4,
                1 if harmonics == 1 => 3,
                _ => 1,
            };
            let picked = spread(axis.values.len(), most);
            if picked.len() < axis.values.len() {
                let values: Vec<String> = picked.iter().map(|&i| shown(axis, axis.values[i])).collect();
                notes.push(format!(
                    "{}: {} of {} values ({}).",
                    capital(label(axis)),
                    picked.len(),
                    axis.values.len(),
                    values.join(", ")
                ));
            }
            picked
        })
        .collect();
    if harmonics > 3 {
        notes.push(format!("The first 3 of {harmonics} harmonics."));
    }
    let columns = chosen[0].len();
    let rows = chosen.get(1).map_or(1, Vec::len);
    let mut panels = Vec::new();
    for harmonic in 0..harmonics.min(3) {
        let values = of_harmonic(harmonic);
        for row in 0..rows {
            for column in 0..columns {
                let mut start = 0;
                let mut captions = Vec::new();
                for (depth, axis) in slow.iter().enumerate() {
                    let pick = match depth {
                        0 => chosen[0][column],
                        1 => chosen[1][row],
                        _ => chosen[depth][0],
                    };
                    start = start * axis.values.len() + pick;
                    if depth < 2 {
                        captions.push(shown(axis, axis.values[pick]));
                    }
                }
                if harmonics > 1 {
                    captions.push(format!("harmonic {}", harmonic + 1));
                }
                let part = values.iter().skip(start * plane).take(plane).copied().collect();
                panels.push(Panel { caption: captions.join(", "), values: part, lines: Vec::new() });
            }
        }
    }
    if notes.is_empty() {
        let names: Vec<&str> = slow.iter().map(|axis| label(axis)).collect();
        notes.push(format!("One picture for each value of: {}.", names.join(", ")));
    }
    (columns, panels, notes.join(" "))
}

/// At most so many of `count` numbers, evenly spread, the first and the last among them; the middle one if
/// only one may be chosen.
fn spread(count: usize, most: usize) -> Vec<usize> {
    match (count, most) {
        (0, _) => Vec::new(),
        (_, 0 | 1) => vec![count / 2],
        _ if count <= most => (0..count).collect(),
        _ => (0..most).map(|i| (i * (count - 1) + (most - 1) / 2) / (most - 1)).collect(),
    }
}

/// First letter large.
pub(super) fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

/// A name safe as that of a file anywhere.
fn file_name(name: &str) -> String {
    let safe = |c: char| if c.is_ascii_alphanumeric() || matches!(c, '_' | '-') { c } else { '_' };
    name.chars().map(safe).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slices_are_spread_from_first_to_last() {
        assert_eq!(spread(32, 4), [0, 10, 21, 31]);
        assert_eq!(spread(3, 4), [0, 1, 2]);
        assert_eq!(spread(5, 1), [2]);
        assert_eq!(spread(1, 1), [0]);
    }
}

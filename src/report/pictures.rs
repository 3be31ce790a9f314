//! Which pictures a results file gets.

use super::ReportError;
use super::band::{self, Band};
use super::floor::{SCALES, errors};
use super::force_curve;
use super::frame::State;
use super::hover::Hover;
use super::quantity::Unit;
use super::view::{View, Wish};
use super::{csv, from_curve, variable, waveform};
use crate::observe::Observable;
use crate::store::{Coordinate, ForceCurve, NO_STATE, Results, Variable};

/// Pictures of single instances at most, of each kind.
const MOST_INSTANCES: usize = 24;

/// What a picture is about, and so where it stands on the page.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// What a user asked for: observables, waveforms, force curves.
    Asked,
    /// How it was computed: estimates, periods, multipliers.
    Computed,
}

impl Kind {
    pub fn of(variable: &Variable) -> Self {
        let computed = variable.error_scale.is_empty() && Observable::from_name(&variable.name).is_none();
        if computed { Self::Computed } else { Self::Asked }
    }
}

/// One picture of the page.
pub(super) struct Picture {
    pub kind: Kind,
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

/// What a page shows, and what it does not: a line for each.
pub(super) struct Drawn {
    pub pictures: Vec<Picture>,
    pub left_out: Vec<String>,
}

/// All pictures: one for each variable that varies by more than its error, then waveforms, then force curves.
pub(super) fn all(results: &Results, wish: &Wish) -> Result<Drawn, ReportError> {
    if !results.list {
        // A wish that cannot be met is told whatever there is to draw.
        View::of(results, wish)?;
    }
    let (mut pictures, mut undrawn) = (Vec::new(), Vec::new());
    for one in results.variables.iter().filter(|one| !SCALES.contains(&one.name.as_str())) {
        match says_nothing(results, one) {
            Some(line) => undrawn.push(line),
            None => {
                pictures.extend(variable::draw(results, one, wish)?);
                pictures.extend(band_of(results, one)?);
            }
        }
    }
    if let Some(waveforms) = &results.waveforms {
        for (row, instance) in waveforms.instances.iter().enumerate().take(MOST_INSTANCES) {
            let title = format!("Waveform of instance {instance}");
            let svg = waveform::draw(waveforms, row, &with_case(results, &title, *instance))?;
            let note = left_out(row, waveforms.instances.len(), "waveforms");
            let name = format!("waveform_{instance}");
            let csv = Some(csv::of_waveform(waveforms, row));
            let hover = Hover::default();
            pictures.push(Picture { kind: Kind::Asked, name, title, note, svg, hover, csv });
        }
    }
    let mut instances: Vec<u64> = results.force_curves.iter().map(|curve| curve.instance).collect();
    instances.dedup();
    instances.sort_unstable();
    instances.dedup();
    for (row, instance) in instances.iter().enumerate().take(MOST_INSTANCES) {
        let told = from_curve::forces(results, *instance);
        let laws = results.force_curves.iter().filter(|curve| curve.instance == *instance);
        let curves: Vec<&ForceCurve> = laws.chain(&told).collect();
        let title = format!("Force curve of instance {instance}");
        let svg = force_curve::draw(&curves, &with_case(results, &title, *instance))?;
        let note = left_out(row, instances.len(), "force curves");
        let name = format!("force_curve_{instance}");
        let csv = Some(csv::of_force_curves(&curves));
        pictures.push(Picture { kind: Kind::Asked, name, title, note, svg, hover: Hover::default(), csv });
    }
    Ok(Drawn { pictures, left_out: undrawn })
}

/// What an observable is over many curves.
fn band_of(results: &Results, variable: &Variable) -> Result<Option<Picture>, ReportError> {
    let kind = Kind::of(variable);
    if kind == Kind::Computed {
        return Ok(None);
    }
    let name = if variable.long_name.is_empty() { &variable.name } else { &variable.long_name };
    let title = format!("{}, median and band of curves", capital(name));
    Ok(band::draw(results, variable, &title)?.map(|Band { svg, note, csv }| Picture {
        kind,
        name: format!("{}_band", variable.name),
        title,
        note,
        svg,
        hover: Hover::default(),
        csv: Some(csv),
    }))
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
    let Ok(instance) = usize::try_from(instance) else { return title.to_owned() };
    let parts = case(results, instance);
    if parts.is_empty() { title.to_owned() } else { format!("{title}: {}", parts.join(", ")) }
}

/// The value of each axis at an instance.
pub(super) fn case(results: &Results, instance: usize) -> Vec<String> {
    let mut rest = instance;
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
    parts
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

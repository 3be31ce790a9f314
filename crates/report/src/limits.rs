//! What is left within a reader's limits: instances outside them stand back in every picture.

use super::ReportError;
use super::frame::{EXCLUDED, State};
use super::labels::{names, short, shown, span};
use super::picture::{PictureKind, places, second_states, states};
use super::quantity_text::DisplayUnit;
use super::view_request::{ViewRequest, typed, unknown};
use super::{Best, Kept};
use crate::observe::Observable;
use crate::store::{Coordinate, NO_STATE, Results, Variable};

/// A limit of one observable.
struct Limit<'a> {
    variable: &'a Variable,
    value: f64,
    below: bool,
}

impl Limit<'_> {
    /// `force_max below 3 nN`.
    fn words(&self) -> String {
        let way = if self.below { "below" } else { "above" };
        let largest = if self.value == 0.0 { 1.0 } else { self.value.abs() };
        format!(
            "{} {way} {}",
            self.variable.name,
            DisplayUnit::fitting(&self.variable.units, largest).value(self.value)
        )
    }

    fn holds(&self, value: Option<f64>) -> bool {
        value.is_some_and(|value| if self.below { value < self.value } else { value > self.value })
    }
}

/// The limits that are wished for.
///
/// # Errors
/// A name that no observable of the file has, and a value without its unit.
fn limits<'a>(results: &'a Results, wish: &ViewRequest) -> Result<Vec<Limit<'a>>, ReportError> {
    let all = || results.variables.iter().filter(|one| one.harmonics.is_none());
    let limit = |below: bool, name: &str, text: &str| {
        let option = if below { "--below" } else { "--above" };
        let names = || all().map(|one| one.name.clone()).collect::<Vec<_>>();
        let found = all().find(|one| one.name == name);
        let variable = found.ok_or_else(|| unknown(option, name, &names()))?;
        let value = typed(text, &variable.units).filter(|value| value.is_finite()).ok_or_else(|| {
            let example = match variable.units.as_str() {
                "1" | "" => "0.5".to_owned(),
                "degree" => "90".to_owned(),
                units => DisplayUnit::fitting(units, 3e-9).value(3e-9).replace(' ', ""),
            };
            let expected = format!("a value with its unit, such as {name}={example}");
            ReportError::wish(option, &format!("{name}={text}"), &expected)
        })?;
        Ok(Limit { variable, value, below })
    };
    let below = wish.below.iter().map(|(name, text)| limit(true, name, text));
    below.chain(wish.above.iter().map(|(name, text)| limit(false, name, text))).collect()
}

/// A value that counts.
fn counted((value, state): &(f64, State)) -> Option<f64> {
    state.counted(*value)
}

/// The results with the instances outside the limits marked as that, and what is left of those that are looked at; none
/// without limits.
///
/// # Errors
/// As told by [`limits`].
pub(super) fn applied(mut results: Results, wish: &ViewRequest) -> Result<(Results, bool), ReportError> {
    let limits = limits(&results, wish)?;
    if limits.is_empty() {
        return Ok((results, false));
    }
    let count = results.status.len();
    let outside = |second: bool| -> Vec<bool> {
        let of = |variable| match second {
            true => second_states(&results, variable),
            false => Some(states(&results, variable)),
        };
        let tables: Vec<_> = limits.iter().map(|limit| (limit, of(limit.variable))).collect();
        let holds = |i: usize| {
            tables.iter().all(|(limit, states)| limit.holds(states.as_ref().and_then(|all| counted(&all[i]))))
        };
        (0..count).map(|i| !holds(i)).collect()
    };
    let (first, second) = (outside(false), outside(true));
    let mark = |status: &mut Vec<u8>, outside: &[bool]| {
        let known = |code: u8| !matches!(State::of(code, 0.0), State::Failed(_)) && code != NO_STATE;
        for (code, _) in status.iter_mut().zip(outside).filter(|(code, outside)| **outside && known(**code)) {
            *code = EXCLUDED;
        }
    };
    mark(&mut results.status, &first);
    if let Some(branch) = &mut results.other_branch {
        mark(&mut branch.status, &second);
    }
    Ok((results, true))
}

/// What is left of the instances that are looked at, in numbers and in a sentence. The results are those that
/// [`applied`] has gone through.
///
/// # Errors
/// As told by [`limits`].
pub(super) fn kept(results: &Results, wish: &ViewRequest) -> Result<(Kept, String), ReportError> {
    let limits = limits(results, wish)?;
    let words: Vec<String> = limits.iter().map(Limit::words).collect();
    let words = words.join(" and ");
    let of = results.status.iter().filter(|code| **code != NO_STATE).count();
    let left: Vec<usize> = (0..results.status.len())
        .filter(|i| results.status[*i] != NO_STATE && State::of(results.status[*i], 0.0).has_value())
        .collect();
    let mut kept = Kept { instances: left.len(), of, best: None };
    if left.is_empty() {
        return Ok((kept, format!("None of {of} instances has {words}.")));
    }
    let count = match left.len() {
        1 => format!("1 of {of} instances is left"),
        left => format!("{left} of {of} instances are left"),
    };
    // Where all that is asked for lies above something, the price is what is smallest.
    let smallest = limits.iter().all(|limit| !limit.below);
    let is_limit = |one: &Variable| limits.iter().any(|limit| limit.variable.name == one.name);
    let asked = |one: &&Variable| {
        Observable::from_name(&one.name).is_some()
            && one.harmonics.is_none()
            && PictureKind::of(one) == PictureKind::Asked
    };
    let free = results.variables.iter().filter(asked).find(|one| !is_limit(one));
    let first = free.or(limits.first().map(|limit| limit.variable));
    let Some((variable, (instance, value))) =
        first.and_then(|one| Some((one, extreme(results, one, &left, smallest)?)))
    else {
        return Ok((kept, format!("{count} with {words}.")));
    };
    kept.best = Some(Best { observable: variable.name.clone(), instance, value });
    let (_, name) = names(variable);
    let said = DisplayUnit::fitting(&variable.units, value.abs()).short(value);
    let what = match (smallest, name.strip_prefix("largest ")) {
        (false, rest) => format!("Largest {}", rest.unwrap_or(&name)),
        (true, None) => format!("Smallest {name}"),
        (true, Some(_)) => format!("Lowest {name}"),
    };
    let text =
        format!("{what} with {words}: {said}{}; {count}{}.", at(results, instance), over(results, &left));
    Ok((kept, text))
}

/// The instance with the largest or the smallest value among some.
fn extreme(results: &Results, variable: &Variable, left: &[usize], smallest: bool) -> Option<(usize, f64)> {
    let states = states(results, variable);
    let values = left.iter().filter_map(|i| Some((*i, counted(&states[*i])?)));
    let by = |a: &(usize, f64), b: &(usize, f64)| a.1.total_cmp(&b.1);
    if smallest { values.min_by(by) } else { values.max_by(by) }
}

/// Where an instance stands: ` at set-point 0.8 (material PS)`.
fn at(results: &Results, instance: usize) -> String {
    let all = places(results, instance);
    let told = |named: bool| {
        let several = all.iter().filter(|(axis, _)| axis.values.len() > 1 && axis.words.is_empty() != named);
        let one =
            |(axis, at): &(&Coordinate, usize)| format!("{} {}", short(axis), shown(axis, axis.values[*at]));
        several.map(one).collect::<Vec<_>>().join(", ")
    };
    let (numbers, names) = (told(false), told(true));
    match (numbers.is_empty(), names.is_empty()) {
        (true, true) => format!(" at instance {instance}"),
        (false, true) => format!(" at {numbers}"),
        (true, false) => format!(" at {names}"),
        (false, false) => format!(" at {numbers} ({names})"),
    }
}

/// Over what the instances that are left lie, of the axes of which some is gone: `, at tip radius 5 nm to 10 nm`.
fn over(results: &Results, left: &[usize]) -> String {
    let mut parts = Vec::new();
    if results.list {
        return String::new();
    }
    for (number, axis) in results.axes.iter().enumerate().filter(|one| one.1.values.len() > 1) {
        let mut there = vec![false; axis.values.len()];
        left.iter().for_each(|i| there[places(results, *i)[number].1] = true);
        if there.iter().all(|there| *there) {
            continue;
        }
        let kept = || (0..there.len()).filter(|at| there[*at]);
        let name = short(axis);
        parts.push(match axis.words.is_empty() {
            true => span(kept().map(|at| axis.values[at]), &axis.units)
                .map_or(String::new(), |span| format!("{name} {span}")),
            false => kept().map(|at| axis.words[at].clone()).collect::<Vec<_>>().join(", "),
        });
    }
    if parts.is_empty() { String::new() } else { format!(", at {}", parts.join(", ")) }
}

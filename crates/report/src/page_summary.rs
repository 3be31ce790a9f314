//! The first sentences of a page: what came out, and how good it is.

use super::SAMPLES;
use super::branch_states;
use super::error_floor::accuracy;
use super::frame::{EXCLUDED, State, status_word};
use super::labels::{capital, ends, names, short, shown, span};
use super::picture::{PictureKind, places, second_states, states};
use super::quantity_text::number;
use crate::observe::Status;
use crate::store::{Attribute, NO_STATE, Results, Variable};

/// Observables that are told at most.
const MOST: usize = 3;

/// These sentences, as far as there is something to say.
/// Of those that are shown: `fixed` are the axes that stand at one value. `limits` is the sentence on what is left.
pub(super) fn all(results: &Results, fixed: &[(usize, usize)], limits: Option<String>) -> Vec<String> {
    let said = [
        incomplete(results),
        limits,
        ranges(results, fixed),
        jumps(results),
        branches(results),
        second(results),
        Some(quality(results)),
    ];
    said.into_iter().flatten().collect()
}

/// The results with no state where an axis of `fixed` stands at another value.
pub(super) fn of_shown(results: &Results, fixed: &[(usize, usize)]) -> Results {
    let mut results = results.clone();
    for i in 0..results.status.len() {
        let places = places(&results, i);
        if fixed.iter().any(|(axis, at)| places[*axis].1 != *at) {
            results.status[i] = NO_STATE;
        }
    }
    results
}

/// How much of a run that was stopped there is.
fn incomplete(results: &Results) -> Option<String> {
    let value = results.attributes.iter().find(|(name, _)| name == "complete").map(|one| &one.1)?;
    let Attribute::Number(0.0) = value else { return None };
    let done = results.status.iter().filter(|code| **code != Status::NotRun as u8).count();
    let lacks = results.text("missing").map_or(String::new(), |words| {
        let phases: Vec<&str> = words.split(' ').collect();
        format!("; it lacks {}", phases.join(", "))
    });
    Some(format!(
        "Incomplete: {} of {} instances are done{lacks}.",
        grouped(done),
        grouped(results.status.len())
    ))
}

/// A count with commas: `20,000`.
fn grouped(count: usize) -> String {
    let digits = count.to_string();
    let commas = |(i, digit): (usize, char)| {
        let comma = i > 0 && (digits.len() - i).is_multiple_of(3);
        comma.then_some(',').into_iter().chain([digit]).collect::<Vec<char>>()
    };
    digits.chars().enumerate().flat_map(commas).collect()
}

/// How many curves jump on each way, and from where to where.
fn jumps(results: &Results) -> Option<String> {
    let flags = results.flags.iter().find(|flags| flags.name == "jump")?;
    let (x, others) = results.axes.split_last()?;
    let points = x.values.len();
    let ways = others.last().map(|axis| &axis.words).filter(|words| !words.is_empty());
    let way = |instance: usize| ways.map_or(0, |words| (instance / points) % words.len());
    let at = |way_of: usize| {
        let shown = |i: usize| !matches!(results.status[i], NO_STATE | EXCLUDED);
        let here = move |(i, code): (usize, &u8)| (*code == 1 && way(i) == way_of && shown(i)).then_some(i);
        flags.data.iter().enumerate().filter_map(here).map(|i| x.values[i % points]).collect::<Vec<f64>>()
    };
    let told = |number: usize| {
        let places = at(number);
        let word = ways.map_or(String::new(), |words| match words[number].as_str() {
            way @ ("forward" | "backward") => format!(" {way}"),
            way => format!(" on {way}"),
        });
        let (first, last) = ends(places.iter().copied());
        let place = match places.len() {
            0 => return None,
            _ if first == last => shown(x, first),
            _ => format!("{} to {}", shown(x, first), shown(x, last)),
        };
        Some(format!("{}{word} at {} {place}", places.len(), short(x)))
    };
    let told: Vec<String> = (0..ways.map_or(1, Vec::len)).filter_map(told).collect();
    Some(match told.as_slice() {
        [] => "No curve jumps.".into(),
        told => format!("Jumps: {}.", told.join("; ")),
    })
}

/// How many states are on each branch, where there are several.
fn branches(results: &Results) -> Option<String> {
    let counts = branch_states::counts(results)?;
    let told: Vec<String> = counts
        .iter()
        .skip(1)
        .filter(|one| one.1 > 0)
        .map(|(word, count)| format!("{count} {word}"))
        .collect();
    (told.len() > 1).then(|| {
        format!(
            "The states are on different branches: {}; --branch {} shows one of them.",
            told.join(", "),
            counts.last().map_or("", |one| one.0)
        )
    })
}

/// How many instances have a second state, and from where to where the first observable goes there.
fn second(results: &Results) -> Option<String> {
    let status = &results.other_branch.as_ref()?.status;
    let count = status.iter().filter(|code| !matches!(**code, NO_STATE | EXCLUDED)).count();
    let asked = |one: &&Variable| PictureKind::of(one) == PictureKind::Asked && one.harmonics.is_none();
    let values = |one: &Variable| range_of(one, &second_states(results, one)?, status);
    let first = results.variables.iter().filter(asked).find_map(values);
    let has = if count == 1 { "instance has" } else { "instances have" };
    (count > 0).then(|| {
        format!(
            "{} {has} a second state{}.",
            grouped(count),
            first.map_or(String::new(), |told| format!(": {told}"))
        )
    })
}

/// From where to where the first observables go, and over what.
fn ranges(results: &Results, fixed: &[(usize, usize)]) -> Option<String> {
    if results.status.len() < 2 {
        return None;
    }
    let asked = results
        .variables
        .iter()
        .filter(|one| PictureKind::of(one) == PictureKind::Asked && one.harmonics.is_none());
    let told: Vec<String> = asked.filter_map(|variable| range(results, variable)).take(MOST).collect();
    if told.is_empty() {
        return None;
    }
    let over = |values: &[f64], units: &str| span(values.iter().copied(), units);
    let axes: Vec<String> = results
        .axes
        .iter()
        .enumerate()
        .filter(|(number, axis)| axis.words.is_empty() && fixed.iter().all(|one| one.0 != *number))
        .filter(|(_, axis)| axis.scene_path != SAMPLES)
        .filter_map(|(_, axis)| Some(format!("{} {}", short(axis), over(&axis.values, &axis.units)?)))
        .collect();
    let at = |(axis, at): &(usize, usize)| {
        let axis = &results.axes[*axis];
        format!("{} {}", short(axis), shown(axis, axis.values[*at]))
    };
    let at: Vec<String> = fixed.iter().map(at).collect();
    let at = if at.is_empty() { String::new() } else { format!("at {}, ", at.join(", ")) };
    let text = told.join("; ");
    Some(match axes.as_slice() {
        [] => format!("{}.", capital(&format!("{at}{text}"))),
        axes => capital(&format!("{at}over {}: {text}.", axes.join(", "))),
    })
}

fn range(results: &Results, variable: &Variable) -> Option<String> {
    range_of(variable, &states(results, variable), &results.status)
}

fn range_of(variable: &Variable, states: &[(f64, State)], status: &[u8]) -> Option<String> {
    let (_, name) = names(variable);
    // What is doubtful is no finding.
    let value = |((value, state), status): (&(f64, State), &u8)| match state {
        State::Zero if *status == Status::Ok as u8 => Some(0.0),
        State::Good => Some(*value),
        _ => None,
    };
    let values = states.iter().zip(status).filter_map(value);
    Some(format!("{name} {}", span(values, &variable.units)?))
}

/// How many are ok, how large their errors are, and how many carry a warning.
fn quality(results: &Results) -> String {
    let count = results.status.iter().filter(|code| !matches!(**code, NO_STATE | EXCLUDED)).count();
    // Instances beyond a reader's limits have been told already.
    let within = if results.status.contains(&EXCLUDED) { " within the limits" } else { "" };
    if count == 0 {
        return format!("No instance is {}.", if within.is_empty() { "shown" } else { within.trim_start() });
    }
    let mut counts = [0usize; 256];
    results.status.iter().for_each(|code| counts[usize::from(*code)] += 1);
    let ok = counts[usize::from(Status::Ok as u8)];
    let others: Vec<String> = (0u8..=u8::MAX)
        .zip(counts)
        .filter(|(code, count)| *count > 0 && ![Status::Ok as u8, NO_STATE, EXCLUDED].contains(code))
        .map(|(code, count)| format!("{count} {}", status_word(code)))
        .collect();
    let mut text = match (others.is_empty(), count) {
        (true, 1) => format!("The instance{within} is ok"),
        (true, _) => format!("All {count} instances{within} are ok"),
        _ => format!("{ok} of {count} instances{within} are ok ({})", others.join(", ")),
    };
    text += &errors(results);
    // Words by bits are warnings.
    let warned = |i: &usize| {
        !matches!(results.status[*i], NO_STATE | EXCLUDED)
            && results.flags.iter().any(|flags| flags.bits && flags.data.get(*i) != Some(&0))
    };
    match (0..results.status.len()).filter(warned).count() {
        0 => text + ".",
        warned => format!("{text}; {warned} of {count} carry a warning of the contact law."),
    }
}

/// The largest estimate and what the audit found, of those that are ok.
fn errors(results: &Results) -> String {
    let estimates = results.variables.iter().find(|one| one.name == "error_estimate");
    let all = estimates.map_or(&[][..], |one| one.data.as_slice()).iter().zip(&results.status);
    let ok = all.filter(|(estimate, code)| **code == Status::Ok as u8 && estimate.is_finite());
    let largest = ok.map(|(estimate, _)| *estimate).fold(f64::NAN, f64::max);
    let asked =
        accuracy(results).map_or(String::new(), |asked| format!(" where {} was asked for", number(asked, 2)));
    match largest.is_nan() {
        true => ", with errors that nobody estimated".to_owned(),
        false => format!(", with errors of {} at the most by estimate{asked}", number(largest, 2)),
    }
}

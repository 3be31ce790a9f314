//! The states of one branch, out of the first and the second ones.

use super::ReportError;
use super::frame::EXCLUDED;
use crate::store::{BranchTable, Flags, NO_STATE, Results, Variable, Waveforms};

const FLAG: &str = "branch";

/// What each state has of its own beside its observables; all else is the instance's.
const OF_STATES: [&str; 2] = ["error_estimate", "multiplier"];

/// How many of the instances that are shown are on each branch, in the order of the flag's words; none where the file does not tell.
pub(super) fn counts(results: &Results) -> Option<Vec<(&str, usize)>> {
    let flags = find(&results.flags)?;
    let shown = |(one, status): &(&u8, &u8)| (!matches!(**status, NO_STATE | EXCLUDED)).then_some(**one);
    let known: Vec<u8> = flags.data.iter().zip(&results.status).filter_map(|both| shown(&both)).collect();
    let count = |code| known.iter().filter(|one| **one == code).count();
    Some((0u8..=u8::MAX).zip(&flags.meanings).map(|(code, word)| (word.as_str(), count(code))).collect())
}

/// The results with nothing but the states of this branch: an instance whose first state is on another has its second one,
/// or none.
///
/// # Errors
/// Results without branches, and a word that is none of theirs.
pub(super) fn chosen(results: Results, wanted: &str) -> Result<Results, ReportError> {
    let wish = |expected: String| ReportError::wish("--branch", wanted, &expected);
    let known = find(&results.flags)
        .ok_or_else(|| wish("results of a search: steady = \"search\" in the scene's [run]".into()))?;
    let code = match known.meanings.iter().position(|word| word == wanted) {
        Some(code) if code > 0 => code as u8,
        _ => return Err(wish(known.meanings.get(1..).unwrap_or_default().join(" or "))),
    };
    let Results { mut variables, mut flags, mut status, mut steps_per_period, other_branch, .. } = results;
    let first = codes(&flags);
    let second = other_branch.as_ref().map(|branch| codes(&branch.flags)).unwrap_or_default();
    let count = status.len();
    let of_states: Vec<bool> = variables
        .iter()
        .map(|one| !one.error_scale.is_empty() || OF_STATES.contains(&one.name.as_str()))
        .collect();
    for i in (0..count).filter(|i| first.get(*i) != Some(&code)) {
        let other = other_branch.as_ref().filter(|_| second.get(i) == Some(&code));
        status[i] = other.map_or(NO_STATE, |branch| branch.status[i]);
        steps_per_period[i] = other.map_or(0, |branch| branch.steps_per_period[i]);
        for (variable, _) in variables.iter_mut().zip(&of_states).filter(|(_, of_state)| **of_state) {
            take(variable, other, i);
        }
        let branch = flags.iter_mut().find(|one| one.name == FLAG).and_then(|one| one.data.get_mut(i));
        if let Some(branch) = branch {
            *branch = if other.is_some() { code } else { 0 };
        }
    }
    // They were recorded of the first states.
    let on_it = |instance: u64| usize::try_from(instance).is_ok_and(|i| first.get(i) == Some(&code));
    let waveforms = results.waveforms.map(|waveforms| of_some(&waveforms, on_it));
    let title = format!("{}, {wanted} branch", results.title);
    Ok(Results {
        waveforms,
        title,
        variables,
        flags,
        status,
        steps_per_period,
        other_branch: None,
        ..results
    })
}

/// The second state's values of an instance; NaN where it has none.
fn take(variable: &mut Variable, other: Option<&BranchTable>, instance: usize) {
    let width = variable.harmonics.unwrap_or(1);
    let row = instance * width..(instance + 1) * width;
    let second = other.and_then(|branch| branch.variables.iter().find(|one| one.name == variable.name));
    match (second.and_then(|one| one.data.get(row.clone())), variable.data.get_mut(row)) {
        (Some(values), Some(place)) => place.copy_from_slice(values),
        (None, Some(place)) => place.fill(f64::NAN),
        _ => {}
    }
}

/// The waveforms of some instances.
fn of_some(all: &Waveforms, kept: impl Fn(u64) -> bool) -> Waveforms {
    let rows: Vec<usize> = (0..all.instances.len()).filter(|row| kept(all.instances[*row])).collect();
    let some = |table: &[Vec<f64>]| match table.len() == all.instances.len() {
        true => rows.iter().map(|row| table[*row].clone()).collect(),
        // A time that all of them share.
        false => table.to_vec(),
    };
    Waveforms {
        instances: rows.iter().map(|row| all.instances[*row]).collect(),
        time: some(&all.time),
        tip_travel: some(&all.tip_travel),
        actuator_top: some(&all.actuator_top),
        indentation: some(&all.indentation),
        force: some(&all.force),
    }
}

/// Words for branches, and the branch of each state and of each second one; empty where the file does not tell.
pub(super) fn of_states(results: &Results) -> (Vec<String>, [Vec<u8>; 2]) {
    let words = find(&results.flags).map_or_else(Vec::new, |one| one.meanings.clone());
    let second = results.other_branch.as_ref().map_or_else(Vec::new, |branch| codes(&branch.flags));
    (words, [codes(&results.flags), second])
}

fn find(flags: &[Flags]) -> Option<&Flags> {
    flags.iter().find(|one| one.name == FLAG)
}

fn codes(flags: &[Flags]) -> Vec<u8> {
    find(flags).map_or_else(Vec::new, |one| one.data.clone())
}

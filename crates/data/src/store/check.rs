//! Refuses results whose parts do not fit together, before anything is laid out.

use super::{
    AuditTable, Branch, ERROR, Flags, ForceCurve, OBSERVABLE, RESERVED, Results, StoreError, Variable,
    Waveforms,
};
use std::collections::HashSet;

/// `Err` names the first misfit.
pub(super) fn check(results: &Results) -> Result<(), StoreError> {
    let count = results.status.len();
    check_count(results)?;
    let mut names = HashSet::from(RESERVED);
    check_axes(results, &mut names)?;
    check_variables(&results.variables, count, &mut names)?;
    check_flags(&results.flags, count, &mut names)?;
    if let Some(branch) = &results.other_branch {
        check_branch(branch, results)?;
    }
    results.audit.iter().try_for_each(check_audit)?;
    let mut keys = HashSet::new();
    let texts = results.provenance.iter().map(|(name, _)| name);
    for name in results.attributes.iter().map(|(name, _)| name).chain(texts) {
        check_name(name, &mut keys)?;
    }
    if let Some(waveforms) = &results.waveforms {
        check_waveforms(waveforms)?;
    }
    results.force_curves.iter().try_for_each(check_force_curve)
}

fn refuse(what: String) -> Result<(), StoreError> {
    Err(StoreError::inconsistent(what))
}

/// There must be instances, as many as the axes make.
fn check_count(results: &Results) -> Result<(), StoreError> {
    let count = results.status.len();
    if count == 0 {
        return refuse("there is no instance".into());
    }
    let expected = match (results.list, results.axes.as_slice()) {
        (true, _) => count,
        (false, axes) => axes.iter().map(|axis| axis.values.len()).product(),
    };
    if count != expected {
        return refuse(format!("the axes make {expected} instances, but there are {count} status codes"));
    }
    if results.steps_per_period.len() != count {
        return refuse(format!("{} steps_per_period for {count} instances", results.steps_per_period.len()));
    }
    Ok(())
}

fn check_axes<'a>(results: &'a Results, names: &mut HashSet<&'a str>) -> Result<(), StoreError> {
    let count = results.status.len();
    for axis in &results.axes {
        if results.list && axis.values.len() != count {
            return refuse(format!("{} has {} values for {count} instances", axis.name, axis.values.len()));
        }
        check_name(&axis.name, names)?;
        for column in &axis.columns {
            if column.values.len() != axis.values.len() {
                return refuse(format!("{} has not as many values as {}", column.name, axis.name));
            }
            check_name(&column.name, names)?;
        }
    }
    Ok(())
}

/// The other branch has its own variables over the same axes.
fn check_branch(branch: &Branch, results: &Results) -> Result<(), StoreError> {
    let count = results.status.len();
    let mut names: HashSet<&str> = results.axes.iter().map(|axis| axis.name.as_str()).collect();
    names.extend(RESERVED);
    check_variables(&branch.variables, count, &mut names)?;
    check_flags(&branch.flags, count, &mut names)?;
    let lengths = [branch.status.len(), branch.steps_per_period.len()];
    if lengths != [count; 2] {
        return refuse(format!("other_branch has {lengths:?} status codes and steps for {count} instances"));
    }
    Ok(())
}

fn check_audit(table: &AuditTable) -> Result<(), StoreError> {
    let count = table.instances.len();
    let mut names = HashSet::from(["instance", "harmonic", OBSERVABLE, ERROR]);
    check_variables(&table.variables, count, &mut names)?;
    check_flags(&table.flags, count, &mut names)?;
    let (errors, observables) = (table.errors.len(), table.observables.len());
    match errors == count * observables {
        true => Ok(()),
        false => {
            refuse(format!("audit has {errors} errors of {count} instances and {observables} observables"))
        }
    }
}

fn check_force_curve(curve: &ForceCurve) -> Result<(), StoreError> {
    let lengths = [curve.indentation.len(), curve.force.len(), curve.contact_radius.len()];
    if lengths != [lengths[0]; 3] || u32::try_from(lengths[0]).is_err() {
        return refuse(format!("a force curve of instance {} has lists of {lengths:?}", curve.instance));
    }
    for word in [&curve.law, &curve.branch] {
        if word.is_empty() || word.contains(|c: char| c.is_whitespace() || c == '\0') {
            return refuse(format!("{word:?} is not one word, as a force curve's law and branch must be"));
        }
    }
    Ok(())
}

fn check_variables<'a>(
    variables: &'a [Variable],
    count: usize,
    names: &mut HashSet<&'a str>,
) -> Result<(), StoreError> {
    let mut shared = None;
    for variable in variables {
        check_name(&variable.name, names)?;
        let per_instance = variable.harmonics.unwrap_or(1);
        if variable.data.len() != count * per_instance || per_instance == 0 {
            let (name, found) = (&variable.name, variable.data.len());
            return Err(StoreError::inconsistent(format!(
                "{name} has {found} values for {count} instances with {per_instance} each"
            )));
        }
        if variable.harmonics.is_some() && *shared.get_or_insert(per_instance) != per_instance {
            return Err(StoreError::inconsistent("two variables have different numbers of harmonics"));
        }
    }
    Ok(())
}

fn check_flags<'a>(all: &'a [Flags], count: usize, names: &mut HashSet<&'a str>) -> Result<(), StoreError> {
    for flags in all {
        check_name(&flags.name, names)?;
        let bad = |word: &String| word.is_empty() || word.contains(char::is_whitespace);
        if flags.data.len() != count || flags.meanings.len() > 8 || flags.meanings.iter().any(bad) {
            return Err(StoreError::inconsistent(format!(
                "{} is no list of {count} codes for up to 8 single words",
                flags.name
            )));
        }
    }
    Ok(())
}

fn check_name<'a>(name: &'a str, names: &mut HashSet<&'a str>) -> Result<(), StoreError> {
    if name.is_empty() || name == "." || name.contains(|c: char| c == '/' || c.is_whitespace() || c == '\0') {
        return Err(StoreError::inconsistent(format!("{name:?} cannot be a name in a results file")));
    }
    if !names.insert(name) {
        return Err(StoreError::inconsistent(format!("two things are called {name}")));
    }
    Ok(())
}

fn check_waveforms(waveforms: &Waveforms) -> Result<(), StoreError> {
    let Waveforms { instances, time, tip_travel, actuator_top, indentation, force } = waveforms;
    if instances.is_empty() {
        return Ok(());
    }
    let length = time.first().map_or(0, Vec::len);
    let rows = [tip_travel, actuator_top, indentation, force];
    let whole = length > 0
        && (time.len() == 1 || time.len() == instances.len())
        && rows.iter().all(|rows| rows.len() == instances.len())
        && rows.iter().copied().flatten().chain(time).all(|row| row.len() == length);
    if whole {
        return Ok(());
    }
    Err(StoreError::inconsistent(format!(
        "the waveforms of {} instances have rows of unequal number or length",
        instances.len()
    )))
}

//! Refuses results whose parts do not fit together, before anything is laid out.

use super::{
    AuditTable, BranchTable, ERROR, Flags, ForceCurve, OBSERVABLE, Results, Spectra, StateSet, StoreError,
    Variable, Waveforms, reserved,
};
use std::collections::HashSet;

/// The same where all numbers lie in memory: they are as many as they have to be.
pub(super) fn check_all(results: &Results) -> Result<(), StoreError> {
    let count = results.status.len();
    check(results, count)?;
    let all = [StateSet::First, StateSet::Second].into_iter().filter_map(|of| results.states(of));
    for (variables, status, steps, flags) in all {
        for one in variables {
            check_numbers(&one.name, one.data.len(), (count, one.harmonics.unwrap_or(1)))?;
        }
        flags.iter().try_for_each(|one| check_numbers(&one.name, one.data.len(), (count, 1)))?;
        check_numbers("status", status.len(), (count, 1))?;
        check_numbers("steps_per_period", steps.len(), (count, 1))?;
    }
    Ok(())
}

/// `Err` names the first misfit. Numbers are as many as they have to be where they are of `count` instances.
pub(super) fn check(results: &Results, count: usize) -> Result<(), StoreError> {
    check_count(results, count)?;
    let mut names = reserved().collect::<HashSet<&str>>();
    check_axes(results, count, &mut names)?;
    check_variables(&results.variables, None, &mut names)?;
    check_flags(&results.flags, &mut names)?;
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
    results.spectra.iter().try_for_each(check_spectra)?;
    results.force_curves.iter().try_for_each(check_force_curve)
}

/// Refuses what does not hold, in words.
fn require(holds: bool, what: impl FnOnce() -> String) -> Result<(), StoreError> {
    if holds { Ok(()) } else { Err(StoreError::inconsistent(what())) }
}

/// There must be instances, as many as the axes make.
fn check_count(results: &Results, count: usize) -> Result<(), StoreError> {
    require(count > 0, || "there is no instance".into())?;
    let expected = match (results.list, results.axes.as_slice()) {
        (true, _) => count,
        (false, axes) => axes.iter().map(|axis| axis.values.len()).product(),
    };
    require(count == expected, || {
        format!("the axes make {expected} instances, but there are {count} status codes")
    })
}

/// Numbers over the instances, `width` of them each, must be as many as these.
pub(super) fn check_numbers(
    name: &str,
    found: usize,
    (count, width): (usize, usize),
) -> Result<(), StoreError> {
    require(found == count * width, || {
        format!("{name} has {found} values for {count} instances with {width} each")
    })
}

fn check_axes<'a>(
    results: &'a Results,
    count: usize,
    names: &mut HashSet<&'a str>,
) -> Result<(), StoreError> {
    for axis in &results.axes {
        let found = axis.values.len();
        require(!results.list || found == count, || {
            format!("{} has {found} values for {count} instances", axis.name)
        })?;
        check_name(&axis.name, names)?;
        for column in &axis.columns {
            require(column.values.len() == found, || {
                format!("{} has not as many values as {}", column.name, axis.name)
            })?;
            check_name(&column.name, names)?;
        }
    }
    Ok(())
}

/// The other branch has its own variables over the same axes.
fn check_branch(branch: &BranchTable, results: &Results) -> Result<(), StoreError> {
    let mut names: HashSet<&str> = results.axes.iter().map(|axis| axis.name.as_str()).collect();
    names.extend(reserved());
    check_variables(&branch.variables, None, &mut names)?;
    check_flags(&branch.flags, &mut names)
}

fn check_audit(table: &AuditTable) -> Result<(), StoreError> {
    let count = table.instances.len();
    let mut names = HashSet::from(["instance", "harmonic", OBSERVABLE, ERROR]);
    check_variables(&table.variables, Some(count), &mut names)?;
    check_flags(&table.flags, &mut names)?;
    table.flags.iter().try_for_each(|flags| check_numbers(&flags.name, flags.data.len(), (count, 1)))?;
    let (errors, observables) = (table.errors.len(), table.observables.len());
    require(errors == count * observables, || {
        format!("audit has {errors} errors of {count} instances and {observables} observables")
    })
}

fn check_force_curve(curve: &ForceCurve) -> Result<(), StoreError> {
    let lengths = [curve.indentation.len(), curve.force.len(), curve.contact_radius.len()];
    require(lengths == [lengths[0]; 3] && u32::try_from(lengths[0]).is_ok(), || {
        format!("a force curve of instance {} has lists of {lengths:?}", curve.instance)
    })?;
    [&curve.law, &curve.branch].into_iter().try_for_each(|word| {
        require(!word.is_empty() && !word.contains(|c: char| c.is_whitespace() || c == '\0'), || {
            format!("{word:?} is not one word, as a force curve's law and branch must be")
        })
    })
}

fn check_variables<'a>(
    variables: &'a [Variable],
    count: Option<usize>,
    names: &mut HashSet<&'a str>,
) -> Result<(), StoreError> {
    let mut shared = None;
    for variable in variables {
        check_name(&variable.name, names)?;
        let per_instance = variable.harmonics.unwrap_or(1);
        require(per_instance > 0, || format!("{} has no numbers", variable.name))?;
        if let Some(count) = count {
            check_numbers(&variable.name, variable.data.len(), (count, per_instance))?;
        }
        require(variable.harmonics.is_none() || *shared.get_or_insert(per_instance) == per_instance, || {
            "two variables have different numbers of harmonics".into()
        })?;
    }
    Ok(())
}

fn check_flags<'a>(all: &'a [Flags], names: &mut HashSet<&'a str>) -> Result<(), StoreError> {
    for flags in all {
        check_name(&flags.name, names)?;
        let bad = |word: &String| word.is_empty() || word.contains(char::is_whitespace);
        // A u8 has 8 bits, and 256 codes.
        let most = if flags.bits { 8 } else { 256 };
        require(flags.meanings.len() <= most && !flags.meanings.iter().any(bad), || {
            format!("{} is no list of codes for up to {most} single words", flags.name)
        })?;
    }
    Ok(())
}

fn check_name<'a>(name: &'a str, names: &mut HashSet<&'a str>) -> Result<(), StoreError> {
    let odd = |c: char| c == '/' || c.is_whitespace() || c == '\0';
    require(!(name.is_empty() || name == "." || name.contains(odd)), || {
        format!("{name:?} cannot be a name in a results file")
    })?;
    require(names.insert(name), || format!("two things are called {name}"))
}

fn check_waveforms(waveforms: &Waveforms) -> Result<(), StoreError> {
    let (time, count) = (&waveforms.time, waveforms.instances.len());
    let length = time.first().map_or(0, Vec::len);
    let whole = |rows: &Vec<Vec<f64>>| rows.len() == count && rows.iter().all(|row| row.len() == length);
    let timed = length > 0 && (time.len() == 1 || whole(time));
    require(
        count == 0 || (timed && Waveforms::COLUMNS.iter().all(|column| whole((column.of)(waveforms)))),
        || format!("the waveforms of {count} instances have rows of unequal number or length"),
    )
}

fn check_spectra(spectra: &Spectra) -> Result<(), StoreError> {
    let (count, length) = (spectra.instances.len(), spectra.harmonics());
    let whole = |rows: &Vec<Vec<f64>>| rows.len() == count && rows.iter().all(|row| row.len() == length);
    require(
        count == 0 || (length > 0 && Spectra::COLUMNS.iter().all(|column| whole((column.of)(spectra)))),
        || format!("the spectra of {count} instances have rows of unequal number or length"),
    )
}

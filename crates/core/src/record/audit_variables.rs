//! Estimates, audits and their verdict in the results file.

use super::observables;
use crate::control::{AuditedInstance, ErrorSummary};
use crate::observe::Status;
use crate::plan::Plan;
use crate::store::{Attribute, AuditTable, Flags, Results, Variable};

/// Adds group `audit`, with the reference's values and the run's errors, if instances were redone. Adds the summary of audits
/// and estimates to the root.
pub fn audit(results: &mut Results, plan: &Plan, audited: &[AuditedInstance], verdict: &ErrorSummary) {
    let largest = verdict.worst.map_or(f64::NAN, |worst| worst.error);
    for (name, value) in [
        ("audited", verdict.audited as f64),
        ("audit_compared", verdict.compared as f64),
        ("audit_touching", verdict.touching as f64),
        ("audit_worst", largest),
        ("audit_above", verdict.above as f64),
    ] {
        results.attributes.push((name.into(), Attribute::Number(value)));
    }
    results.attributes.push(("accuracy_verdict".into(), Attribute::Text(verdict.words())));
    results.audit = group(plan, audited);
}

fn group(plan: &Plan, audited: &[AuditedInstance]) -> Option<AuditTable> {
    if audited.is_empty() {
        return None;
    }
    let truths = || audited.iter().map(|one| one.reference);
    let mut variables = observables(plan, truths());
    // The root states the error scales.
    variables.iter_mut().for_each(|variable| variable.error_scale.clear());
    let blind = audited.iter().map(|one| one.truncation).collect();
    variables.push(one("reference_error", "what the reference itself may be off by, at the most", blind));
    let statuses = Flags {
        name: "reference_status".into(),
        long_name: "status by the reference engine".into(),
        meanings: Status::ALL.iter().map(|status| status.meaning().to_owned()).collect(),
        bits: false,
        data: truths().map(|truth| truth.status as u8).collect(),
    };
    let instances = audited.iter().map(|one| u64::from(one.instance)).collect();
    Some(AuditTable {
        instances,
        variables,
        observables: plan.observables.iter().map(|one| one.name().to_owned()).collect(),
        errors: audited.iter().flat_map(|one| one.errors.iter().copied()).collect(),
        flags: vec![statuses],
    })
}

fn one(name: &str, long_name: &str, data: Vec<f64>) -> Variable {
    Variable {
        name: name.into(),
        units: "1".into(),
        long_name: long_name.into(),
        harmonics: None,
        error_scale: String::new(),
        data,
    }
}

//! `run --json`: what became of a run, for programs. docs/commands.md tells the keys.

use afmsweep::{Status, Swept};
use serde_json::{Map, Value, json};
use std::path::Path;

/// The version of the object: raised where a key changes its meaning or goes.
pub(super) const VERSION: u32 = 1;

/// What became of a whole run. Its wall time is still to be said.
pub(super) fn object(swept: &Swept, output: &Path) -> Value {
    let results = &swept.results;
    let count = |status: Status| results.status.iter().filter(|code| **code == status as u8).count();
    let status: Map<String, Value> =
        Status::ALL.iter().map(|status| (status.meaning().to_owned(), count(*status).into())).collect();
    json!({
        "version": VERSION,
        "file": output.to_string_lossy(),
        "instances": results.status.len(),
        "shape": results.shape(),
        "status": status,
        "accuracy": swept.verdict.accuracy,
        "accuracy_met": swept.verdict.met(),
        "accuracy_verdict": swept.verdict.words(),
        "estimate": estimate(swept),
        "audit": audit(swept),
        "search": search(swept),
        "warnings": swept.warnings,
        "notes": swept.run.notes,
        "precision": swept.run.arithmetic.name(),
        "device": results.text("device"),
        "wall_time_s": null,
        "stepping_time_s": swept.stepping,
        "instance_steps_taken": swept.steps_taken,
        "instance_steps_per_second": swept.rate,
        "neighbour_started": swept.run.neighbour_started(),
    })
}

/// Of the instances that are ok: how many have an estimate, the middle and the largest.
fn estimate(swept: &Swept) -> Value {
    let all = swept.run.estimates.iter().zip(&swept.results.status);
    let ok = all.filter(|(estimate, status)| **status == Status::Ok as u8 && estimate.is_finite());
    let mut known: Vec<f64> = ok.map(|(estimate, _)| *estimate).collect();
    known.sort_by(f64::total_cmp);
    json!({ "instances": known.len(), "median": known.get(known.len() / 2), "largest": known.last() })
}

fn audit(swept: &Swept) -> Value {
    let verdict = &swept.verdict;
    let worst = verdict.worst.map(|worst| {
        json!({
            "instance": worst.instance,
            "error": worst.error,
            "observable": worst.observable.map(|one| one.name()),
        })
    });
    json!({
        "instances": verdict.audited,
        "compared": verdict.compared,
        "touching": verdict.touching,
        "above": verdict.above,
        "worst": worst,
    })
}

/// How many periodic states were found; null where none was searched for.
fn search(swept: &Swept) -> Value {
    if swept.run.found.is_empty() {
        return Value::Null;
    }
    let found = swept.run.found.count();
    json!({ "found": found, "second_states": swept.others.as_ref().map(|others| others.states.len()) })
}

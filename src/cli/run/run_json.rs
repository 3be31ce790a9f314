//! `run --json`: what became of a run, for programs. docs/commands.md tells the keys.

use super::run_messages;
use afmsweep::Status;
use afmsweep::engine::{ProfileSection, Progress};
use afmsweep::periodic::SearchFailure;
use afmsweep::sweep::JournaledOutcome;
use serde_json::{Map, Value, json};
use std::path::Path;

/// The version of the object: raised where a key changes its meaning or goes.
pub(super) const VERSION: u32 = 1;

/// What became of a whole run. Its wall time is still to be said.
///
/// # Errors
/// What is kept of the run cannot be read.
pub(super) fn object(swept: &JournaledOutcome, output: &Path) -> anyhow::Result<Value> {
    let (results, run) = (&swept.frame.results, &swept.run);
    let status: Map<String, Value> =
        Status::ALL.iter().map(|status| (status.meaning().to_owned(), run.count(*status).into())).collect();
    let shape = if results.list { vec![run.len()] } else { results.shape() };
    Ok(json!({
        "version": VERSION,
        "file": output.to_string_lossy(),
        "instances": run.len(),
        "shape": shape,
        "status": status,
        "accuracy": swept.verdict.accuracy,
        "accuracy_met": swept.verdict.met(),
        "accuracy_verdict": swept.verdict.words(),
        "estimate": estimate(swept)?,
        "audit": audit(swept),
        "search": search(swept)?,
        "warnings": swept.warnings,
        "notes": run.notes,
        "precision": run.precision(),
        "device": results.text("device"),
        "wall_time_s": null,
        "stepping_time_s": swept.stepping,
        "instance_steps_taken": swept.steps_taken,
        "instance_steps_per_second": swept.rate,
        "neighbour_started": run.neighbour_started(),
    }))
}

/// Where the time went: by the clock, and by processor of all threads together; and why searches gave up.
pub(super) fn times(object: &mut Value, (planning, writing): (f64, f64), progress: &Progress) {
    let busy: Map<String, Value> =
        ProfileSection::ALL.iter().map(|of| (of.name().to_owned(), progress.seconds(*of).into())).collect();
    object["planning_time_s"] = planning.into();
    object["writing_time_s"] = writing.into();
    object["processor_time_s"] = processor_time().into();
    object["busy_time_s"] = busy.into();
    let failures: Map<String, Value> = SearchFailure::ALL
        .iter()
        .map(|why| (why.name().replace(' ', "_"), progress.failures(*why).into()))
        .collect();
    if object["search"].is_object() {
        object["search"]["gave_up"] = failures.into();
    }
}

/// What the process has taken of its processors so far, s; none where the system does not tell it (Linux does).
fn processor_time() -> Option<f64> {
    /// Ticks per second in which Linux tells it.
    const TICKS: f64 = 100.0;
    let text = std::fs::read_to_string("/proc/self/stat").ok()?;
    // The program's name, in brackets, may hold anything.
    let (_, rest) = text.rsplit_once(')')?;
    let mut numbers = rest.split_whitespace().skip(11).map(|word| word.parse::<f64>().ok());
    Some((numbers.next()?? + numbers.next()??) / TICKS)
}

/// Of the instances that are ok: how many have an estimate, the middle and the largest.
fn estimate(swept: &JournaledOutcome) -> anyhow::Result<Value> {
    let known = swept.run.estimates_of_ok()?;
    Ok(json!({ "instances": known.len(), "median": known.get(known.len() / 2), "largest": known.last() }))
}

fn audit(swept: &JournaledOutcome) -> Value {
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
fn search(swept: &JournaledOutcome) -> anyhow::Result<Value> {
    if !swept.run.searched {
        return Ok(Value::Null);
    }
    let found = run_messages::periods_of_found(&swept.run)?.len();
    Ok(json!({ "found": found, "second_states": swept.others.as_ref().map(|others| others.orbits.len()) }))
}

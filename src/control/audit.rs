//! A few instances redone by the reference engine.

use super::truth;
use crate::compare::{Scales, error, ranked, worst};
use crate::engine::{EngineError, Finished, Outcome, Progress, Reference, TOLERANCE};
use crate::observe::Status;
use crate::plan::Plan;
use crate::steady::PeriodicState;

/// Tolerance of the reference's steps in units of the accuracy asked for.
const FINER: f64 = 1e-5;

/// One audited instance.
#[derive(Clone, Debug)]
pub struct Audited {
    pub instance: u32,
    /// What the reference makes of it.
    pub truth: Finished,
    /// The run's error in each of the plan's observables, on its scale.
    pub errors: Vec<f64>,
    /// The largest of them; none where either the run or the reference does not call the instance ok.
    pub worst: Option<f64>,
}

/// Redoes up to `count` instances of a finished run that are called ok: half of them the most extreme ones, the
/// others at random, and by turns, so that one that is stopped has done some of both. Steady motion is redone as the reference's own periodic state next to the run's (`found` holds
/// the states that the run searched for): that tells its error, and leaves open whether waiting would end in the
/// same state. Runs from rest are redone whole.
///
/// # Errors
/// What the reference engine says.
pub fn audit(
    plan: &Plan,
    outcome: &Outcome,
    found: &[Option<Box<PeriodicState>>],
    count: usize,
    progress: &Progress,
) -> Result<Vec<Audited>, EngineError> {
    progress.stage(&["audit"]);
    let ok = |i: &u32| outcome.results[*i as usize].status == Status::Ok;
    let counted: Vec<u32> = (0..plan.cases.len() as u32).filter(ok).collect();
    let chosen = ranked(&plan.only(&counted), count, 1);
    if chosen.is_empty() {
        return Ok(Vec::new());
    }
    // Far below what is to be seen, and several times faster than the reference's own.
    let tolerance = (FINER * plan.run.accuracy).max(TOLERANCE);
    let reference = Reference { tolerance, ..Reference::default() };
    let truths = truth::truths(plan, false, &chosen, found, &reference, progress)?;
    let one = |(instance, truth): (u32, Finished)| {
        let ours = &outcome.results[instance as usize];
        let scales = Scales::of(plan, instance as usize, &truth.measured);
        let of = |observable| error(observable, &ours.measured, &truth.measured, &scales);
        let counts = ours.status == Status::Ok && truth.status == Status::Ok;
        Audited {
            instance,
            truth,
            errors: plan.observables.iter().map(|observable| of(*observable)).collect(),
            worst: counts.then(|| worst(&plan.observables, &ours.measured, &truth.measured, &scales)),
        }
    };
    // Stopped on the way: what was not redone says nothing.
    let done = |(_, truth): &(u32, Finished)| truth.status != Status::NotRun;
    let mut all: Vec<Audited> = chosen.into_iter().zip(truths).filter(done).map(one).collect();
    all.sort_unstable_by_key(|one| one.instance);
    Ok(all)
}

//! A few instances redone by the reference engine.

use crate::compare::{Scales, choose, error, worst};
use crate::engine::{Engine, EngineError, Finished, Outcome, Progress, Reference, TOLERANCE};
use crate::observe::Status;
use crate::plan::Plan;

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

/// Redoes up to `count` instances of a finished run: half of them the most extreme ones, the others at random.
///
/// # Errors
/// What the reference engine says.
pub fn audit(
    plan: &Plan,
    outcome: &Outcome,
    count: usize,
    progress: &Progress,
) -> Result<Vec<Audited>, EngineError> {
    let chosen = choose(plan, count, 1);
    if chosen.is_empty() {
        return Ok(Vec::new());
    }
    let part = plan.only(&chosen);
    // Far below what is to be seen, and several times faster than the reference's own.
    let tolerance = (FINER * plan.run.accuracy).max(TOLERANCE);
    let reference = Reference { tolerance, ..Reference::default() };
    let truths = reference.run(&part, progress)?.results;
    let one = |instance: u32| {
        let (ours, truth) = (&outcome.results[instance as usize], truths[instance as usize]);
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
    let done = |instance: &u32| truths[*instance as usize].status != Status::NotRun;
    Ok(chosen.into_iter().filter(done).map(one).collect())
}

//! Steps: by doubling.

use super::Controlled;
use crate::compare::{Scales, worst};
use crate::engine::{Engine, EngineError, Finished, Progress};
use crate::observe::Status;
use crate::plan::{Plan, STEPS_MAX};
use rayon::prelude::*;

/// How often an instance runs again with twice as many steps.
const DOUBLINGS: usize = 3;

/// What is left of the difference between two runs in the finer one's error. Errors fall by 5 to 10 times with
/// twice the steps (orders 2.4 to 3.4), which leaves a quarter to a tenth; jumps that fall into another step
/// spoil single cases.
const LEFT: f64 = 0.5;

/// Runs `stepped`, the plan's instances that need steps, with half the plan's steps and with the plan's.
pub(super) fn run(
    plan: Plan,
    stepped: &[u32],
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<Controlled, EngineError> {
    if plan.run.steps_per_period.is_some() {
        progress.expect(plan.instance_steps());
        let mut estimates = vec![0.0; plan.cases.len()];
        stepped.iter().for_each(|i| estimates[*i as usize] = 0.0);
        let outcome = engine.run(&plan, progress)?;
        return Ok(Controlled { plan, outcome, estimates });
    }
    let coarse = plan.stepped(stepped, |case| case.steps / 2);
    progress.expect(coarse.instance_steps() + plan.instance_steps());
    let rough = engine.run(&coarse, progress)?.results;
    let outcome = engine.run(&plan, progress)?;
    let mut estimates = vec![0.0; plan.cases.len()];
    for (i, error) in estimate(&plan, stepped, &rough, &outcome.results) {
        estimates[i as usize] = error;
    }
    let mut all = Controlled { plan, outcome, estimates };
    for _ in 0..DOUBLINGS {
        let again: Vec<u32> = stepped.iter().copied().filter(|i| all.doubtful(*i as usize)).collect();
        if again.is_empty() || progress.stopped() {
            break;
        }
        let finer = all.plan.stepped(&again, |case| 2 * case.steps);
        progress.expect(finer.instance_steps());
        let outcome = engine.run(&finer, progress)?;
        if progress.stopped() {
            break;
        }
        for (i, error) in estimate(&finer, &again, &all.outcome.results, &outcome.results) {
            let i = i as usize;
            all.estimates[i] = error;
            all.outcome.results[i] = outcome.results[i];
            all.plan.cases[i].steps = finer.cases[i].steps;
        }
        all.outcome.notes.extend(outcome.notes);
    }
    all.plan = all.plan.only(&(0..all.plan.cases.len() as u32).collect::<Vec<_>>());
    Ok(all)
}

impl Controlled {
    /// Whether more steps are called for: not where the motion itself does not repeat.
    fn doubtful(&self, i: usize) -> bool {
        let status = self.outcome.results[i].status;
        let helps = matches!(status, Status::Ok | Status::OutOfRange | Status::NonFinite);
        let room = self.plan.cases[i].steps <= STEPS_MAX / 2;
        helps && room && (status != Status::Ok || self.estimates[i] > self.plan.run.accuracy)
    }
}

/// Estimated error of the finer of two results of each instance.
fn estimate(plan: &Plan, instances: &[u32], coarse: &[Finished], fine: &[Finished]) -> Vec<(u32, f64)> {
    instances
        .par_iter()
        .map(|&i| (i, LEFT * difference(plan, i as usize, &coarse[i as usize], &fine[i as usize])))
        .collect()
}

/// How far two results of an instance are apart: the worst observable on its scale.
pub(super) fn difference(plan: &Plan, i: usize, a: &Finished, b: &Finished) -> f64 {
    let scales = Scales::of(plan, i, &b.measured);
    worst(&plan.observables, &a.measured, &b.measured, &scales)
}

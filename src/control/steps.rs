//! Steps: by doubling.

use super::{Controlled, sensitive};
use crate::compare::{Scales, worst};
use crate::engine::{Engine, EngineError, Finished, Progress};
use crate::observe::Status;
use crate::plan::{Plan, STEPS_MAX};
use crate::steady::{self, SETTLED, Settled};
use rayon::prelude::*;

/// How often an instance runs again with twice as many steps.
const DOUBLINGS: usize = 4;

/// What is left of the difference between two runs in the finer one's error. Errors fall by 5 to 10 times with
/// twice the steps (orders 2.4 to 3.4), which leaves a quarter to a tenth; jumps that fall into another step
/// spoil single cases.
const LEFT: f64 = 0.5;

/// Share of the accuracy that an estimate may have before more steps are taken: the rest is left to what no estimate
/// sees (undamped modes of small share, rounding).
const AIM: f64 = 0.6;

/// Fewest steps per period.
const FEWEST: u32 = 16;

/// Runs `all` the plan's instances, and `stepped`, those that need steps, with a quarter and with half of the plan's steps, which
/// are on the safe side, and then as the estimates ask for. `left_out` is what the modes left out cost.
pub(super) fn run(
    plan: Plan,
    (all, stepped): (&[u32], &[u32]),
    left_out: Vec<f64>,
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<Controlled, EngineError> {
    if plan.run.steps_per_period.is_some() {
        let settled = steady::run(&plan, &[], engine, progress)?;
        let mut estimates = vec![0.0; plan.cases.len()];
        stepped.iter().for_each(|i| estimates[*i as usize] = f64::NAN);
        return Ok(Controlled::new(plan, settled, estimates, &left_out));
    }
    let fine = plan.stepped(all, |case| (case.steps / 2).max(2 * FEWEST));
    let coarse = fine.stepped(stepped, |case| case.steps / 2);
    let rough = steady::run(&coarse, &[], engine, progress)?;
    let mut settled = steady::run(&fine, &rough.found, engine, progress)?;
    settled.outcome.notes.splice(0..0, rough.outcome.notes);
    let mut estimates = left_out.clone();
    for (i, error) in estimate(&fine, stepped, &rough.outcome.results, &settled.outcome.results) {
        estimates[i as usize] += error;
    }
    let mut now = Controlled::new(fine, settled, estimates, &left_out);
    let mut doubted = Vec::new();
    for round in 0..DOUBLINGS {
        let again: Vec<u32> = stepped.iter().copied().filter(|i| now.doubtful(*i as usize)).collect();
        if round == 0 {
            doubted.clone_from(&again);
        }
        if again.is_empty() || progress.stopped() {
            break;
        }
        let finer = now.plan.stepped(&again, |case| 2 * case.steps);
        let Settled { outcome, mut found, periods } = steady::run(&finer, &now.found, engine, progress)?;
        if progress.stopped() {
            break;
        }
        for (i, error) in estimate(&finer, &again, &now.outcome.results, &outcome.results) {
            let i = i as usize;
            now.estimates[i] = left_out[i] + error;
            now.outcome.results[i] = outcome.results[i];
            now.plan.cases[i].steps = finer.cases[i].steps;
            now.periods[i] = periods[i];
            if let (Some(place), Some(new)) = (now.found.get_mut(i), found.get_mut(i)) {
                *place = new.take();
            }
        }
        now.outcome.notes.extend(outcome.notes);
    }
    now.plan = now.plan.only(all);
    for &i in stepped {
        let i = i as usize;
        let found = now.found.get(i).is_some_and(Option::is_some);
        if !found && now.periods[i] < now.plan.run.periods {
            // It was left before it had settled for good.
            now.estimates[i] += SETTLED * now.plan.run.accuracy;
        }
    }
    doubted.retain(|i| now.found.get(*i as usize).is_none_or(Option::is_none));
    sensitive::mark(&now.plan, &doubted, &mut now.outcome.results, engine, progress)?;
    Ok(now)
}

impl Controlled {
    fn new(
        plan: Plan,
        Settled { outcome, found, periods }: Settled,
        estimates: Vec<f64>,
        left_out: &[f64],
    ) -> Self {
        Self { plan, outcome, estimates, left_out: left_out.to_vec(), found, periods }
    }

    /// Whether more steps are called for: not where the motion itself does not repeat.
    fn doubtful(&self, i: usize) -> bool {
        let status = self.outcome.results[i].status;
        let helps = matches!(status, Status::Ok | Status::OutOfRange | Status::NonFinite);
        let room = self.plan.cases[i].steps <= STEPS_MAX / 2;
        helps && room && (status != Status::Ok || self.estimates[i] > AIM * self.plan.run.accuracy)
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

//! Steps: by doubling.

use super::{Controlled, precision, sensitive};
use crate::compare::{Scales, worst};
use crate::engine::{Engine, EngineError, Finished, Progress};
use crate::observe::Status;
use crate::plan::{Plan, Precision, STEPS_MAX};
use crate::steady::{self, SETTLED, Settled};
use rayon::prelude::*;

/// How often an instance runs again with twice as many steps.
const DOUBLINGS: usize = 4;

/// What is left of the difference between two runs in the finer one's error. Errors fall by 6 to 16 times with
/// twice the steps (orders 2.6 to 4), which leaves a fifth to a fifteenth; single cases do worse.
const LEFT: f64 = 0.25;

/// Share of the accuracy that an estimate may have before more steps are taken: the rest is left to what no estimate
/// sees (undamped modes of small share, rounding).
const AIM: f64 = 0.6;

/// Fewest steps per period.
const FEWEST: u32 = 16;

/// The plan for these instances with half of its steps, which are on the safe side.
pub(super) fn halved(plan: &Plan, instances: &[u32]) -> Plan {
    plan.stepped(instances, |case| (case.steps / 2).max(2 * FEWEST))
}

/// The plan for these instances with a quarter of its steps, for the first estimate.
pub(super) fn quartered(plan: &Plan, instances: &[u32]) -> Plan {
    halved(plan, instances).stepped(instances, |case| case.steps / 2)
}

/// Runs `all` the plan's instances, and `stepped`, those that need steps, with a quarter and with half of the plan's
/// steps, and then as the estimates ask for. `left_out` is what the modes left out cost. Where `chosen` says so, what
/// f32 does not bring to the accuracy goes on in f64: rounding does not fall with the steps.
pub(super) fn run(
    plan: Plan,
    (all, stepped): (&[u32], &[u32]),
    (left_out, chosen): (Vec<f64>, &precision::Choice),
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<Controlled, EngineError> {
    if plan.run.steps_per_period.is_some() {
        let settled = steady::run(&plan, &[], engine, progress)?;
        let mut estimates = vec![0.0; plan.cases.len()];
        stepped.iter().for_each(|i| estimates[*i as usize] = f64::NAN);
        return Ok(Controlled::new(plan, settled, (estimates, &left_out), chosen));
    }
    let fine = halved(&plan, all);
    let coarse = quartered(&plan, stepped);
    let rough = steady::run(&coarse, &[], engine, progress)?;
    let mut settled = steady::run(&fine, &rough.found, engine, progress)?;
    settled.outcome.notes.splice(0..0, rough.outcome.notes);
    let mut estimates = left_out.clone();
    for (i, error) in estimate(&fine, stepped, &rough.outcome.results, &settled.outcome.results) {
        estimates[i as usize] += error;
    }
    let mut now = Controlled::new(fine, settled, (estimates, &left_out), chosen);
    let mut doubted = Vec::new();
    for round in 0..DOUBLINGS {
        let again: Vec<u32> =
            stepped.iter().copied().filter(|i| now.doubtful(*i as usize, chosen.mixed)).collect();
        if round == 0 {
            doubted.clone_from(&again);
        }
        if again.is_empty() || progress.stopped() {
            break;
        }
        // Rounding may be what does not repeat: that is for f64 to say, with the same steps.
        let (unsteady, rough): (Vec<u32>, Vec<u32>) =
            again.into_iter().partition(|i| now.outcome.results[*i as usize].status == Status::NotSteady);
        let (single, double): (Vec<u32>, Vec<u32>) = rough
            .into_iter()
            .partition(|i| now.arithmetic.of[*i as usize] == Precision::F32 && (round == 0 || !chosen.mixed));
        now.again(&unsteady, (1, Precision::F64), engine, progress)?;
        now.again(&single, (2, Precision::F32), engine, progress)?;
        now.again(&double, (2, Precision::F64), engine, progress)?;
    }
    now.plan = now.plan.only(all);
    for &i in stepped {
        let i = i as usize;
        let found = now.found.get(i).is_some_and(Option::is_some);
        if !found && now.periods[i] < now.plan.run.periods {
            // It was left before it had settled for good.
            now.estimates[i] += SETTLED * now.plan.run.accuracy;
        }
        if chosen.mixed && now.arithmetic.of[i] == Precision::F32 {
            now.estimates[i] += chosen.rounding;
        }
    }
    doubted.retain(|i| now.found.get(*i as usize).is_none_or(Option::is_none));
    for precision in [Precision::F32, Precision::F64] {
        let alike: Vec<u32> =
            doubted.iter().copied().filter(|i| now.arithmetic.of[*i as usize] == precision).collect();
        let plan = Plan { precision, ..now.plan.clone() };
        sensitive::mark(&plan, &alike, &mut now.outcome.results, engine, progress)?;
    }
    Ok(now)
}

impl Controlled {
    fn new(
        plan: Plan,
        Settled { outcome, found, periods }: Settled,
        (estimates, left_out): (Vec<f64>, &[f64]),
        chosen: &precision::Choice,
    ) -> Self {
        let arithmetic = chosen.arithmetic(plan.cases.len());
        Self { plan, outcome, estimates, left_out: left_out.to_vec(), found, periods, arithmetic }
    }

    /// Runs these instances again with so many times their steps.
    fn again(
        &mut self,
        again: &[u32],
        (times, precision): (u32, Precision),
        engine: &dyn Engine,
        progress: &Progress,
    ) -> Result<(), EngineError> {
        if again.is_empty() || progress.stopped() {
            return Ok(());
        }
        let finer = Plan { precision, ..self.plan.stepped(again, |case| times * case.steps) };
        let Settled { outcome, mut found, periods } = steady::run(&finer, &self.found, engine, progress)?;
        if progress.stopped() {
            return Ok(());
        }
        for (i, error) in estimate(&finer, again, &self.outcome.results, &outcome.results) {
            let i = i as usize;
            if times > 1 {
                self.estimates[i] = self.left_out[i] + error;
            } else if outcome.results[i].status == Status::Ok {
                // The same steps in another precision teach nothing of the steps: that is still to come.
                self.estimates[i] = f64::INFINITY;
            }
            self.outcome.results[i] = outcome.results[i];
            self.plan.cases[i].steps = finer.cases[i].steps;
            self.periods[i] = periods[i];
            self.arithmetic.of[i] = precision;
            if let (Some(place), Some(new)) = (self.found.get_mut(i), found.get_mut(i)) {
                *place = new.take();
            }
        }
        self.outcome.notes.extend(outcome.notes);
        Ok(())
    }

    /// Whether more steps are called for: not where the motion itself does not repeat. Of that f32 may be wrong.
    fn doubtful(&self, i: usize, mixed: bool) -> bool {
        let status = self.outcome.results[i].status;
        let rounded = mixed && self.arithmetic.of[i] == Precision::F32 && status == Status::NotSteady;
        let helps = rounded || matches!(status, Status::Ok | Status::OutOfRange | Status::NonFinite);
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

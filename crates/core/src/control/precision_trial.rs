//! The choice of precision, by a sample of instances in both.

use super::difference_scale::scaled_difference;
use super::step_reduction::half_steps;
use super::{Arithmetic, RunResult, contact_sample};
use crate::engine::{Engine, EngineError, Finished, Progress, in_double};
use crate::observe::Status;
use crate::orbit;
use crate::plan::{Plan, Precision};
use serde::{Deserialize, Serialize};

/// The precision of a run, with the result of its trial.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub(super) struct PrecisionChoice {
    pub precision: Precision,
    /// Whether instances that f32 does not serve continue in f64.
    pub mixed: bool,
    /// Largest effect of rounding in the sample, on the scale of accuracy. NaN without a trial.
    pub rounding: f64,
    pub reason: String,
    /// Messages of the engine from the sample's runs.
    #[serde(skip)]
    pub notes: Vec<String>,
}

impl PrecisionChoice {
    pub fn settled(plan: &Plan, reason: &str) -> Self {
        Self {
            precision: plan.precision,
            mixed: false,
            rounding: f64::NAN,
            reason: reason.into(),
            notes: Vec::new(),
        }
    }

    /// Arithmetic of `count` instances that have all run as chosen so far.
    pub fn arithmetic(&self, count: usize) -> Arithmetic {
        Arithmetic { of: vec![self.precision; count], rounding: self.rounding, reason: self.reason.clone() }
    }
}

/// f64, for a plan whose instances mostly start from their neighbours' states.
pub(super) fn for_neighbours(plan: &Plan) -> PrecisionChoice {
    PrecisionChoice::settled(
        plan,
        "most instances take a period or two from their neighbours' states, which are known in f64",
    )
}

/// Decides whether `plan`, whose instances `stepped` need steps, runs in f32. The sample runs in both with the chosen bases
/// and the steps of the first estimate.
pub(super) fn choose(
    plan: &Plan,
    stepped: &[u32],
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<PrecisionChoice, EngineError> {
    if let Some(reason) = plan.precision_settled() {
        return Ok(PrecisionChoice::settled(plan, reason));
    }
    if !engine.double() {
        return Ok(PrecisionChoice::settled(plan, "the device has no other"));
    }
    let part = plan.part(&contact_sample::sample(plan, stepped));
    let sample: Vec<u32> = part.instances().collect();
    let trial = half_steps(part.clone());
    let run = |precision| orbit::solve(&trial.clone().in_precision(precision), &[], engine, progress);
    let (double, single) = (run(Precision::F64)?, run(Precision::F32)?);
    if progress.stopped() {
        return Ok(PrecisionChoice::settled(plan, "stopped before its trial"));
    }
    let result = |of: &orbit::OrbitSolution, i: u32| of.outcome.results[i as usize];
    let moved = |i: &u32| rounding_difference(&part, *i, &result(&single, *i), &result(&double, *i));
    let rounding = sample.iter().map(moved).fold(0.0, f64::max);
    let cost =
        |of: &orbit::OrbitSolution, i: u32| f64::from(trial.steps(i)) * f64::from(of.periods[i as usize]);
    let again = |i: &&u32| result(&single, **i).status == Status::NotSteady;
    let in_double: f64 = sample.iter().map(|i| cost(&double, *i)).sum();
    let in_single = plan.policy.single_cost * sample.iter().map(|i| cost(&single, *i)).sum::<f64>()
        + sample.iter().filter(again).map(|i| cost(&double, *i)).sum::<f64>();
    let allowed = plan.policy.rounding_share * plan.run.accuracy;
    let count = sample.len();
    let (precision, reason) = if rounding > allowed {
        let by = if rounding.is_finite() {
            format!("by {rounding:.1e}")
        } else {
            "from one status to another".into()
        };
        (Precision::F64, format!("f32 moves a sample of {count} {by}, {allowed:.0e} is allowed"))
    } else if in_single > plan.policy.single_worth * in_double {
        (Precision::F64, format!("in f32 too many of a sample of {count} take long to settle"))
    } else {
        (
            Precision::F32,
            format!("it moves a sample of {count} by {rounding:.1e} at most, {allowed:.0e} is allowed"),
        )
    };
    let notes = double.outcome.notes.into_iter().chain(single.outcome.notes).collect();
    Ok(PrecisionChoice { precision, mixed: precision == Precision::F32, rounding, reason, notes })
}

/// Rounding error of a run in f32.
pub(super) struct RoundingCost {
    /// Largest error in the sample, and the addition to each instance's estimate. None if stopped on the way.
    pub told: Option<(f64, Vec<f64>)>,
    /// Messages for the user.
    pub notes: Vec<String>,
}

/// Estimates the rounding error of a run with prescribed f32. A sample runs once more in f64, with the same bases and steps.
/// Any other instance takes the larger difference of its neighbours in the sample.
pub(super) fn cost_of_rounding(
    run: &RunResult,
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<RoundingCost, EngineError> {
    let order = contact_sample::by_stiffness(&run.plan, &run.plan.stepped());
    let sample = contact_sample::spread(&run.plan, &order);
    let engine = in_double(engine);
    let double = run.plan.part(&sample).in_precision(Precision::F64);
    let found = run.found.of(&sample);
    let found: Vec<_> = found.iter().map(Option::as_ref).collect();
    let settled = orbit::solve_near_states(&double, &found, engine, progress)?;
    let notes = settled.outcome.notes;
    if progress.stopped() {
        return Ok(RoundingCost { told: None, notes });
    }
    let single = |i: u32| run.results.get(i as usize);
    let moved: Vec<f64> = sample
        .iter()
        .zip(&settled.outcome.results)
        .map(|(i, double)| rounding_difference(&run.plan, *i, &single(*i), double))
        .collect();
    let rounding = moved.iter().copied().filter(|one| one.is_finite()).fold(0.0, f64::max);
    let kinds: Vec<_> = sample.iter().map(|i| contact_sample::kind(&run.plan, *i)).collect();
    let mut added = vec![0.0; run.plan.len()];
    let mut next = 0;
    for i in order {
        let here = sample.get(next) == Some(&i);
        let kind = contact_sample::kind(&run.plan, i);
        let of_kind = |n: &usize| kinds[*n] == kind;
        let near = [next.checked_sub(1), (next < sample.len()).then_some(next)].into_iter().flatten();
        let near = near.filter(of_kind).map(|n| moved[n]).filter(|one| one.is_finite());
        added[i as usize] = if here { moved[next] } else { near.fold(0.0, f64::max) };
        next += usize::from(here);
    }
    Ok(RoundingCost { told: Some((rounding, added)), notes })
}

/// How far rounding moves a result. Motion that f32 does not call steady continues in f64, which costs only time.
fn rounding_difference(plan: &Plan, i: u32, single: &Finished, double: &Finished) -> f64 {
    match (single.status, double.status) {
        (Status::Ok, Status::Ok) => scaled_difference(plan, i, single, double),
        (a, b) if a == b || a == Status::NotSteady => 0.0,
        _ => f64::INFINITY,
    }
}

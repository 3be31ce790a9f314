//! Runs with prescribed steps, which are kept while their error is estimated.

use super::ChunkRun;
use super::difference_scale::scaled_differences;
use super::energy_balance::work_of_steps;
use super::first_estimate::EstimateInputs;
use super::reference_solution::gives_way;
use crate::engine::{Engine, EngineError, Progress};
use crate::observe::Status;
use crate::orbit;
use crate::plan::{Plan, STEPS_MAX};

/// Runs the plan with its own steps, and `stepped` once more with half of them. The share of the difference that remains is
/// the estimate. If half would be too few, or the estimate is above the accuracy, a run with twice the steps gives a better
/// one.
pub(super) fn run(
    mut plan: Plan,
    stepped: &[u32],
    EstimateInputs { mut left_out, chosen, .. }: EstimateInputs,
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<ChunkRun, EngineError> {
    let settled = orbit::solve_first(&mut plan, engine, progress)?;
    if plan.run.modes.is_none() {
        // Modes too fast for these steps were in no basis on trial.
        for &i in stepped {
            let (kept, measured) = (&plan.driven(i).kept, &settled.outcome.results[i as usize].measured);
            let cut = gives_way(&plan, i as usize, measured, kept.residual_share.abs() * kept.flexibility);
            left_out[i as usize] = left_out[i as usize].max(cut);
        }
    }
    let (fewest, left) = (plan.policy.fewest_steps, plan.policy.left_of_steps);
    let estimates = left_out.clone();
    let arithmetic = chosen.arithmetic(plan.len());
    let mut now = ChunkRun::new(plan, settled, (estimates, left_out), arithmetic);
    let half = |i: &u32| now.plan.steps(*i) / 2 >= fewest;
    let (coarse, mut doubtful): (Vec<u32>, Vec<u32>) = stepped.iter().copied().partition(half);
    stepped.iter().for_each(|i| now.estimates[*i as usize] = f64::NAN);
    now.beside(&coarse, (|steps| steps / 2, left), engine, progress)?;
    doubtful.extend(coarse.into_iter().filter(|i| now.estimates[*i as usize] > now.plan.run.accuracy));
    doubtful.retain(|i| {
        let ok = now.outcome.results[*i as usize].status == Status::Ok;
        ok && now.plan.steps(*i) <= STEPS_MAX / 2
    });
    // This difference contains the error of the finer run, too.
    now.beside(&doubtful, (|steps| 2 * steps, 1.0 + left), engine, progress)?;
    stepped.iter().for_each(|i| now.add_unsettled(*i));
    Ok(now)
}

impl ChunkRun {
    /// Runs these instances with other steps. Their estimate becomes `share` of the difference, but stays NaN if the other
    /// run was cut short.
    fn beside(
        &mut self,
        instances: &[u32],
        (steps, share): (fn(u32) -> u32, f64),
        engine: &dyn Engine,
        progress: &Progress,
    ) -> Result<(), EngineError> {
        if instances.is_empty() || progress.stopped() {
            return Ok(());
        }
        let mut other = self.plan.part(instances).with_steps(steps);
        let near = orbit::gather(&self.found, instances);
        let second = orbit::solve_again(&mut other, &near, engine, progress)?.outcome;
        let apart = scaled_differences(&self.plan, instances, &second.results, &self.outcome.results);
        for ((i, apart), other) in instances.iter().zip(apart).zip(&second.results) {
            let n = *i as usize;
            if other.status != Status::NotRun {
                let of_work = work_of_steps(&self.plan, *i, &self.outcome.results[n].measured);
                self.estimates[n] = self.truncation[n] + (share * apart).max(of_work);
            }
        }
        self.outcome.notes.extend(second.notes);
        Ok(())
    }
}

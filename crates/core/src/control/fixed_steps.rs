//! Steps that the scene prescribes: they are kept, and what they cost is estimated all the same.

use super::ChunkRun;
use super::difference_scale::scaled_differences;
use super::first_estimate::EstimateInputs;
use super::reference_solution::gives_way;
use crate::engine::{Engine, EngineError, Progress};
use crate::observe::Status;
use crate::orbit;
use crate::plan::{Plan, STEPS_MAX};

/// Runs the plan with its own steps, and its instances `stepped` once more with half of them: the estimate is what is
/// left of the difference. Where half would be too few, or says that the accuracy asked for is not met, another run with
/// twice the steps says it better.
pub(super) fn run(
    mut plan: Plan,
    stepped: &[u32],
    EstimateInputs { mut left_out, chosen, .. }: EstimateInputs,
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<ChunkRun, EngineError> {
    let settled = orbit::solve_first(&mut plan, engine, progress)?;
    if plan.run.modes.is_none() {
        // Modes that are too fast for these steps: no basis on trial had them.
        for &i in stepped {
            let (kept, measured) = (&plan.driven(i).kept, &settled.outcome.results[i as usize].measured);
            let cut = gives_way(&plan, i as usize, measured, kept.residual_share.abs() * kept.flexibility);
            left_out[i as usize] = left_out[i as usize].max(cut);
        }
    }
    let (fewest, left) = (plan.policy.fewest_steps, plan.policy.left_of_steps);
    let estimates = left_out.clone();
    let mut now = ChunkRun::new(plan, settled, (estimates, left_out), chosen);
    let half = |i: &u32| now.plan.steps(*i) / 2 >= fewest;
    let (coarse, mut doubtful): (Vec<u32>, Vec<u32>) = stepped.iter().copied().partition(half);
    stepped.iter().for_each(|i| now.estimates[*i as usize] = f64::NAN);
    now.beside(&coarse, (|steps| steps / 2, left), engine, progress)?;
    doubtful.extend(coarse.into_iter().filter(|i| now.estimates[*i as usize] > now.plan.run.accuracy));
    doubtful.retain(|i| {
        let ok = now.outcome.results[*i as usize].status == Status::Ok;
        ok && now.plan.steps(*i) <= STEPS_MAX / 2
    });
    // The difference to a finer run is the coarser one's error but for the finer one's.
    now.beside(&doubtful, (|steps| 2 * steps, 1.0 + left), engine, progress)?;
    stepped.iter().for_each(|i| now.add_unsettled(*i));
    Ok(now)
}

impl ChunkRun {
    /// Runs these instances with other steps and takes `share` of the difference for their error; NaN where the other
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
                self.estimates[n] = self.truncation[n] + share * apart;
            }
        }
        self.outcome.notes.extend(second.notes);
        Ok(())
    }
}

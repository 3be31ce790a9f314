//! How long a plan will take here.

use super::{Engine, EngineError, Progress};
use crate::plan::{Class, Plan};
use std::time::Instant;

/// Instances tried per class, and steps tried in all.
const INSTANCES: usize = 8;
const STEPS: f64 = 2e6;

/// Time (s) the plan takes on `engine`, from a trial of a few instances over a few periods.
pub fn estimate(plan: &Plan, engine: &dyn Engine) -> Result<f64, EngineError> {
    if plan.instance_steps() == 0 {
        return Ok(0.0);
    }
    let mut trial = plan.clone();
    trial.classes = plan
        .classes
        .iter()
        .map(|class| {
            let every = class.instances.len().div_ceil(INSTANCES);
            Class { instances: class.instances.iter().copied().step_by(every).collect(), ..class.clone() }
        })
        .collect();
    let per_period: f64 =
        trial.classes.iter().map(|class| f64::from(class.steps) * class.instances.len() as f64).sum();
    trial.run.periods = ((STEPS / per_period) as u32).clamp(1, plan.run.periods);
    trial.run.measure = (trial.run.periods * plan.run.measure / plan.run.periods).max(1);
    let start = Instant::now();
    engine.run(&trial, &Progress::default())?;
    let seconds = start.elapsed().as_secs_f64();
    Ok(seconds * plan.instance_steps() as f64 / trial.instance_steps() as f64)
}

//! Estimates the run time of a plan here.

use super::{Engine, EngineError, Progress};
use crate::clock::Instant;
use crate::plan::{Class, Plan};
use std::time::Duration;

/// Instances tried per class, and steps tried in all.
const SAMPLE_INSTANCES: usize = 64;
const SAMPLE_STEPS: f64 = 2e6;
/// Least time of the trial.
const MIN_SAMPLE_TIME: Duration = Duration::from_millis(40);

/// Time (s) the plan takes on `engine`, from a trial of a few instances over a few periods.
///
/// The trial is a plan of those instances alone. Otherwise, work that an engine does once for every instance would count as
/// stepping of a few, and grow with the square of their number.
///
/// # Errors
/// The engine cannot run the trial.
pub fn estimate(plan: &Plan, engine: &dyn Engine) -> Result<f64, EngineError> {
    if plan.instance_steps() == 0 {
        return Ok(0.0);
    }
    let mut classes = plan.classes();
    classes.retain(|class| class.steps > 0);
    // The few instances of a class keep one device busy.
    let busy = engine.devices().min(classes.len()).max(1);
    let few = |class: Class| {
        let every = class.instances.len().div_ceil(SAMPLE_INSTANCES);
        class.instances.into_iter().step_by(every)
    };
    let tried: Vec<u32> = classes.into_iter().flat_map(few).collect();
    let mut trial = plan.part(&tried);
    let per_period = trial.instance_steps() as f64 / f64::from(trial.run.periods);
    trial.run.periods = ((SAMPLE_STEPS / per_period) as u32).clamp(1, plan.run.periods);
    let share = u64::from(trial.run.periods) * u64::from(plan.run.measure) / u64::from(plan.run.periods);
    trial.run.measure = (share as u32).clamp(1, trial.run.periods);
    // The first run starts the threads. Later runs repeat until they outlast the clock's resolution.
    engine.run(&trial, &Progress::default())?;
    let start = Instant::now();
    let mut runs = 0.0;
    while start.elapsed() < MIN_SAMPLE_TIME {
        engine.run(&trial, &Progress::default())?;
        runs += 1.0;
    }
    let seconds = start.elapsed().as_secs_f64() / runs;
    let share = plan.instance_steps() as f64 / trial.instance_steps() as f64;
    Ok(seconds * share * busy as f64 / engine.devices().max(1) as f64)
}

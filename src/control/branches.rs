//! The second periodic state of a bistable instance.

use super::{Controlled, steps};
use crate::engine::{Engine, EngineError, Finished, Progress};
use crate::observe::Status;
use crate::plan::Plan;
use crate::steady;

/// A periodic state beside the one in the results.
#[derive(Clone, Copy, Debug)]
pub struct Other {
    pub instance: u32,
    pub finished: Finished,
    /// Modulus of the period map's largest multiplier there.
    pub multiplier: f64,
}

/// In units of the accuracy asked for: what is nearer is the same state.
const APART: f64 = 10.0;

/// Second states of the instances of a finished run, searched for from the lever at rest with the steps of the run.
///
/// # Errors
/// What the engine says.
pub fn others(run: &Controlled, engine: &dyn Engine, progress: &Progress) -> Result<Vec<Other>, EngineError> {
    progress.stage(&["branches"]);
    let plan: &Plan = &run.plan;
    let counts = |i: &u32| {
        plan.cases[*i as usize].steps > 0 && run.outcome.results[*i as usize].status != Status::NotRun
    };
    let instances: Vec<u32> = (0..plan.cases.len() as u32).filter(counts).collect();
    let second = steady::from_rest(plan, &instances, engine, progress)?;
    let other = |i: u32| {
        let place = second.found[i as usize].as_ref()?;
        let (ours, finished) = (&run.outcome.results[i as usize], second.outcome.results[i as usize]);
        let apart = steps::difference(plan, i as usize, ours, &finished) > APART * plan.run.accuracy;
        // Where the first run found no steady state at all, any is another.
        let another = apart || !ours.status.is_steady();
        another.then_some(Other { instance: i, finished, multiplier: place.spectrum.multiplier })
    };
    Ok(instances.into_iter().filter_map(other).collect())
}

//! Whether a tiny change of the start moves a result.

use super::difference::difference;
use crate::engine::{Engine, EngineError, Finished, Progress};
use crate::observe::Status;
use crate::plan::{Plan, Station};
use crate::scene::Start;
use std::sync::Arc;

/// Marks those of `instances` whose waited results a tiny change of the start moves by more than the accuracy asked
/// for, where they would count as ok.
pub(super) fn mark(
    plan: &Plan,
    instances: &[u32],
    results: &mut [Finished],
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<(), EngineError> {
    let ok = |i: &u32| results[*i as usize].status == Status::Ok;
    let chosen: Vec<u32> = instances.iter().copied().filter(ok).collect();
    if plan.run.start == Start::Rest || chosen.is_empty() || progress.stopped() {
        return Ok(());
    }
    let mut moved = plan.only(&chosen);
    let mut stations = vec![Station::FREE; plan.cases.len()];
    for &i in &chosen {
        let case = &plan.cases[i as usize];
        let driven = &plan.drives[case.drive as usize];
        let (modes, amplitude) = (&driven.kept.modes, driven.free.tip.norm());
        let slow = (0..modes.len()).min_by(|a, b| modes[*a].omega.total_cmp(&modes[*b].omega));
        let station = &mut stations[i as usize];
        *station = Station::free(plan, i);
        station.x[slow.unwrap_or(0)] = plan.policy.shift * plan.run.accuracy * amplitude;
    }
    moved.stations = Some(Arc::new(stations));
    progress.foresee(moved.instance_steps());
    let others = engine.run(&moved, progress)?.results;
    for i in chosen {
        let (ours, other) = (&results[i as usize], &others[i as usize]);
        let same =
            other.status == ours.status && difference(plan, i as usize, other, ours) <= plan.run.accuracy;
        if !same && other.status != Status::NotRun {
            results[i as usize].status = Status::Sensitive;
        }
    }
    Ok(())
}

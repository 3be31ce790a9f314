//! Whether a tiny change of the start moves a result.

use super::difference_scale::scaled_difference;
use crate::engine::{Engine, EngineError, Finished, Progress};
use crate::observe::Status;
use crate::plan::{Plan, SectionState};
use crate::scene::Start;

/// Marks those of `instances` that are ok but whose integrated results a tiny change of the start moves by more than the
/// requested accuracy.
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
    let shifted = |i: &u32| {
        let driven = plan.driven(*i);
        let (modes, amplitude) = (&driven.kept.modes, driven.free_amplitude());
        let slow = (0..modes.len()).min_by(|a, b| modes[*a].omega.total_cmp(&modes[*b].omega));
        let mut station = SectionState::free(plan, *i);
        station.x[slow.unwrap_or(0)] = plan.policy.shift * plan.run.accuracy * amplitude;
        station.into()
    };
    let moved = plan.part(&chosen).starting_at(chosen.iter().map(shifted).collect());
    progress.foresee(moved.instance_steps());
    let others = engine.run(&moved, progress)?.results;
    for (i, other) in chosen.into_iter().zip(&others) {
        let ours = &results[i as usize];
        let same =
            other.status == ours.status && scaled_difference(plan, i, other, ours) <= plan.run.accuracy;
        if !same && other.status != Status::NotRun {
            results[i as usize].status = Status::Sensitive;
        }
    }
    Ok(())
}

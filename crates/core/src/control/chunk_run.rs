//! Instances that run together, with all the data that takes.

use super::{Arithmetic, orbit_pair, second_orbit};
use crate::engine::Outcome;
use crate::orbit::{OrbitSolution, PeriodicState};
use crate::plan::Plan;

/// Some instances of a run, or all of a small one. See [`RunResult`](super::RunResult).
#[derive(Clone, Debug)]
pub struct ChunkRun {
    /// The plan as it ran.
    pub plan: Plan,
    pub outcome: Outcome,
    /// Error of each instance's worst observable, on that observable's scale. NaN if nothing was estimated.
    pub estimates: Vec<f64>,
    /// The part of the estimate that comes from truncated modes.
    pub truncation: Vec<f64>,
    /// Periodic state found for each instance. Empty if no states were searched for.
    pub found: Vec<Option<Box<PeriodicState>>>,
    /// Periods of each instance's last run, those of its search included.
    pub periods: Vec<u32>,
    /// For each instance, whether its curve jumped to this state from the point before. Empty without curves.
    pub jumps: Vec<bool>,
    /// For each instance, whether its result comes from a search started at its neighbours' states. Empty if none did.
    pub neighbour_started: Vec<bool>,
    pub arithmetic: Arithmetic,
    /// For each instance, the states from which others may start. Empty if none does.
    pub(super) solved: Vec<orbit_pair::OrbitPair>,
    /// For each instance, the result of its search from the lever at rest. Empty without such searches.
    pub(super) from_rest: Vec<Option<second_orbit::SecondState>>,
}

impl ChunkRun {
    /// A run with its estimates and their truncation parts.
    pub(super) fn new(
        plan: Plan,
        OrbitSolution { outcome, found, periods, jumps }: OrbitSolution,
        (estimates, truncation): (Vec<f64>, Vec<f64>),
        arithmetic: Arithmetic,
    ) -> Self {
        Self {
            plan,
            outcome,
            estimates,
            truncation,
            found,
            periods,
            jumps,
            neighbour_started: Vec::new(),
            arithmetic,
            solved: Vec::new(),
            from_rest: Vec::new(),
        }
    }

    /// A run without estimates.
    pub(super) fn unestimated(plan: Plan, solution: OrbitSolution, arithmetic: Arithmetic) -> Self {
        let unknown = vec![f64::NAN; plan.len()];
        Self::new(plan, solution, (unknown.clone(), unknown), arithmetic)
    }
}

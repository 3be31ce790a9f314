//! Another run of the instances, with other steps or bases, from their own earlier states.

use super::neighbour_start::{OnFailure, solve_from_neighbours};
use super::quasi_newton::{own_nodes, own_starts};
use super::{OrbitSolution, PeriodicState};
use crate::engine::{Engine, EngineError, Progress};
use crate::plan::Plan;

/// Like [`solve`](super::solve), but an instance with a state in `near` starts from it as from a neighbour's, with its
/// Jacobian. A search follows where this fails.
pub(super) fn solve_from_own_states(
    plan: &Plan,
    near: &[Option<&PeriodicState>],
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<OrbitSolution, EngineError> {
    let nodes = own_nodes(plan, near);
    Ok(solve_from_neighbours(
        plan,
        &own_starts(&nodes),
        (near, OnFailure::SettleThenIntegrate),
        engine,
        progress,
    )?
    .0)
}

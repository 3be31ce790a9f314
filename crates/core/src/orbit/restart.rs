//! Another run of the instances, with other steps or bases, from their own earlier states.

use super::neighbour_start::{OnFailure, solve_from_neighbours};
use super::stencil::{SolvedNeighbour, Stencil, StencilPoint, StencilStart};
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
    let node = |i: u32| SolvedNeighbour::of_own_state(plan, i, near[i as usize]?);
    let nodes: Vec<Option<SolvedNeighbour>> = plan.instances().map(node).collect();
    let leads: Vec<StencilStart> =
        nodes.iter().map(|node| node.as_ref().map_or(StencilStart::None, single_point)).collect();
    Ok(solve_from_neighbours(plan, &leads, (near, OnFailure::Integrate), engine, progress)?.0)
}

/// A start from one state alone.
fn single_point(node: &SolvedNeighbour) -> StencilStart<'_> {
    Stencil::alone(StencilPoint { node, before: None, weight: 1.0, nearest: 1.0 }).into()
}

//! Another run of instances, with other steps or bases, from their own states in the run before.

use super::led::{Patience, from_neighbours};
use super::node::{Hint, Lead, Neighbour, Node};
use super::{PeriodicState, Settled};
use crate::engine::{Engine, EngineError, Progress};
use crate::plan::Plan;

/// As [`run`](super::run): each instance that has a state in `near` begins there as at a neighbour's, with what is known of the
/// map's slope, and is searched for where that leads to none.
pub(super) fn run(
    plan: &Plan,
    near: &[Option<&PeriodicState>],
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<Settled, EngineError> {
    let node = |i: u32| Node::own(plan, i, near[i as usize]?);
    let nodes: Vec<Option<Node>> = plan.instances().map(node).collect();
    let leads: Vec<Lead> = nodes.iter().map(|node| node.as_ref().map_or(Lead::None, alone)).collect();
    Ok(from_neighbours(plan, &leads, (near, Patience::Waits), engine, progress)?.0)
}

/// Where one state alone leads to.
fn alone(node: &Node) -> Lead<'_> {
    Hint::alone(Neighbour { node, before: None, weight: 1.0, nearest: 1.0 }).into()
}

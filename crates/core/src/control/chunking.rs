//! How the instances of a plan are divided into chunks.

use super::choices::Choices;
use super::hierarchy::SweepBlocks;
use crate::plan::Plan;

/// How a plan's instances are divided: the order in which they run, and which make a chunk. Every run of the plan with
/// the same choices divides them so.
pub struct Chunking {
    order: Vec<u32>,
    /// Where in the order each chunk ends.
    ends: Vec<usize>,
    /// Where the chunks are blocks whose instances begin at one another's states.
    pub(super) blocks: Option<SweepBlocks>,
}

/// Chunks that each share of a run has at least, as far as there are instances: so no share waits long for another.
const MIN_CHUNKS_PER_SHARE: usize = 4;
/// Fewest instances of them: a lane's worth.
const MIN_CHUNK_INSTANCES: usize = 16;

impl Chunking {
    /// Of the scene's plan, for a run in so many shares.
    pub fn of(planned: &Plan, choices: &Choices, shares: usize) -> Self {
        if let Some(blocks) = choices.neighbours.then(|| SweepBlocks::of(planned)).flatten() {
            let end = |end: &mut usize, size: usize| {
                *end += size;
                Some(*end)
            };
            let ends = blocks.sizes().into_iter().scan(0, end).collect();
            return Self { order: blocks.order.clone(), ends, blocks: Some(blocks) };
        }
        let even = match shares {
            ..=1 => usize::MAX,
            _ => planned.len().div_ceil(MIN_CHUNKS_PER_SHARE * shares).max(MIN_CHUNK_INSTANCES),
        };
        let size = choices.portion.min(even).max(1);
        // In the order that the scene's plan runs them; curves stay whole.
        let (order, size) = match planned.ensemble.curves {
            Some(_) => (planned.instances().collect(), whole_curves(planned, size)),
            None => (planned.by_class(), size),
        };
        let ends =
            (1..=order.len().div_ceil(size)).map(|n| n.saturating_mul(size).min(order.len())).collect();
        Self { order, ends, blocks: None }
    }

    /// How many chunks there are.
    pub fn len(&self) -> usize {
        self.ends.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.ends.is_empty()
    }

    /// The instances of a chunk, by their numbers in the plan.
    pub fn chunk(&self, number: usize) -> &[u32] {
        let from = if number == 0 { 0 } else { self.ends[number - 1] };
        &self.order[from..self.ends[number]]
    }
}

/// Curves that are followed side by side, at least: enough to fill a processor's lanes.
const CURVES_PER_CHUNK: usize = 32;

/// The size of a chunk, so that no curve is in two.
pub(super) fn whole_curves(plan: &Plan, size: usize) -> usize {
    match plan.ensemble.curves {
        Some(curves) => {
            let long = (curves.points * curves.ways) as usize;
            long * (size / long).max(CURVES_PER_CHUNK)
        }
        None => size,
    }
}

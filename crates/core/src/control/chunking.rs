//! How a plan's instances are divided into chunks.

use super::choices::Choices;
use super::hierarchy::SweepBlocks;
use crate::plan::Plan;

/// The order in which a plan's instances run, and the chunks it is cut into. Every run of the plan with the same choices and
/// shares has the same chunks.
pub struct Chunking {
    order: Vec<u32>,
    /// End of each chunk in the order.
    ends: Vec<usize>,
    /// Present if the chunks are blocks whose instances start from one another's states.
    pub(super) blocks: Option<SweepBlocks>,
}

/// Least number of chunks in each share of a run, if there are enough instances: no share then waits long for another.
const MIN_CHUNKS_PER_SHARE: usize = 4;
/// Smallest size of these chunks: it fills a lane.
const MIN_CHUNK_INSTANCES: usize = 16;

impl Chunking {
    /// Divides the scene's plan for a run in this many shares.
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
        // Use the order in which the plan runs; curves stay whole.
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

/// Least number of curves followed side by side: they fill a processor's lanes.
const CURVES_PER_CHUNK: usize = 32;

/// Adjusts the chunk size so that no curve is cut.
pub(super) fn whole_curves(plan: &Plan, size: usize) -> usize {
    match plan.ensemble.curves {
        Some(curves) => {
            let long = (curves.points * curves.ways) as usize;
            long * (size / long).max(CURVES_PER_CHUNK)
        }
        None => size,
    }
}

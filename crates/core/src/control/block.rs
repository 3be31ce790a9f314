//! A block of a sweep, whose instances begin at one another's states.

use super::around::Around;
use super::choices::Choices;
use super::first::First;
use super::order::Order;
use super::solved::Solved;
use super::{Part, unfinished};
use crate::engine::{Engine, EngineError, Progress};
use crate::plan::{BasisRule, Plan};
use crate::steady::Linear;
use rayon::prelude::*;
use std::collections::HashMap;

/// Instances that may be taken to their ends in any order, once those of the batches before them are.
struct Batch<'a> {
    instances: Vec<u32>,
    /// Where they stand among those before.
    level: Option<(&'a Order<'a>, usize)>,
    /// Whether later ones begin at their states.
    leads_on: bool,
}

/// A block, and what was chosen for it; see [`First`].
pub(super) struct Block<'a> {
    pub plan: Plan,
    pub poorer: Option<Vec<BasisRule>>,
    pub left_out: Vec<f64>,
    pub choices: &'a Choices,
}

/// Takes a block to its end, batch after batch, each in pieces of the engine's size, some of them at once. Whoever stops a
/// run keeps the pieces that are done.
pub(super) fn run(
    block: Block,
    order: &Order,
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<Part, EngineError> {
    let (size, at_once) = engine.portions();
    let mut whole = Part::not_begun(block.plan.clone(), block.choices);
    whole.left_out.clone_from(&block.left_out);
    whole.solved = vec![Solved::Unknown; whole.plan.len()];
    whole.neighbour_started = vec![false; whole.plan.len()];
    'batches: for batch in batches(&block.plan, order) {
        let pieces: Vec<&[u32]> = batch.instances.chunks(size).collect();
        for some in pieces.chunks(at_once.max(1)) {
            if progress.stopped() {
                break 'batches;
            }
            let one = |piece: &&[u32]| piece_of(&block, (&batch, piece), &whole, engine, progress);
            let done: Vec<_> = match some {
                [piece] => vec![one(piece)],
                _ => some.par_iter().map(one).collect(),
            };
            for (piece, part) in some.iter().zip(done) {
                whole.take(piece, part?);
            }
        }
    }
    // Nobody begins at them any more.
    whole.solved = Vec::new();
    Ok(whole)
}

/// Within a batch those of one shape stand together, in the order in which they stand in the sweep: their neighbours' states
/// are then met one after the other in memory, too.
fn batches<'a>(plan: &Plan, order: &'a Order<'a>) -> Vec<Batch<'a>> {
    let alike = |mut points: Vec<u32>| -> Vec<u32> {
        points.sort_by_cached_key(|i| plan.shape(*i));
        points
    };
    let scouts = Batch { instances: alike(order.scouts()), level: None, leads_on: true };
    let later = (0..order.levels()).map(|n| Batch {
        instances: alike(order.level(n)),
        level: Some((order, n)),
        leads_on: n + 1 < order.levels(),
    });
    std::iter::once(scouts).chain(later).collect()
}

/// Takes a piece of a batch to its end.
fn piece_of(
    block: &Block,
    (batch, piece): (&Batch, &[u32]),
    whole: &Part,
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<Part, EngineError> {
    let part = whole.plan.part(piece);
    let stepped = part.stepped();
    let left_out = piece.iter().map(|i| block.left_out[*i as usize]).collect();
    let poorer = block.poorer.as_ref().map(|all| piece.iter().map(|i| all[*i as usize]).collect());
    let around = batch.level.map(|level| Around::new(level, piece, &whole.solved));
    let alone = First::alone(poorer, left_out, &block.choices.precision);
    let first = First { around, leads_on: batch.leads_on, ..alone };
    unfinished::marked(part, &stepped, first, engine, progress)
}

impl Part {
    /// Takes in what became of a piece of it.
    fn take(&mut self, piece: &[u32], part: Self) {
        if !part.found.is_empty() && self.found.is_empty() {
            self.found = vec![None; self.plan.len()];
        }
        for (place, found) in piece.iter().zip(part.found) {
            // Nobody goes on from it with other steps.
            self.found[*place as usize] = found.map(|mut state| {
                state.linear = Linear::Unknown;
                state
            });
        }
        let begun = piece.iter().zip(part.neighbour_started);
        begun.for_each(|(place, begun)| self.neighbour_started[*place as usize] = begun);
        piece.iter().zip(part.solved).for_each(|(place, solved)| self.solved[*place as usize] = solved);
        let mut taken = HashMap::new();
        for (n, place) in piece.iter().enumerate() {
            let i = *place as usize;
            self.plan.take_resolution(*place, &part.plan, n as u32, &mut taken);
            self.left_out[i] = part.left_out[n];
            self.outcome.results[i] = part.outcome.results[n];
            self.estimates[i] = part.estimates[n];
            self.periods[i] = part.periods[n];
            self.arithmetic.of[i] = part.arithmetic.of[n];
        }
        self.outcome.notes.extend(part.outcome.notes);
    }
}

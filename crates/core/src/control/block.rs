//! A block of a sweep, whose instances begin at one another's states.

use super::around::Around;
use super::choices::Choices;
use super::first::{First, Poorer};
use super::order::Order;
use super::solved::Solved;
use super::{Part, unfinished};
use crate::engine::{Engine, EngineError, Progress};
use crate::observe::Status;
use crate::plan::Plan;
use crate::steady::Linear;
use rayon::prelude::*;
use std::collections::{BTreeSet, HashMap, HashSet};

/// Instances that may be taken to their ends in any order, once those of the batches before them are.
struct Batch {
    instances: Vec<u32>,
    from: Begins,
}

/// Where the instances of a batch begin.
#[derive(Clone, Copy)]
enum Begins {
    /// At the free oscillation, which does not feel the sample.
    Free,
    /// Where a search of its own does.
    Scouts,
    /// At those that stand around them, by the number of their level.
    Level(usize),
    /// At any of those next to them.
    Each,
    /// Nothing else has led to them: they are waited for.
    Wait,
}

/// A block, and what was chosen for it; see [`First`].
pub(super) struct Block<'a> {
    pub plan: Plan,
    pub poorer: Option<Poorer>,
    pub left_out: Vec<f64>,
    pub choices: &'a Choices,
}

/// Takes a block to its end, batch after batch. What no search finds is left until all batches are through: then it
/// begins at the states next to it, and only what these do not lead to is waited for. Such instances mostly stand together and
/// are alike: some of them are waited for first, and the others begin at those. Whoever stops a run keeps the pieces that are
/// done.
pub(super) fn run(
    block: Block,
    order: &Order,
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<Part, EngineError> {
    let mut whole = Part::not_begun(block.plan.clone(), block.choices);
    whole.left_out.clone_from(&block.left_out);
    whole.solved = vec![Solved::Unknown; whole.plan.len()];
    whole.neighbour_started = vec![false; whole.plan.len()];
    let mut filling = Filling { block: &block, order, whole, engine, progress };
    for batch in batches(&block.plan, order) {
        filling.carry_out(&batch)?;
    }
    filling.fill_from_known(None)?;
    let foremost = filling.foremost();
    filling.wait_for(foremost.clone())?;
    filling.fill_from_known(Some(foremost))?;
    filling.wait_for(filling.open())?;
    // Nobody begins at them any more.
    Ok(Part { solved: Vec::new(), ..filling.whole })
}

fn batches(plan: &Plan, order: &Order) -> Vec<Batch> {
    // Neighbours may touch where the free oscillation, from which an instance is to begin, does not.
    let is_free = |i: &u32| plan.steps(*i) == 0 || plan.run.both_branches && plan.is_free(*i);
    let free = Batch { instances: plan.instances().filter(is_free).collect(), from: Begins::Free };
    let stepped = |points: Vec<u32>| alike(plan, points.into_iter().filter(|i| !is_free(i)).collect());
    let scouts = Batch { instances: stepped(order.scouts()), from: Begins::Scouts };
    let level = |n| Batch { instances: stepped(order.level(n)), from: Begins::Level(n) };
    [free, scouts].into_iter().chain((0..order.levels()).map(level)).collect()
}

/// Those of one shape together, in the order in which they stand in the sweep: their neighbours' states are then met one after
/// the other in memory, too.
fn alike(plan: &Plan, mut points: Vec<u32>) -> Vec<u32> {
    points.sort_by_cached_key(|i| plan.shape(*i));
    points
}

/// A block on its way.
struct Filling<'a> {
    block: &'a Block<'a>,
    order: &'a Order<'a>,
    whole: Part,
    engine: &'a dyn Engine,
    progress: &'a Progress,
}

impl Filling<'_> {
    /// Takes a batch to its end in pieces of the engine's size, some of them at once.
    fn carry_out(&mut self, batch: &Batch) -> Result<(), EngineError> {
        let (size, at_once) = self.engine.portions();
        let pieces: Vec<&[u32]> = batch.instances.chunks(size).collect();
        for some in pieces.chunks(at_once.max(1)) {
            if self.progress.stopped() {
                break;
            }
            let one = |piece: &&[u32]| self.piece(batch, piece);
            let done: Vec<_> = match some {
                [piece] => vec![one(piece)],
                _ => some.par_iter().map(one).collect(),
            };
            for (piece, part) in some.iter().zip(done) {
                self.whole.take(piece, part?);
            }
        }
        Ok(())
    }

    /// Takes a piece of a batch to its end.
    fn piece(&self, batch: &Batch, piece: &[u32]) -> Result<Part, EngineError> {
        let Self { block, order, whole, .. } = self;
        let part = block.plan.part(piece);
        let stepped = part.stepped();
        let left_out = piece.iter().map(|i| block.left_out[*i as usize]).collect();
        let poorer = block.poorer.as_ref().map(|all| all.part(piece));
        let around = match batch.from {
            Begins::Free => None,
            Begins::Scouts => Some(Around::scouts(&whole.solved)),
            Begins::Level(n) => Some(Around::level((order, n), piece, &whole.solved)),
            Begins::Each => Some(Around::each(order, piece, &whole.solved)),
            Begins::Wait => Some(Around::waited_for(&whole.solved)),
        };
        let alone = First::alone(poorer, left_out, &block.choices.precision);
        let first = First { around, ..alone };
        unfinished::marked(part, &stepped, first, self.engine, self.progress)
    }

    /// Instances without a result, in the order of their numbers.
    fn open(&self) -> Vec<u32> {
        let open = |i: &u32| {
            let status = self.whole.outcome.results[*i as usize].status;
            status == Status::NotRun && self.block.plan.steps(*i) > 0
        };
        self.block.plan.instances().filter(open).collect()
    }

    /// Of open instances that stand next to one another, those that come before all that are next to them.
    fn foremost(&self) -> Vec<u32> {
        let open: BTreeSet<u32> = self.open().into_iter().collect();
        let before = |i: u32, other: u32| self.order.number(other) < self.order.number(i);
        let first =
            |i: &u32| self.order.beside(*i).iter().all(|other| !open.contains(other) || !before(*i, *other));
        open.iter().copied().filter(first).collect()
    }

    fn wait_for(&mut self, instances: Vec<u32>) -> Result<(), EngineError> {
        self.carry_out(&Batch { instances, from: Begins::Wait })
    }

    /// Open instances begin at the states next to them, round after round: each where one of these is new. In the first round
    /// those of `latest` are, or all.
    fn fill_from_known(&mut self, latest: Option<Vec<u32>>) -> Result<(), EngineError> {
        let mut fresh: Option<HashSet<u32>> = latest.map(|latest| latest.into_iter().collect());
        loop {
            let new = |i: &u32| fresh.as_ref().is_none_or(|fresh| fresh.contains(i));
            let known = |i: &u32| self.whole.solved[*i as usize].nodes().is_some();
            let beside = |i: &u32| self.order.beside(*i).iter().any(|other| new(other) && known(other));
            let instances: Vec<u32> = self.open().into_iter().filter(beside).collect();
            if instances.is_empty() || self.progress.stopped() {
                return Ok(());
            }
            let batch = Batch { instances, from: Begins::Each };
            self.carry_out(&batch)?;
            let led = |i: &u32| self.whole.solved[*i as usize].nodes().is_some();
            fresh = Some(batch.instances.into_iter().filter(led).collect());
        }
    }
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

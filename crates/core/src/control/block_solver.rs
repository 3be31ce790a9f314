//! Solves a block of a sweep, whose instances start from one another's states.

use super::choices::Choices;
use super::first_estimate::{EstimateInputs, PoorerBasis};
use super::hierarchy::Hierarchy;
use super::orbit_pair::OrbitPair;
use super::stencils::Stencils;
use super::{ChunkRun, interruption};
use crate::engine::{Engine, EngineError, Progress};
use crate::observe::Status;
use crate::orbit::Jacobian;
use crate::plan::Plan;
use rayon::prelude::*;
use std::collections::{BTreeSet, HashMap, HashSet};

/// Instances that may run in any order once the batches before them are done.
struct BlockBatch {
    instances: Vec<u32>,
    start: BatchStart,
}

/// Where the searches of a batch start.
#[derive(Clone, Copy)]
enum BatchStart {
    /// The free oscillation, which does not feel the sample.
    Free,
    /// The start of any single search.
    Coarse,
    /// Solved instances around them; the number is their level.
    Level(usize),
    /// Any solved instance next to them.
    Neighbours,
    /// Nothing has led to them, so they are integrated to steady state.
    Integrate,
}

/// A block and the choices for it; see [`EstimateInputs`].
pub(super) struct BlockSolver<'a> {
    pub plan: Plan,
    pub poorer_basis: Option<PoorerBasis>,
    pub truncation: Vec<f64>,
    pub choices: &'a Choices,
}

/// Runs a block batch by batch. Instances that no search finds wait until all batches are done. They then start from adjacent
/// states, and time integration takes the rest. As such instances mostly lie together and resemble each other, some are
/// integrated first and the others start from these. A stopped run keeps its finished pieces.
pub(super) fn run(
    block: BlockSolver,
    order: &Hierarchy,
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<ChunkRun, EngineError> {
    let mut whole = ChunkRun::not_begun(block.plan.clone(), block.choices);
    whole.truncation.clone_from(&block.truncation);
    whole.solved = vec![OrbitPair::Unknown; whole.plan.len()];
    whole.neighbour_started = vec![false; whole.plan.len()];
    let mut filling = BlockRun { block: &block, order, whole, engine, progress };
    for batch in batches(&block.plan, order) {
        filling.run_batch(&batch)?;
    }
    filling.solve_from_known(None)?;
    let foremost = filling.front();
    filling.integrate(foremost.clone())?;
    filling.solve_from_known(Some(foremost))?;
    filling.integrate(filling.unsolved())?;
    // No further search starts from the states.
    Ok(ChunkRun { solved: Vec::new(), ..filling.whole })
}

fn batches(plan: &Plan, order: &Hierarchy) -> Vec<BlockBatch> {
    // With both branches, a free instance starts from the free oscillation, while its neighbours may touch.
    let is_free = |i: &u32| plan.steps(*i) == 0 || plan.run.both_branches && plan.is_free(*i);
    let free = BlockBatch { instances: plan.instances().filter(is_free).collect(), start: BatchStart::Free };
    let stepped = |points: Vec<u32>| shape_order(plan, points.into_iter().filter(|i| !is_free(i)).collect());
    let scouts = BlockBatch { instances: stepped(order.coarse()), start: BatchStart::Coarse };
    let level = |n| BlockBatch { instances: stepped(order.level(n)), start: BatchStart::Level(n) };
    [free, scouts].into_iter().chain((0..order.levels()).map(level)).collect()
}

/// Puts instances of one shape together, in the order of the sweep, so that their neighbours' states are close in memory,
/// too.
fn shape_order(plan: &Plan, mut points: Vec<u32>) -> Vec<u32> {
    points.sort_by_cached_key(|i| plan.shape(*i));
    points
}

/// A block in progress.
struct BlockRun<'a> {
    block: &'a BlockSolver<'a>,
    order: &'a Hierarchy<'a>,
    whole: ChunkRun,
    engine: &'a dyn Engine,
    progress: &'a Progress,
}

impl BlockRun<'_> {
    /// Runs a batch in pieces of the engine's size, several at once.
    fn run_batch(&mut self, batch: &BlockBatch) -> Result<(), EngineError> {
        let (size, at_once) = self.engine.portions();
        let pieces: Vec<&[u32]> = batch.instances.chunks(size).collect();
        for some in pieces.chunks(at_once.max(1)) {
            if self.progress.stopped() {
                break;
            }
            let one = |run_chunk: &&[u32]| self.piece(batch, run_chunk);
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

    /// Runs a piece of a batch.
    fn piece(&self, batch: &BlockBatch, piece: &[u32]) -> Result<ChunkRun, EngineError> {
        let Self { block, order, whole, .. } = self;
        let part = block.plan.part(piece);
        let stepped = part.stepped();
        let left_out = piece.iter().map(|i| block.truncation[*i as usize]).collect();
        let poorer = block.poorer_basis.as_ref().map(|all| all.part(piece));
        let around = match batch.start {
            BatchStart::Free => None,
            BatchStart::Coarse => Some(Stencils::coarse(&whole.solved)),
            BatchStart::Level(n) => Some(Stencils::level((order, n), piece, &whole.solved)),
            BatchStart::Neighbours => Some(Stencils::each(order, piece, &whole.solved)),
            BatchStart::Integrate => Some(Stencils::integrated(&whole.solved)),
        };
        let alone = EstimateInputs::alone(poorer, left_out, &block.choices.precision);
        let first = EstimateInputs { around, ..alone };
        interruption::marked(part, &stepped, first, self.engine, self.progress)
    }

    /// Instances without a result, in the order of their numbers.
    fn unsolved(&self) -> Vec<u32> {
        let open = |i: &u32| {
            let status = self.whole.outcome.results[*i as usize].status;
            status == Status::NotRun && self.block.plan.steps(*i) > 0
        };
        self.block.plan.instances().filter(open).collect()
    }

    /// Unsolved instances that have no unsolved neighbour before them.
    fn front(&self) -> Vec<u32> {
        let open: BTreeSet<u32> = self.unsolved().into_iter().collect();
        let before = |i: u32, other: u32| self.order.number(other) < self.order.number(i);
        let first = |i: &u32| {
            self.order.adjacent(*i).iter().all(|other| !open.contains(other) || !before(*i, *other))
        };
        open.iter().copied().filter(first).collect()
    }

    fn integrate(&mut self, instances: Vec<u32>) -> Result<(), EngineError> {
        self.run_batch(&BlockBatch { instances, start: BatchStart::Integrate })
    }

    /// Starts unsolved instances from adjacent states, round after round. An instance runs if one of these states is new. In
    /// the first round those of `latest` are new, or all.
    fn solve_from_known(&mut self, latest: Option<Vec<u32>>) -> Result<(), EngineError> {
        let mut fresh: Option<HashSet<u32>> = latest.map(|latest| latest.into_iter().collect());
        loop {
            let new = |i: &u32| fresh.as_ref().is_none_or(|fresh| fresh.contains(i));
            let known = |i: &u32| self.whole.solved[*i as usize].neighbours().is_some();
            let beside = |i: &u32| self.order.adjacent(*i).iter().any(|other| new(other) && known(other));
            let instances: Vec<u32> = self.unsolved().into_iter().filter(beside).collect();
            if instances.is_empty() || self.progress.stopped() {
                return Ok(());
            }
            let batch = BlockBatch { instances, start: BatchStart::Neighbours };
            self.run_batch(&batch)?;
            let led = |i: &u32| self.whole.solved[*i as usize].neighbours().is_some();
            fresh = Some(batch.instances.into_iter().filter(led).collect());
        }
    }
}

impl ChunkRun {
    /// Takes the results of a piece.
    fn take(&mut self, piece: &[u32], part: Self) {
        if !part.found.is_empty() && self.found.is_empty() {
            self.found = vec![None; self.plan.len()];
        }
        for (place, found) in piece.iter().zip(part.found) {
            // No search with other steps starts from it.
            self.found[*place as usize] = found.map(|mut state| {
                state.jacobian = Jacobian::Unknown;
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
            self.truncation[i] = part.truncation[n];
            self.outcome.results[i] = part.outcome.results[n];
            self.estimates[i] = part.estimates[n];
            self.periods[i] = part.periods[n];
            self.arithmetic.of[i] = part.arithmetic.of[n];
        }
        self.outcome.notes.extend(part.outcome.notes);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::control;
    use crate::engine::{Cpu, Outcome};
    use crate::test_plans::plan_of;

    /// The CPU engine, which confirms no state of plans with at least so many steps per period: every motion seems unsteady
    /// in its first five periods.
    struct Unconfirming {
        steps: u32,
    }

    impl Engine for Unconfirming {
        fn device(&self) -> String {
            "unconfirming".into()
        }

        fn run(&self, plan: &Plan, progress: &Progress) -> Result<Outcome, EngineError> {
            let mut outcome = Cpu::default().run(plan, progress)?;
            if plan.run.periods <= 5 && plan.steps(0) >= self.steps {
                outcome.results.iter_mut().for_each(|one| one.status = Status::NotSteady);
            }
            Ok(outcome)
        }
    }

    /// Truth: the same sweep with an engine that confirms states.
    #[test]
    fn states_that_no_run_confirms_are_integrated_as_instances_without_a_state_are() {
        let text = r#"
            [instrument.cantilever]
            modes = [{ stiffness = "40 N/m", frequency = "300 kHz", quality_factor = 10 }]
            [contact]
            law = "hertz"
            [drive]
            on = "tip"
            frequency = "300 kHz"
            free_amplitude = "20 nm"
            [sweep]
            "sample.youngs_modulus" = { from = "1 GPa", to = "2 GPa", points = 32, scale = "log" }
            "approach.gap" = { from = "14 nm", to = "16 nm", points = 32 }
            [run]
            steady = "search"
            accuracy = 1e-2
            periods = 100
            [output]
            observables = ["amplitude"]
        "#;
        let plan = plan_of(text);
        let run = |engine: &dyn Engine| control::run(&plan, engine, &Progress::default()).expect("it runs");
        let truth = run(&Cpu::default());
        // The first run finds states, and the second confirms none.
        let integrated = run(&Unconfirming { steps: truth.plan.steps(0) });
        let amplitude = plan.driven(0).free_amplitude();
        for (i, (one, other)) in integrated.results.iter().zip(truth.results.iter()).enumerate() {
            assert_eq!((one.status, other.status), (Status::Ok, Status::Ok), "instance {i}");
            let off = (one.measured.harmonics[0] - other.measured.harmonics[0]).abs() / amplitude;
            assert!(off < 1e-2, "instance {i}: amplitudes differ by {off:e}");
        }
    }
}

//! Periodic states by Broyden's method from neighbours' predictions: one measured period gives the residual.

use super::residual::RESIDUAL_TOL;
use super::size_dispatch::{BySize, by_size, with_size};
use super::stencil::{SolvedNeighbour, Stencil, StencilPoint, StencilStart};
use super::tolerances::{newton_tol, scale};
use super::transfer_cache::TransferCache;
use super::{Jacobian, OrbitSolution, PeriodicState};
use crate::engine::{
    Corrections, Engine, EngineError, INSTANCES_PER_BATCH, Prediction, Predictions, ProfileSection, Progress,
    in_double,
};
use crate::kernel::broyden::Phase;
use crate::periodic::{Floquet, Memory, Size};
use crate::plan::{Plan, Precision};
use nalgebra::{DefaultAllocator, DimName};
use rayon::prelude::*;

/// Least number of instances in one thread's batch, if there are more.
const MIN_BATCH_INSTANCES: usize = 512;

/// Batch size of a thread for `count` instances: as large as possible while every thread has a batch.
fn batch_size(count: usize) -> usize {
    count.div_ceil(rayon::current_num_threads()).clamp(MIN_BATCH_INSTANCES, INSTANCES_PER_BATCH)
}

/// Corrects the predictions of instances that have a stencil, with forces as accurate as travel. Returns results, states and
/// periods where this converges; other instances stay as not run, and only their periods count.
pub(super) fn correct(
    plan: &Plan,
    leads: &[StencilStart],
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<OrbitSolution, EngineError> {
    let mut settled = correct_travel(plan, leads, engine, progress)?;
    // In f32 every state is measured again anyway.
    if plan.precision == Precision::F64 {
        settled.tighten_vague_forces(plan, &predicted(plan, leads), engine, progress)?;
    }
    Ok(settled)
}

/// The same, with a state confirmed by its travel alone.
pub(super) fn correct_travel(
    plan: &Plan,
    leads: &[StencilStart],
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<OrbitSolution, EngineError> {
    let tried = predicted(plan, leads);
    let double = in_double(engine);
    progress.task("from neighbours", 0);
    let mut settled = OrbitSolution::not_run(plan);
    let part = if double.by_threads() { batch_size(tried.len()) } else { tried.len().max(1) };
    let parts: Vec<_> = by_size(plan, &tried)
        .into_iter()
        .flat_map(|(size, some)| some.chunks(part).map(|some| (size, some.to_vec())).collect::<Vec<_>>())
        .collect();
    let one = |(size, some): &(usize, Vec<u32>)| {
        with_size(*size, CorrectionBatch { plan, some, leads, engine: double, progress })
    };
    let done: Vec<_> = parts.par_iter().map(one).collect();
    let mut anew = Vec::new();
    for part in done {
        let Some(CorrectedStates { guessed, arrivals, states }) = part? else { continue };
        settled.outcome.notes.extend(arrivals.notes);
        for ((one, arrived), state) in guessed.iter().zip(&arrivals.all).zip(states) {
            let i = one.instance as usize;
            settled.periods[i] = arrived.periods;
            if state.is_some() {
                (settled.outcome.results[i], settled.found[i]) = (arrived.finished, state);
                if settled.recount_contacts(plan, one.instance, arrived.touching) {
                    anew.push(one.instance);
                }
            }
        }
    }
    if plan.precision == Precision::F64 && !progress.stopped() {
        let unsure = settled.confirm_by_residual(plan, &anew, double, progress)?;
        settled.run_on(&plan.part(&unsure), &unsure, double, progress)?;
        settled.drop_unconfirmed(&unsure);
    }
    Ok(settled)
}

/// The instances that have a stencil.
fn predicted(plan: &Plan, leads: &[StencilStart]) -> Vec<u32> {
    let hinted = |i: &u32| matches!(leads[*i as usize], StencilStart::Stencil(_));
    plan.instances().filter(|i| plan.steps(*i) > 0 && hinted(i)).collect()
}

/// Corrects the states `near` of the plan's instances; the others, and what this does not correct, stay as not run.
pub(super) fn correct_own_states(
    plan: &Plan,
    near: &[Option<&PeriodicState>],
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<OrbitSolution, EngineError> {
    correct_travel(plan, &own_starts(&own_nodes(plan, near)), engine, progress)
}

/// The states `near` of the plan's instances as neighbours of themselves.
pub(super) fn own_nodes(plan: &Plan, near: &[Option<&PeriodicState>]) -> Vec<Option<SolvedNeighbour>> {
    let node = |i: u32| {
        let state = near[i as usize]?;
        SolvedNeighbour::new((plan, i), state, state.jacobian.undoes()?, None)
    };
    plan.instances().map(node).collect()
}

/// Starts from such a node alone.
pub(super) fn own_starts(nodes: &[Option<SolvedNeighbour>]) -> Vec<StencilStart<'_>> {
    nodes.iter().map(|node| node.as_ref().map_or(StencilStart::None, single_point)).collect()
}

/// A start from one state alone.
fn single_point(node: &SolvedNeighbour) -> StencilStart<'_> {
    Stencil::alone(StencilPoint { node, before: None, weight: 1.0, nearest: 1.0 }).into()
}

/// Predictions, the correction of each, and the state it has led to.
struct CorrectedStates {
    guessed: Vec<Prediction>,
    arrivals: Corrections,
    states: Vec<Option<Box<PeriodicState>>>,
}

/// Instances whose states have equally many numbers.
struct CorrectionBatch<'a> {
    plan: &'a Plan,
    some: &'a [u32],
    /// By instance of the plan.
    leads: &'a [StencilStart<'a>],
    engine: &'a dyn Engine,
    progress: &'a Progress,
}

impl BySize for CorrectionBatch<'_> {
    type Output = Result<Option<CorrectedStates>, EngineError>;

    fn run<D: Size + DimName>(self) -> Self::Output
    where
        DefaultAllocator: Memory<D>,
    {
        let Self { plan, engine, progress, .. } = self;
        let Some(PredictedStates { mut guesses, multipliers }) = self.known::<D>() else { return Ok(None) };
        let arrivals = engine.broyden(plan, &mut guesses, progress)?;
        let found = |n: usize| {
            let arrived = &arrivals.all[n];
            let steady = arrived.phase == Phase::Found && arrived.finished.status.is_steady();
            steady.then(|| corrected_state(plan, (&guesses, n), multipliers[n]))
        };
        let told = (0..guesses.all.len()).into_par_iter().with_min_len(MIN_BATCH_INSTANCES).map(found);
        let states = progress.timed(ProfileSection::Algebra, || told.collect());
        Ok(Some(CorrectedStates { guessed: guesses.all, arrivals, states }))
    }
}

/// Predictions from neighbours.
struct PredictedStates {
    guesses: Predictions,
    /// By prediction.
    multipliers: Vec<f64>,
}

impl CorrectionBatch<'_> {
    /// The predictions of all instances; `None` if there are no instances.
    fn known<D: Size + DimName>(&self) -> Option<PredictedStates>
    where
        DefaultAllocator: Memory<D>,
    {
        let many = if self.engine.by_threads() { self.some.len().max(1) } else { MIN_BATCH_INSTANCES };
        let parts: Vec<PredictedStates> =
            self.some.par_chunks(many).map(|some| self.guessed::<D>(some)).collect();
        parts.into_iter().reduce(|mut all, part| {
            all.guesses.append(part.guesses);
            all.multipliers.extend(part.multipliers);
            all
        })
    }

    fn guessed<D: Size + DimName>(&self, some: &[u32]) -> PredictedStates
    where
        DefaultAllocator: Memory<D>,
    {
        let Self { plan, leads, .. } = self;
        let mut turns = TransferCache::<D>::new();
        self.progress.timed(ProfileSection::Algebra, || {
            let mut guesses = Predictions::new(D::DIM, newton_tol(plan), RESIDUAL_TOL * plan.run.accuracy);
            let mut multipliers = Vec::with_capacity(some.len());
            guesses.reserve(some.len());
            for &i in some {
                let hint = leads[i as usize].stencil();
                // The neighbours of some instances are no guide.
                let Some(guess) = hint.and_then(|hint| hint.predict::<D>(plan, i, &mut turns)) else {
                    continue;
                };
                let one = Prediction { instance: i, touching: guess.touching, scale: scale(plan, i) };
                guesses.push(one, guess.state_for.as_slice(), guess.resolvent.as_slice());
                multipliers.push(guess.multiplier);
            }
            PredictedStates { guesses, multipliers }
        })
    }
}

/// The state that a prediction has led to.
fn corrected_state(plan: &Plan, (guesses, n): (&Predictions, usize), multiplier: f64) -> Box<PeriodicState> {
    let (one, undoes) = (guesses.all[n], guesses.undoes(n));
    let norm = undoes.iter().map(|value| value * value).sum::<f64>().sqrt();
    // A state is large, so it is filled in place.
    let (steps, kept) = (plan.steps(one.instance), &plan.driven(one.instance).kept);
    let mut state = Box::new(PeriodicState::unknown(steps, kept));
    let (x, u) = guesses.place(n).split_at(guesses.numbers / 2);
    state.section.x[..x.len()].copy_from_slice(x);
    state.section.u[..u.len()].copy_from_slice(u);
    state.section.touching = one.touching;
    state.floquet = Floquet { multiplier, sigma_min: 1.0 / norm };
    state.jacobian = Jacobian::Resolvent(undoes.iter().map(|value| *value as f32).collect());
    state
}

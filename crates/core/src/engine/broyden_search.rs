//! Searches by Broyden's method, from predictions with an approximate Jacobian. One measured period gives the residual, and a
//! step leads to the next state, until one is periodic.

use super::return_map::{CpuReturnMap, MapPassage};
use super::{EngineError, Finished, Noted, ProfileSection, Progress};
use crate::kernel::broyden::{Arrival, Goal, Phase, ROUNDS, Standing, stride};
use crate::kernel::{LENGTH, Rounding};
use crate::plan::Plan;
use rayon::prelude::*;

/// Most instances in one thread's batch: the more, the fewer of a processor's lanes are empty in the last rounds.
pub const INSTANCES_PER_BATCH: usize = 2048;

/// Predicted periodic states of some instances, and approximate Jacobians there.
#[derive(Clone, Debug)]
pub struct Predictions {
    /// Numbers of each state: travels of as many modes as [`state_modes`](crate::kernel::broyden::state_modes) says, then
    /// their rates over angular frequencies. Modes that an instance lacks are at rest.
    pub numbers: usize,
    /// Longest step that need not be taken, and largest error bound of a state that counts as found; in units of
    /// [`Prediction::scale`].
    pub near: f64,
    pub sure: f64,
    pub all: Vec<Prediction>,
    /// The predicted states, m, one after the other; after the search, the states reached.
    pub places: Vec<f64>,
    /// The resolvents (I - J)^-1, column by column, one after the other; after the search, with Broyden's updates.
    pub undoes: Vec<f64>,
}

/// An instance with a predicted state.
#[derive(Clone, Copy, Debug)]
pub struct Prediction {
    /// Number in the plan.
    pub instance: u32,
    /// Whether the tip touches where a period begins; under a law with memory also where it ends.
    pub touching: bool,
    /// Length unit of a state, m.
    pub scale: f64,
}

/// The end of a search from a prediction.
#[derive(Clone, Copy, Debug)]
pub struct Correction {
    /// `On` if the last period has led to yet another state.
    pub phase: Phase,
    /// Periods stepped.
    pub periods: u32,
    /// The last measured period, if the state at its start is found. Its steadiness is not judged by its change.
    pub finished: Finished,
    /// Whether that period ends in contact; false if no state was found.
    pub touching: bool,
}

impl Correction {
    /// Before the first period.
    pub const NOT_RUN: Self =
        Self { phase: Phase::On, periods: 0, finished: Finished::NOT_RUN, touching: false };
}

/// The ends of searches, in the order of the predictions.
pub type Corrections = Noted<Correction>;

impl Predictions {
    /// No predictions yet, for states of `numbers` numbers.
    pub fn new(numbers: usize, near: f64, sure: f64) -> Self {
        Self { numbers, near, sure, all: Vec::new(), places: Vec::new(), undoes: Vec::new() }
    }

    /// Reserves memory for `count` more.
    pub fn reserve(&mut self, count: usize) {
        self.all.reserve(count);
        self.places.reserve(count * self.numbers);
        self.undoes.reserve(count * self.numbers * self.numbers);
    }

    /// Adds a prediction, with its state, m, and the resolvent there.
    pub fn push(&mut self, guessed: Prediction, place: &[f64], undoes: &[f64]) {
        self.all.push(guessed);
        self.places.extend_from_slice(place);
        self.undoes.extend_from_slice(undoes);
    }

    /// Adds others of the same size.
    pub fn append(&mut self, mut others: Self) {
        self.all.append(&mut others.all);
        self.places.append(&mut others.places);
        self.undoes.append(&mut others.undoes);
    }

    /// The state of the n-th prediction, m.
    pub fn place(&self, n: usize) -> &[f64] {
        &self.places[n * self.numbers..][..self.numbers]
    }

    /// The resolvent there.
    pub fn undoes(&self, n: usize) -> &[f64] {
        let size = self.numbers * self.numbers;
        &self.undoes[n * size..][..size]
    }

    /// The tolerances of a prediction, in the kernel's units.
    pub(super) fn goal(&self, guessed: &Prediction) -> Goal<f64> {
        Goal { scale: guessed.scale / LENGTH, near: self.near, sure: self.sure }
    }

    /// A selection of the predictions.
    #[cfg(feature = "gpu")]
    pub(super) fn some(&self, which: &[u32]) -> Self {
        let mut some = Self::new(self.numbers, self.near, self.sure);
        which.iter().map(|n| *n as usize).for_each(|n| some.push(self.all[n], self.place(n), self.undoes(n)));
        some
    }
}

/// Runs the searches to their ends on the processor; `plan` holds their instances.
pub(super) fn all(
    plan: &Plan,
    guesses: &mut Predictions,
    rounding: Rounding,
    progress: &Progress,
) -> Result<Vec<Correction>, EngineError> {
    let numbers = guesses.numbers;
    let goals: Vec<Goal<f64>> = guesses.all.iter().map(|one| guesses.goal(one)).collect();
    let lists = guesses.all.par_chunks(INSTANCES_PER_BATCH).zip(goals.par_chunks(INSTANCES_PER_BATCH));
    let places = guesses.places.par_chunks_mut(INSTANCES_PER_BATCH * numbers);
    let undoes = guesses.undoes.par_chunks_mut(INSTANCES_PER_BATCH * numbers * numbers);
    let parts = lists.zip(places.zip(undoes)).map(|((guessed, goals), (places, undoes))| {
        BroydenBatch { plan, numbers, guessed, goals, places, undoes }.run(rounding, progress)
    });
    Ok(parts.collect::<Result<Vec<_>, _>>()?.concat())
}

/// Predictions of one thread.
struct BroydenBatch<'a> {
    plan: &'a Plan,
    numbers: usize,
    guessed: &'a [Prediction],
    goals: &'a [Goal<f64>],
    places: &'a mut [f64],
    undoes: &'a mut [f64],
}

impl BroydenBatch<'_> {
    fn run(self, rounding: Rounding, progress: &Progress) -> Result<Vec<Correction>, EngineError> {
        let Self { plan, numbers, guessed, goals, places, undoes } = self;
        let instances: Vec<u32> = guessed.iter().map(|one| one.instance).collect();
        let map =
            progress.timed(ProfileSection::Constants, || CpuReturnMap::new(plan, &instances, rounding))?;
        places.iter_mut().for_each(|number| *number /= LENGTH);
        let mut strides = vec![0.0; places.len()];
        let mut room = places.to_vec();
        let mut arrived = vec![Correction::NOT_RUN; guessed.len()];
        let mut left: Vec<usize> = (0..guessed.len()).collect();
        for round in 1..=ROUNDS {
            if left.is_empty() || progress.stopped() {
                break;
            }
            let mut passing = Vec::with_capacity(left.len());
            for (n, state) in left.iter().zip(room.chunks_exact_mut(numbers)) {
                state.copy_from_slice(&places[n * numbers..][..numbers]);
                let touching = guessed[*n].touching;
                passing.push(MapPassage { instance: *n as u32, state, touching, finite: true });
            }
            let ended = |end: &MapPassage, finished: &dyn Fn() -> Finished| {
                let n = end.instance as usize;
                let same = !plan.law(instances[n]).has_hysteresis() || end.touching == guessed[n].touching;
                let arrival = Arrival { strode: round > 1, sound: end.finite && same };
                let here = Standing {
                    place: &mut places[n * numbers..][..numbers],
                    stride: &mut strides[n * numbers..][..numbers],
                    undoes: &mut undoes[n * numbers * numbers..][..numbers * numbers],
                };
                let phase = stride(end.state, &goals[n], arrival, here);
                (arrived[n].phase, arrived[n].periods) = (phase, round);
                if phase == Phase::Found {
                    (arrived[n].finished, arrived[n].touching) = (finished(), end.touching);
                }
            };
            map.measured(plan, &mut passing, ended, progress);
            left.retain(|n| arrived[*n].phase == Phase::On);
        }
        places.iter_mut().for_each(|number| *number *= LENGTH);
        Ok(arrived)
    }
}

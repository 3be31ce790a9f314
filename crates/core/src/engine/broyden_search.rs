//! Searches that begin where something is known of the period map: from each place one measured period, and from where that
//! leads a step of Broyden's method to the next place, until one is a periodic state.

use super::return_map::{CpuReturnMap, MapPassage};
use super::{EngineError, Finished, ProfileSection, Progress};
use crate::kernel::broyden::{Arrival, Goal, Phase, ROUNDS, Standing, stride};
use crate::kernel::{LENGTH, Rounding};
use crate::plan::Plan;
use rayon::prelude::*;

/// Most instances that one thread takes along together: the more, the fewer of a processor's lanes are empty in the last rounds.
pub const INSTANCES_PER_BATCH: usize = 2048;

/// Where periodic states of some instances are expected, and what is thought of the period map there.
#[derive(Clone, Debug)]
pub struct Predictions {
    /// How many numbers each state has: travels of as many modes as [`state_modes`](crate::kernel::broyden::state_modes) tells,
    /// then their rates over angular frequencies; what an instance lacks is at rest.
    pub numbers: usize,
    /// The longest step that need not be taken, and the largest bound on the distance of a state that is found; in units of
    /// [`Prediction::scale`].
    pub near: f64,
    pub sure: f64,
    pub all: Vec<Prediction>,
    /// The expected states, m, one after the other; after the search where it has led.
    pub places: Vec<f64>,
    /// The resolvents (I - J)^-1, column by column, one after the other; after the search as it
    /// was corrected on the way.
    pub undoes: Vec<f64>,
}

/// An instance whose state is expected somewhere.
#[derive(Clone, Copy, Debug)]
pub struct Prediction {
    /// Of the plan.
    pub instance: u32,
    /// Whether tip and sample are in contact where a period begins; under a law with a memory, where it ends, too.
    pub touching: bool,
    /// Length of a state that is not small, m.
    pub scale: f64,
}

/// What became of a guess.
#[derive(Clone, Copy, Debug)]
pub struct Correction {
    /// On where the last period has led to another place yet.
    pub phase: Phase,
    /// Periods stepped.
    pub periods: u32,
    /// The last period measured, where the state that it began at was found; whether that is steady is not judged by how it
    /// changes.
    pub finished: Finished,
    /// Whether that period ends in contact; false where no state was found.
    pub touching: bool,
}

impl Correction {
    /// Before the first period.
    pub const NOT_RUN: Self =
        Self { phase: Phase::On, periods: 0, finished: Finished::NOT_RUN, touching: false };
}

/// What became of guesses, in their order.
#[derive(Clone, Debug)]
pub struct Corrections {
    pub all: Vec<Correction>,
    /// What a user should know of how it went: one line each.
    pub notes: Vec<String>,
}

impl Predictions {
    /// None yet, of states of so many numbers.
    pub fn new(numbers: usize, near: f64, sure: f64) -> Self {
        Self { numbers, near, sure, all: Vec::new(), places: Vec::new(), undoes: Vec::new() }
    }

    /// Makes room for so many more.
    pub fn reserve(&mut self, count: usize) {
        self.all.reserve(count);
        self.places.reserve(count * self.numbers);
        self.undoes.reserve(count * self.numbers * self.numbers);
    }

    /// Adds one, with its state, m, and the resolvent there.
    pub fn push(&mut self, guessed: Prediction, place: &[f64], undoes: &[f64]) {
        self.all.push(guessed);
        self.places.extend_from_slice(place);
        self.undoes.extend_from_slice(undoes);
    }

    /// Adds others, of as many numbers.
    pub fn append(&mut self, mut others: Self) {
        self.all.append(&mut others.all);
        self.places.append(&mut others.places);
        self.undoes.append(&mut others.undoes);
    }

    /// The n-th one's state, m.
    pub fn place(&self, n: usize) -> &[f64] {
        &self.places[n * self.numbers..][..self.numbers]
    }

    /// The resolvent there.
    pub fn undoes(&self, n: usize) -> &[f64] {
        let size = self.numbers * self.numbers;
        &self.undoes[n * size..][..size]
    }

    /// The goal of one, in the kernel's units.
    pub(super) fn goal(&self, guessed: &Prediction) -> Goal<f64> {
        Goal { scale: guessed.scale / LENGTH, near: self.near, sure: self.sure }
    }

    /// Some of them alone.
    #[cfg(feature = "gpu")]
    pub(super) fn some(&self, which: &[u32]) -> Self {
        let mut some = Self::new(self.numbers, self.near, self.sure);
        which.iter().map(|n| *n as usize).for_each(|n| some.push(self.all[n], self.place(n), self.undoes(n)));
        some
    }
}

/// Takes guesses to their ends on the processor; `plan` is that of their instances.
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
    let join = |mut all: Vec<Correction>, mut part: Vec<Correction>| {
        all.append(&mut part);
        all
    };
    Ok(parts.collect::<Result<Vec<_>, _>>()?.into_iter().reduce(join).unwrap_or_default())
}

/// Guesses that one thread takes along.
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
                let same = !plan.law(instances[n]).has_memory() || end.touching == guessed[n].touching;
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

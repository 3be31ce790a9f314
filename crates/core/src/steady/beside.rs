//! Periodic states from their neighbours': one measured period from where these lead to tells how far it still is.

use super::aims::goal;
use super::map::station;
use super::measured::{self, SURE};
use super::node::{Guess, Lead, Turns};
use super::sizes::{Sized, by_size, with_size};
use super::{Linear, PeriodicState, Settled};
use crate::engine::{Busy, Cpu, Engine, EngineError, Finished, Outcome, Passing, Progress};
use crate::kernel::broyden::{self, Arrival, Goal, Phase, ROUNDS, Standing};
use crate::periodic::{Memory, Size, Spectrum};
use crate::plan::{Plan, Precision, Station};
use nalgebra::{DefaultAllocator, DimName, OVector};
use rayon::prelude::*;
use std::sync::Arc;

/// Instances that one thread takes along together, where the engine leaves the threads to its callers.
const PART: usize = 512;

/// Tries to find the states of the instances that have a hint: results, states and periods of those whose hint led to
/// one. Of the others only the periods are told; they are as not run.
pub(super) fn all(
    plan: &Plan,
    leads: &[Lead],
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<Settled, EngineError> {
    let hinted = |i: &u32| matches!(leads[*i as usize], Lead::Hint(_));
    let tried: Vec<u32> = plan.instances().filter(|i| plan.steps(*i) > 0 && hinted(i)).collect();
    let cpu = Cpu::default();
    let double: &dyn Engine = if engine.double() { engine } else { &cpu };
    progress.task("from neighbours", 0);
    let count = plan.len();
    let mut settled = Settled {
        outcome: Outcome { ends: Vec::new(), ..Outcome::of(plan) },
        found: vec![None; count],
        periods: vec![0; count],
        jumps: Vec::new(),
    };
    let part = if double.by_threads() { PART } else { tried.len().max(1) };
    let parts: Vec<_> = by_size(plan, &tried)
        .into_iter()
        .flat_map(|(size, some)| some.chunks(part).map(|some| (size, some.to_vec())).collect::<Vec<_>>())
        .collect();
    let one = |(size, some): &(usize, Vec<u32>)| {
        with_size(*size, Several { plan, some, leads, engine: double, progress })
    };
    let done: Vec<_> = parts.par_iter().map(one).collect();
    for part in done {
        let Ended { ends, notes } = part?;
        settled.outcome.notes.extend(notes);
        for (i, periods, found) in ends {
            let i = i as usize;
            settled.periods[i] = periods;
            if let Some((finished, state)) = found {
                (settled.outcome.results[i], settled.found[i]) = (finished, Some(state));
            }
        }
    }
    Ok(settled)
}

/// A result, and the state that it is of.
type Led = (Finished, Box<PeriodicState>);

/// Of each instance the periods stepped, and what they led to.
struct Ended {
    ends: Vec<(u32, u32, Option<Led>)>,
    notes: Vec<String>,
}

/// Instances whose states have as many numbers.
struct Several<'a> {
    plan: &'a Plan,
    some: &'a [u32],
    /// By instance of the plan.
    leads: &'a [Lead<'a>],
    engine: &'a dyn Engine,
    progress: &'a Progress,
}

impl Sized for Several<'_> {
    type Output = Result<Ended, EngineError>;

    fn run<D: Size + DimName>(self) -> Self::Output
    where
        DefaultAllocator: Memory<D>,
    {
        let Self { plan, some, leads, engine, progress } = self;
        let mut ended = Ended { ends: Vec::with_capacity(some.len()), notes: Vec::new() };
        // Each stays in its place: it is too large to be moved about.
        let mut all: Vec<One<D>> = Vec::with_capacity(some.len());
        let mut turns = Turns::new();
        progress.timed(Busy::Algebra, || {
            for &i in some {
                match leads[i as usize].hint().and_then(|hint| hint.guess(plan, i, &mut turns)) {
                    Some(guess) => all.push(One {
                        instance: i,
                        guess,
                        stride: OVector::<f64, D>::zeros(),
                        strode: false,
                    }),
                    None => ended.ends.push((i, 0, None)),
                }
            }
        });
        let mut left: Vec<usize> = (0..all.len()).collect();
        let numbers: Vec<u32> = all.iter().map(|one| one.instance).collect();
        let map = progress.timed(Busy::Constants, || engine.return_map(plan, &numbers))?;
        let mut room = vec![0.0; all.len() * D::DIM];
        for round in 1..=ROUNDS {
            if left.is_empty() || progress.stopped() {
                break;
            }
            let places = left.iter().zip(room.chunks_exact_mut(D::DIM));
            let mut passing: Vec<Passing> = places.map(|(n, room)| all[*n].passing(*n, room)).collect();
            match &map {
                Some(map) => map.measured(plan, &mut passing, progress),
                None => self.run_once(&numbers, &mut passing, &mut ended.notes)?,
            }
            let mut passed = passing.iter();
            let arrived = |n: &usize| {
                let (one, Some(passed)) = (&mut all[*n], passed.next()) else { return false };
                let found = match one.arrived(plan, passed) {
                    Phase::On => return true,
                    Phase::Found => Some((passed.finished, one.state(plan))),
                    Phase::Lost => None,
                };
                ended.ends.push((one.instance, round, found));
                false
            };
            progress.timed(Busy::Algebra, || left.retain(arrived));
        }
        ended.ends.extend(left.into_iter().map(|n| (all[n].instance, ROUNDS, None)));
        Ok(ended)
    }
}

impl Several<'_> {
    /// Takes instances through one measured period by a run of a plan of them; `numbers` are theirs.
    fn run_once(
        &self,
        numbers: &[u32],
        passing: &mut [Passing],
        notes: &mut Vec<String>,
    ) -> Result<(), EngineError> {
        let numbers: Vec<u32> = passing.iter().map(|one| numbers[one.instance as usize]).collect();
        let place = |one: &Passing| {
            let mut place = Station { touching: one.touching, ..Station::FREE };
            place.x[..one.x.len()].copy_from_slice(one.x);
            place.u[..one.u.len()].copy_from_slice(one.u);
            place
        };
        let places: Vec<Station> = passing.iter().map(place).collect();
        let part = self.plan.part(&numbers).in_precision(Precision::F64);
        let once = measured::period(part, places.into_iter(), self.engine, self.progress)?;
        notes.extend(once.notes);
        for ((one, finished), end) in passing.iter_mut().zip(once.results).zip(once.ends) {
            (one.finished, one.finite) = (finished, end.as_ref().is_some_and(|end| end.finite));
            if let Some(end) = end {
                let modes = one.x.len();
                one.x.copy_from_slice(&end.x[..modes]);
                one.u.copy_from_slice(&end.u[..modes]);
                one.touching = end.touching;
            }
        }
        Ok(())
    }
}

/// An instance on its way.
struct One<D: Size>
where
    DefaultAllocator: Memory<D>,
{
    instance: u32,
    /// Where it stands, and what is thought of the map there.
    guess: Guess<D>,
    /// The last stride, and whether there was one.
    stride: OVector<f64, D>,
    strode: bool,
}

impl<D: Size + DimName> One<D>
where
    DefaultAllocator: Memory<D>,
{
    /// On its way, as the n-th of all that are; `room` holds as many numbers as its state.
    fn passing<'a>(&self, n: usize, room: &'a mut [f64]) -> Passing<'a> {
        room.copy_from_slice(self.guess.state.as_slice());
        let (x, u) = room.split_at_mut(D::DIM / 2);
        let touching = self.guess.touching;
        Passing { instance: n as u32, x, u, touching, finite: true, finished: Finished::NOT_RUN }
    }

    /// Takes in where a period has led to. Where that is no end, it stands at the next place to try.
    fn arrived(&mut self, plan: &Plan, end: &Passing) -> Phase {
        let same_contact = !plan.law(self.instance).has_memory() || end.touching == self.guess.touching;
        let arrival = Arrival { strode: self.strode, sound: end.finite && same_contact };
        let (scale, near) = goal(plan, self.instance);
        let goal = Goal { scale, near, sure: SURE * plan.run.accuracy };
        let Self { guess: Guess { state, undoes, .. }, stride, .. } = self;
        let mut there = OVector::<f64, D>::zeros();
        end.x.iter().chain(&*end.u).zip(there.as_mut_slice()).for_each(|(end, place)| *place = *end);
        let here = Standing {
            place: state.as_mut_slice(),
            stride: stride.as_mut_slice(),
            undoes: undoes.as_mut_slice(),
        };
        self.strode = true;
        match broyden::stride(there.as_slice(), &goal, arrival, here) {
            Phase::Found if !end.finished.status.is_steady() => Phase::Lost,
            phase => phase,
        }
    }

    fn state(&self, plan: &Plan) -> Box<PeriodicState> {
        let Guess { undoes, multiplier, .. } = &self.guess;
        Box::new(PeriodicState {
            station: station(&self.guess.state, self.guess.touching),
            spectrum: Spectrum { multiplier: *multiplier, least_change: 1.0 / undoes.norm() },
            steps: plan.steps(self.instance),
            kept: Arc::clone(&plan.driven(self.instance).kept),
            linear: Linear::Undoes(undoes.iter().map(|value| *value as f32).collect()),
        })
    }
}

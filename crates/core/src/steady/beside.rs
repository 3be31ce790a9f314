//! Periodic states from their neighbours': one measured period from where these lead to tells how far it still is.

use super::aims::goal;
use super::map::{station, vector};
use super::measured::{self, SURE};
use super::node::{Guess, Lead, Turns};
use super::sizes::{Sized, by_size, with_size};
use super::{PeriodicState, Settled};
use crate::engine::{Cpu, Engine, EngineError, Finished, Outcome, Progress};
use crate::periodic::{Memory, Size, Spectrum, inverse};
use crate::plan::{Plan, Precision, Station};
use nalgebra::{DefaultAllocator, DimName, OMatrix, OVector};
use rayon::prelude::*;
use std::sync::Arc;

/// Most periods: what is not there by then is searched for.
const MOST: u32 = 6;
/// The longest step from a guess, in free amplitudes: what is farther off is another motion.
const FAR: f64 = 0.1;
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
        // Each in a place of its own: with its slope it is too large to be moved about.
        let mut left: Vec<Box<One<D>>> = Vec::with_capacity(some.len());
        let mut turns = Turns::default();
        for &i in some {
            let guess = leads[i as usize].hint().and_then(|hint| hint.guess::<D>(plan, i, &mut turns));
            match guess.and_then(|guess| One::new(i, guess)) {
                Some(one) => left.push(one),
                None => ended.ends.push((i, 0, None)),
            }
        }
        for round in 1..=MOST {
            if left.is_empty() || progress.stopped() {
                break;
            }
            let numbers: Vec<u32> = left.iter().map(|one| one.instance).collect();
            let places = left.iter().map(|one| one.station());
            let part = plan.part(&numbers).in_precision(Precision::F64);
            let Outcome { results, ends, notes } = measured::period(part, places, engine, progress)?;
            ended.notes.extend(notes);
            let mut rest = Vec::with_capacity(left.len());
            for ((mut one, finished), end) in left.into_iter().zip(results).zip(ends) {
                match one.arrived(plan, end.as_deref(), &finished) {
                    Next::Found => ended.ends.push((one.instance, round, Some((finished, one.state(plan))))),
                    Next::Lost => ended.ends.push((one.instance, round, None)),
                    Next::On => rest.push(one),
                }
            }
            left = rest;
        }
        ended.ends.extend(left.into_iter().map(|one| (one.instance, MOST, None)));
        Ok(ended)
    }
}

/// What becomes of an instance after a period.
enum Next {
    Found,
    Lost,
    On,
}

/// An instance on its way.
struct One<D: Size>
where
    DefaultAllocator: Memory<D>,
{
    instance: u32,
    at: OVector<f64, D>,
    touching: bool,
    multiplier: f64,
    slope: OMatrix<f64, D, D>,
    /// Of one minus the slope.
    inverse: OMatrix<f64, D, D>,
    /// The last stride and the change before it.
    last: Option<(OVector<f64, D>, OVector<f64, D>)>,
}

impl<D: Size + DimName> One<D>
where
    DefaultAllocator: Memory<D>,
{
    fn new(instance: u32, guess: Guess<D>) -> Option<Box<Self>> {
        let Guess { state, slope, multiplier, touching } = guess;
        let inverse = inverse(OMatrix::<f64, D, D>::identity() - &slope)?;
        Some(Box::new(Self { instance, at: state, touching, multiplier, slope, inverse, last: None }))
    }

    fn station(&self) -> Station {
        station(&self.at, self.touching)
    }

    /// Takes in where a period has led to. Where that is no end, it stands at the next place to try.
    fn arrived(&mut self, plan: &Plan, end: Option<&Station>, finished: &Finished) -> Next {
        let same_contact =
            |end: &&Station| !plan.law(self.instance).has_memory() || end.touching == self.touching;
        let Some(end) = end.filter(|end| end.finite).filter(same_contact) else { return Next::Lost };
        let change = vector::<D>(end) - &self.at;
        if let Some((stride, before)) = self.last.take() {
            self.learn(&stride, &(&change - before));
        }
        let stride = &self.inverse * &change;
        let (scale, near) = goal(plan, self.instance);
        let left = stride.norm() / scale;
        let bound = change.norm() * self.inverse.norm() / scale;
        if left <= near && bound <= SURE * plan.run.accuracy {
            return if finished.status.is_steady() { Next::Found } else { Next::Lost };
        }
        if left.is_nan() || left > FAR {
            return Next::Lost;
        }
        self.at += &stride;
        self.last = Some((stride, change));
        Next::On
    }

    /// Broyden's update of the slope and, by Sherman and Morrison, of the inverse: a stride changed the map's change by
    /// so much.
    fn learn(&mut self, stride: &OVector<f64, D>, moved: &OVector<f64, D>) {
        let miss = moved - (&self.slope * stride - stride);
        let square = stride.norm_squared();
        // One minus the slope loses `miss` times the stride over its square.
        let by = &self.inverse * &miss;
        let along = self.inverse.tr_mul(stride);
        let divisor = square - along.dot(&miss);
        self.slope.ger(1.0 / square, &miss, stride, 1.0);
        self.inverse.ger(1.0 / divisor, &by, &along, 1.0);
    }

    fn state(&self, plan: &Plan) -> Box<PeriodicState> {
        Box::new(PeriodicState {
            station: self.station(),
            spectrum: Spectrum { multiplier: self.multiplier, least_change: 1.0 / self.inverse.norm() },
            steps: plan.steps(self.instance),
            kept: Arc::clone(&plan.driven(self.instance).kept),
            slope: self.slope.as_slice().into(),
        })
    }
}

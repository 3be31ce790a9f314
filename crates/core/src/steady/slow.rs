//! What goes to rest so slowly that waiting takes thousands of periods is followed in strides of many.

use super::Settled;
use super::aims;
use super::begin::Begin;
use super::found::found;
use super::map::{PeriodMap, station, vector};
use super::one::widened;
use super::sizes::{Sized, by_size, with_size};
use crate::engine::{Busy, Cpu, Engine, EngineError, Progress, SlopeStart, Sloped};
use crate::kernel::Room;
use crate::periodic::{Came, Envelope, Memory, Size, Slowly, WithSlope};
use crate::plan::{Plan, Station};
use nalgebra::{DefaultAllocator, DimName};
use std::ops::Range;

/// Paces of fewer periods are no longer than following takes.
const LONG: u32 = 384;
/// Most evaluations for an instance: so many, or the pace over this where that is more. Each takes as long as a few periods.
const MOST: (u32, u32) = (96, 16);

/// Whether motions of this pace are followed.
pub(super) fn is_slow(pace: u32) -> bool {
    pace >= LONG
}

/// Evaluations that following an instance of this pace may take.
pub(super) fn most(pace: u32) -> u32 {
    MOST.0.max(pace / MOST.1)
}

/// An instance to be followed.
pub(super) struct Slow {
    /// Of the plan.
    pub instance: u32,
    pub place: Station,
    /// Periods in which free motion fades.
    pub pace: u32,
    /// Most evaluations.
    pub most: u32,
}

/// Follows these instances, and searches where they come to rest; what is found goes into `settled`. Tells
/// how many evaluations each has taken: none on an engine that tells no slopes.
pub(super) fn run(
    plan: &Plan,
    from: &[Slow],
    settled: &mut Settled,
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<Vec<u32>, EngineError> {
    let cpu = Cpu::default();
    let double: &dyn Engine = if engine.double() { engine } else { &cpu };
    let part = plan.part(&from.iter().map(|one| one.instance).collect::<Vec<u32>>());
    let mut places: Vec<Option<Station>> = vec![None; from.len()];
    let mut taken = vec![0; from.len()];
    for (count, group) in by_size(&part, &part.instances().collect::<Vec<u32>>()) {
        let map = PeriodMap::new(&part, &group, double, progress)?;
        if !map.tells_slopes() {
            continue;
        }
        let begin: Vec<&Slow> = group.iter().map(|i| &from[*i as usize]).collect();
        let parts = map.spread(|slots| {
            let batch = Batch { instances: &group, from: &begin, map: &map };
            with_size(count, Part { batch, slots })
        });
        for part in parts {
            for end in part? {
                let i = end.instance as usize;
                settled.periods[from[i].instance as usize] += end.evaluations;
                (taken[i], places[i]) = (end.evaluations, end.place);
            }
        }
        settled.outcome.notes.extend(map.notes());
    }
    let rested = || (0..).zip(&places).filter_map(|(i, place)| Some((i, (*place)?)));
    let (resting, places): (Vec<u32>, Vec<Station>) = rested().unzip();
    let part = part.part(&resting);
    let all: Vec<u32> = part.instances().collect();
    let (ran, _) = found(&part, &all, Begin::NextTo(&places), engine, progress)?;
    let instances: Vec<u32> = resting.iter().map(|i| from[*i as usize].instance).collect();
    settled.take(&instances, ran);
    Ok(taken)
}

/// Where one came to.
struct End {
    instance: u32,
    evaluations: u32,
    /// None where it did not come to rest.
    place: Option<Station>,
}

/// Instances with as many modes each, known here by their number in the list.
#[derive(Clone, Copy)]
struct Batch<'a> {
    instances: &'a [u32],
    from: &'a [&'a Slow],
    map: &'a PeriodMap<'a>,
}

/// Some of them.
struct Part<'a> {
    batch: Batch<'a>,
    slots: Range<u32>,
}

impl Sized for Part<'_> {
    type Output = Result<Vec<End>, EngineError>;

    fn run<D: Size + DimName>(self) -> Self::Output
    where
        DefaultAllocator: Memory<D>,
    {
        self.batch.run::<D>(self.slots)
    }
}

impl Batch<'_> {
    fn run<D: Size + DimName>(self, slots: Range<u32>) -> Result<Vec<End>, EngineError>
    where
        DefaultAllocator: Memory<D>,
    {
        let Self { instances, from, map } = self;
        let begin = |slot: u32| {
            let instance = instances[slot as usize];
            let Slow { place, pace, most, .. } = *from[slot as usize];
            let told = Slowly { scale: aims::scale(map.plan, instance), pace, most };
            (slot, Box::new(Envelope::<D>::new(vector(&place), told)))
        };
        let mut all: Vec<(u32, Box<Envelope<D>>)> = slots.map(begin).collect();
        let (mut done, mut room, mut starts) = (Vec::with_capacity(all.len()), Room::default(), Vec::new());
        while !all.is_empty() && !map.progress.stopped() {
            starts.clear();
            starts.extend(all.iter().map(|(slot, one)| SlopeStart {
                instance: *slot,
                station: station::<D>(&one.asks(), from[*slot as usize].place.touching),
                least: 0.0,
            }));
            let sloped = map.sloped(&starts, &mut room)?;
            map.progress.timed(Busy::Algebra, || {
                for ((slot, one), end) in all.iter_mut().zip(sloped) {
                    one.answer(end.and_then(|end| self.useful::<D>(*slot, &end)));
                }
            });
            all.retain(|(slot, one)| {
                let Some(came) = one.came() else { return true };
                let touching = from[*slot as usize].place.touching;
                done.push(End {
                    instance: instances[*slot as usize],
                    evaluations: one.evaluations(),
                    place: (came == Came::ToRest).then(|| station::<D>(one.place(), touching)),
                });
                false
            });
        }
        Ok(done)
    }

    /// An answer, if it is one: numbers, and the same contact as before.
    fn useful<D: Size + DimName>(&self, slot: u32, Sloped { end, slope }: &Sloped) -> Option<WithSlope<D>>
    where
        DefaultAllocator: Memory<D>,
    {
        let remembers = self.map.plan.law(self.instances[slot as usize]).has_memory();
        if !end.finite || remembers && end.touching != self.from[slot as usize].place.touching {
            return None;
        }
        Some((vector(end), widened(slope)))
    }
}

//! What goes to rest so slowly that waiting takes thousands of periods is followed in strides of many.

use super::Settled;
use super::aims;
use super::begin::Begin;
use super::found::found;
use super::map::{PeriodMap, own_vector};
use crate::engine::{Busy, Cpu, Engine, EngineError, Progress, SlopeStart, Sloped};
use crate::kernel::Room;
use crate::periodic::{Came, Envelope, Slowly};
use crate::plan::{Plan, Station};
use nalgebra::{DMatrix, DVector};
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
    let all: Vec<u32> = part.instances().collect();
    let map = PeriodMap::new(&part, &all, double, progress)?;
    let mut taken = vec![0; from.len()];
    if !map.tells_slopes() {
        return Ok(taken);
    }
    let mut places: Vec<Option<Station>> = vec![None; from.len()];
    for some in map.spread(|slots| followed(&map, from, slots)) {
        for (slot, envelope) in some? {
            let (i, one) = (slot as usize, &from[slot as usize]);
            taken[i] = envelope.evaluations();
            settled.periods[one.instance as usize] += taken[i];
            let rests = envelope.came() == Some(Came::ToRest);
            places[i] = rests.then(|| station(envelope.place(), one.place.touching));
        }
    }
    settled.outcome.notes.extend(map.notes());
    let rested = || (0..).zip(&places).filter_map(|(i, place)| Some((i, (*place)?)));
    let (resting, places): (Vec<u32>, Vec<Station>) = rested().unzip();
    let part = part.part(&resting);
    let all: Vec<u32> = part.instances().collect();
    let (ran, _) = found(&part, &all, Begin::NextTo(&places), engine, progress)?;
    let instances: Vec<u32> = resting.iter().map(|i| from[*i as usize].instance).collect();
    settled.take(&instances, ran);
    Ok(taken)
}

/// Takes some of these to where they come, each with its number among them.
fn followed(map: &PeriodMap, from: &[Slow], slots: Range<u32>) -> Result<Vec<(u32, Envelope)>, EngineError> {
    let begin = |slot: u32| {
        let Slow { place, pace, most, .. } = from[slot as usize];
        let modes = map.plan.driven(slot).kept.modes.len();
        let told = Slowly { scale: aims::scale(map.plan, slot), pace, most };
        (slot, Envelope::new(DVector::from_column_slice(&own_vector(&place, modes)), told))
    };
    let mut all: Vec<(u32, Envelope)> = slots.map(begin).collect();
    let mut room = Room::default();
    loop {
        let mut open: Vec<_> = all.iter_mut().filter(|(_, one)| one.came().is_none()).collect();
        if open.is_empty() || map.progress.stopped() {
            break;
        }
        let touching = |slot: u32| from[slot as usize].place.touching;
        let start = |(slot, one): &&mut (u32, Envelope)| SlopeStart {
            instance: *slot,
            station: station(&one.asks(), touching(*slot)),
            least: 0.0,
        };
        let starts: Vec<SlopeStart> = open.iter().map(start).collect();
        let sloped = map.sloped(&starts, &mut room)?;
        map.progress.timed(Busy::Algebra, || {
            for ((slot, one), end) in open.iter_mut().zip(sloped) {
                // An answer is of use where it is numbers, in the same contact as before.
                let remembers = map.plan.law(*slot).has_memory();
                let same = |end: &Station| !remembers || end.touching == touching(*slot);
                let useful = end.filter(|sloped| sloped.end.finite && same(&sloped.end));
                one.answer(useful.map(|Sloped { end, slope }| {
                    let numbers = slope.len().isqrt();
                    let state = DVector::from_column_slice(&own_vector(&end, numbers / 2));
                    (state, DMatrix::from_column_slice(numbers, numbers, &slope))
                }));
            }
        });
    }
    Ok(all)
}

/// Where the kept modes have these travels, then rates.
fn station(numbers: &DVector<f64>, touching: bool) -> Station {
    let (x, u) = numbers.as_slice().split_at(numbers.len() / 2);
    let mut station = Station { touching, ..Station::FREE };
    station.x[..x.len()].copy_from_slice(x);
    station.u[..u.len()].copy_from_slice(u);
    station
}

//! Many searches side by side: all that they ask for in one run.

use super::aims::{ENOUGH_F32, NEAR_F32, begins_in_f32, enough, least, near, scale, tangent_columns};
use super::begin::{Begin, Left};
use super::map::{PeriodMap, station, vector};
use super::one::{One, widened};
use super::sizes::{Sized, by_size, with_size};
use super::{Linear, PeriodicState};
use crate::engine::{Busy, Engine, EngineError, Progress, Seek, Seeks, SlopeStart, Sloped, Sought};
use crate::kernel::Room;
use crate::periodic::{Found, Memory, Size, Verdict};
use crate::plan::{Case, Plan, Precision, Station};
use nalgebra::{DefaultAllocator, DimName};
use std::ops::Range;
use std::sync::Arc;

/// Instances searched for at a time: as many as keep the engine busy and the memory small.
const CHUNK: usize = 8192;
/// The same where there are many modes: a slope of 24 modes has 18 kB.
const CHUNK_MANY: usize = 1024;
/// What the searches ended with, by instance of the plan.
pub(super) struct Searched {
    pub found: Vec<Option<Box<PeriodicState>>>,
    pub periods: Vec<u32>,
    /// Those that were searched for from where the scene begins, in vain.
    pub left: Vec<Left>,
    pub notes: Vec<String>,
}

/// Searches for the periodic states of `stepped` by an engine that can compute in f64.
pub(super) fn all(
    plan: &Plan,
    stepped: &[u32],
    from: Begin,
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<Searched, EngineError> {
    let (found, periods) = (vec![None; plan.len()], vec![0; plan.len()]);
    let mut done = Searched { found, periods, left: Vec::new(), notes: Vec::new() };
    for (count, group) in by_size(plan, stepped) {
        for chunk in group.chunks(if count > 8 { CHUNK_MANY } else { CHUNK }) {
            if progress.stopped() {
                return Ok(done);
            }
            let map = PeriodMap::new(plan, chunk, engine, progress)?;
            let parts = map.spread(|slots| {
                let batch = Batch { plan, from, instances: chunk, map: &map };
                with_size(count, Part { batch, slots })
            });
            for part in parts {
                for end in part? {
                    let instance = chunk[end.slot as usize];
                    done.periods[instance as usize] += end.periods;
                    match end.became {
                        Ok(state) => done.found[instance as usize] = Some(state),
                        Err((waited, place)) => {
                            done.left.push(Left { instance, place, waited, wanders: false });
                        }
                    }
                }
            }
            done.notes.extend(map.notes());
        }
    }
    Ok(done)
}

/// How one instance's searches ended.
struct End {
    /// Its number in the batch.
    slot: u32,
    periods: u32,
    /// Its state; else how many periods on from where it began it was looked for last, and the place there.
    became: Result<Box<PeriodicState>, (u32, Station)>,
}

/// Instances with as many modes each, known here by their number in the list.
#[derive(Clone, Copy)]
struct Batch<'a> {
    plan: &'a Plan,
    from: Begin<'a>,
    instances: &'a [u32],
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

/// An instance without a state yet, the periods stepped for it so far, and where the last search began.
type Seeking = (u32, u32, Station);

impl Batch<'_> {
    fn case(&self, slot: u32) -> Case {
        self.plan.case(self.instances[slot as usize])
    }

    fn run<D: Size + DimName>(self, slots: Range<u32>) -> Result<Vec<End>, EngineError>
    where
        DefaultAllocator: Memory<D>,
    {
        let Self { plan, instances, from, .. } = self;
        let instance = |slot: u32| instances[slot as usize];
        let begin = |slot: u32| from.place(plan, instance(slot));
        let mut done = Vec::with_capacity(slots.len());
        let (mut close, mut left): (Vec<Box<One<D>>>, Vec<Seeking>) = (Vec::new(), Vec::new());
        for slot in slots {
            match from.known(instance(slot)) {
                known if let Begin::Along(along) = &from => {
                    close.push(Box::new(One::along(plan, slot, instance(slot), known, along)));
                }
                Some(place) => close.push(Box::new(One::beside(plan, slot, instance(slot), place))),
                None if matches!(from, Begin::At(_) | Begin::NextTo(_)) => {
                    close.push(Box::new(One::next_to(plan, slot, instance(slot), begin(slot))));
                }
                None if matches!(from, Begin::Late(_)) => {
                    close.push(Box::new(One::begin(plan, slot, instance(slot), begin(slot))));
                }
                None => left.push((slot, 0, begin(slot))),
            }
        }
        let lost = self.together(close, true, &mut done)?;
        left.extend(lost.into_iter().map(|(slot, periods, _)| (slot, periods, begin(slot))));
        let (mut waited, periods) = (0, plan.run.periods);
        for (n, &(warm, searches)) in from.warm().iter().enumerate() {
            // Waiting would be cheaper.
            if left.is_empty() || warm >= periods {
                break;
            }
            left = self.on(left, warm)?;
            waited += warm;
            if searches {
                let begun = |(slot, stepped, place)| {
                    let mut one = One::begin(plan, slot, instance(slot), place);
                    one.periods = stepped;
                    Box::new(one)
                };
                let last = !from.warm()[n + 1..].iter().any(|(warm, searches)| *searches && *warm < periods);
                left = self.together(left.into_iter().map(begun).collect(), last, &mut done)?;
            }
        }
        self.map.ended(left.len());
        let end = |(slot, periods, place)| End { slot, periods, became: Err((waited, place)) };
        done.extend(left.into_iter().map(end));
        Ok(done)
    }

    /// So many periods on; who was stopped on the way is left out.
    fn on(self, left: Vec<Seeking>, periods: u32) -> Result<Vec<Seeking>, EngineError> {
        let starts: Vec<_> = left.iter().map(|(slot, _, place)| (*slot, *place)).collect();
        let ends = self.map.after(&starts, periods)?.into_iter();
        Ok(left
            .into_iter()
            .zip(ends)
            .filter_map(|((slot, so_far, _), end)| Some((slot, so_far + periods, end?)))
            .collect())
    }

    /// Takes searches to their ends; those in vain come back. What an engine does not find by itself goes through rounds here where
    /// no other search follows, `last`.
    fn together<D: Size + DimName>(
        self,
        all: Vec<Box<One<D>>>,
        last: bool,
        done: &mut Vec<End>,
    ) -> Result<Vec<Seeking>, EngineError>
    where
        DefaultAllocator: Memory<D>,
    {
        if all.is_empty() || !self.map.searches() || matches!(self.from, Begin::Along(_)) {
            return self.rounds(all, done);
        }
        let mut lost = Vec::new();
        let left = self.by_newton(all, last, (done, &mut lost))?;
        lost.extend(match last {
            true => self.rounds(left, done)?,
            false => left.into_iter().map(|one| (one.slot, one.stepped(), one.start)).collect(),
        });
        Ok(lost)
    }

    /// Round by round: all that they ask for, and what they make of it.
    fn rounds<D: Size + DimName>(
        self,
        mut all: Vec<Box<One<D>>>,
        done: &mut Vec<End>,
    ) -> Result<Vec<Seeking>, EngineError>
    where
        DefaultAllocator: Memory<D>,
    {
        let mut lost = Vec::new();
        if self.map.tells_slopes() {
            let columns = |slot: u32| tangent_columns(self.plan, self.instances[slot as usize]);
            all.iter_mut().for_each(|one| one.search.by_tangents(columns(one.slot)));
        }
        let mut room = Room::default();
        let (mut starts, mut slopes, mut values) = (Vec::new(), Vec::new(), Vec::new());
        while !all.is_empty() {
            starts.clear();
            slopes.clear();
            for one in &all {
                let places = one.search.asks().map(|state| station::<D>(&state, one.start.touching));
                if one.search.wants_slope() {
                    let least = least(self.plan, self.instances[one.slot as usize]);
                    slopes.extend(places.map(|station| SlopeStart { instance: one.slot, station, least }));
                } else {
                    starts.extend(places.map(|station| (one.slot, station)));
                }
            }
            let ends = self.map.after(&starts, 1)?;
            let mut sloped = self.map.sloped(&slopes, &mut room)?.into_iter();
            let mut rest = ends.iter();
            self.map.progress.timed(Busy::Algebra, || {
                for one in &mut all {
                    if one.search.wants_slope() {
                        one.answer_sloped(sloped.next().flatten());
                        continue;
                    }
                    values.clear();
                    values.extend(rest.by_ref().take(one.search.wants()).map(|end| one.useful((*end)?)));
                    one.search.answer(&values);
                }
            });
            all.retain(|one| match one.search.verdict() {
                None => true,
                Some(Verdict::Found(found)) => {
                    done.push(self.end(one, found));
                    self.map.ended(1);
                    false
                }
                Some(Verdict::Lost(_)) => {
                    lost.push((one.slot, one.stepped(), one.start));
                    false
                }
            });
        }
        Ok(lost)
    }

    /// Searches as the engine does it as a whole, in f32 up to where that is sure and then in f64; what it does not find comes
    /// back. Where another search follows, what f32 does not find is left to that.
    fn by_newton<D: Size + DimName>(
        self,
        mut all: Vec<Box<One<D>>>,
        last: bool,
        (done, lost): (&mut Vec<End>, &mut Vec<Seeking>),
    ) -> Result<Vec<Box<One<D>>>, EngineError>
    where
        DefaultAllocator: Memory<D>,
    {
        let (plan, instance) = (self.plan, |one: &One<D>| self.instances[one.slot as usize]);
        let early = |one: &One<D>| one.search.time().is_finite() && begins_in_f32(plan, instance(one));
        let begin = |one: &One<D>| (one.slot, one.start, one.search.time());
        let (which, begins): (Vec<usize>, Vec<_>) =
            (all.iter().enumerate()).filter(|(_, one)| early(one)).map(|(n, one)| (n, begin(one))).unzip();
        // What f32 has found begins there in f64, by Newton's steps.
        let mut next = Vec::new();
        for (n, sought) in which.into_iter().zip(self.sought(&begins, Precision::F32)?) {
            all[n].periods += sought.periods;
            next.extend(sought.found.map(|found| (n, found.end)));
        }
        let begins: Vec<_> = next.iter().map(|(n, place)| (all[*n].slot, *place, f64::INFINITY)).collect();
        let mut found: Vec<Option<Sloped>> = vec![None; all.len()];
        for ((n, _), sought) in next.iter().zip(self.sought(&begins, Precision::F64)?) {
            all[*n].periods += sought.periods;
            found[*n] = sought.found;
        }
        let (which, begins): (Vec<usize>, Vec<_>) = (all.iter().enumerate())
            .filter(|(n, one)| found[*n].is_none() && (last || !early(one)))
            .map(|(n, one)| (n, begin(one)))
            .unzip();
        for (n, sought) in which.into_iter().zip(self.sought(&begins, Precision::F64)?) {
            all[n].periods += sought.periods;
            found[n] = sought.found;
        }
        let mut left = Vec::new();
        for (one, found) in all.into_iter().zip(found) {
            let Some(Sloped { end, slope }) = found else {
                left.push(one);
                continue;
            };
            match Found::stable(vector(&end), widened(&slope)) {
                Some(found) => {
                    done.push(self.end(&one, &found));
                    self.map.ended(1);
                }
                None => lost.push((one.slot, one.stepped(), one.start)),
            }
        }
        Ok(left)
    }

    /// What the engine's searches come to that begin so: by slot, from a place, with a first stride of so many periods.
    fn sought(
        self,
        begins: &[(u32, Station, f64)],
        precision: Precision,
    ) -> Result<Vec<Sought>, EngineError> {
        if begins.is_empty() {
            return Ok(Vec::new());
        }
        let plan = self.plan;
        let seek = |(slot, _, time): &(u32, Station, f64)| {
            let instance = self.instances[*slot as usize];
            Seek { scale: scale(plan, instance), time: *time, least: least(plan, instance) }
        };
        let (near, enough) = match precision {
            Precision::F32 => (NEAR_F32, ENOUGH_F32),
            Precision::F64 => (near(plan), enough(plan)),
        };
        let seeks = Seeks { near, enough, all: begins.iter().map(seek).collect() };
        self.map.sought(begins.iter().map(|(slot, place, _)| (*slot, *place)), &seeks, precision)
    }

    fn end<D: Size + DimName>(self, one: &One<D>, found: &Found<D>) -> End
    where
        DefaultAllocator: Memory<D>,
    {
        let case = self.case(one.slot);
        End {
            slot: one.slot,
            periods: one.stepped(),
            became: Ok(Box::new(PeriodicState {
                station: station::<D>(&found.state, one.start.touching),
                spectrum: found.spectrum,
                steps: case.steps,
                kept: Arc::clone(&self.plan.driven(self.instances[one.slot as usize]).kept),
                linear: Linear::Slope(found.slope.as_slice().into()),
            })),
        }
    }
}

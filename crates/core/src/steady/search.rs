//! Many searches side by side: all that they ask for in one run.

use super::aims::{least, options, tangent_columns};
use super::begin::{Along, Begin, Left};
use super::map::{PeriodMap, as_its_own, free_slope, station, vector, whole};
use super::sizes::{Sized, by_size, with_size};
use super::{Linear, PeriodicState};
use crate::engine::{Busy, Engine, EngineError, Progress, SlopeStart, Sloped};
use crate::kernel::Room;
use crate::periodic::{Found, Memory, Options, Search, Size, Verdict};
use crate::plan::{Case, Plan, Station};
use nalgebra::{DefaultAllocator, DimName, OVector};
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
        let lost = self.together(close, &mut done)?;
        left.extend(lost.into_iter().map(|(slot, periods, _)| (slot, periods, begin(slot))));
        let mut waited = 0;
        for &(warm, searches) in from.warm() {
            // Waiting would be cheaper.
            if left.is_empty() || warm >= plan.run.periods {
                break;
            }
            left = self.on(left, warm)?;
            waited += warm;
            if searches {
                let begun = |(slot, periods, place)| {
                    let one = One::begin(plan, slot, instance(slot), place);
                    Box::new(One { periods, ..one })
                };
                left = self.together(left.into_iter().map(begun).collect(), &mut done)?;
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

    /// Takes searches to their ends; those in vain come back.
    fn together<D: Size + DimName>(
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

/// Of a state of so many numbers those of modes that the instance has, travels, then rates; none where it has them all.
fn moving(plan: &Plan, instance: u32, numbers: usize) -> Option<Vec<usize>> {
    let (modes, most) = (plan.driven(instance).kept.modes.len(), numbers / 2);
    (modes < most).then(|| (0..modes).chain((most..).take(modes)).collect())
}

/// One instance's search.
struct One<D: Size>
where
    DefaultAllocator: Memory<D>,
{
    /// Its number in the batch.
    slot: u32,
    /// Periods stepped before.
    periods: u32,
    /// Where it began; contact at a period's start stays as it was there.
    start: Station,
    /// Whether contact is a memory of the past, not what the indentation says.
    remembers: bool,
    search: Search<D>,
}

impl<D: Size + DimName> One<D>
where
    DefaultAllocator: Memory<D>,
{
    fn begin(plan: &Plan, slot: u32, instance: u32, start: Station) -> Self {
        let (remembers, options) = options(plan, instance);
        let (slope, columns) = free_slope(plan, instance);
        Self {
            slot,
            periods: 0,
            start,
            remembers,
            search: Search::guided(vector(&start), slope, columns, options).among(moving(
                plan,
                instance,
                D::DIM,
            )),
        }
    }

    /// From a state with other steps or another lever.
    fn beside(plan: &Plan, slot: u32, instance: u32, place: &PeriodicState) -> Self {
        let (remembers, options) = options(plan, instance);
        let (start, slope) = as_its_own::<D>(plan, instance, place);
        let search = Search::beside(vector(&start), slope, place.spectrum, options);
        let search = search.among(moving(plan, instance, D::DIM));
        Self { slot, periods: 0, start, remembers, search }
    }

    /// From a place that a curve leads to: the slope at the curve's last point, or else without a sample, will do on the
    /// way; the state's own tells its stability.
    fn along(plan: &Plan, slot: u32, instance: u32, last: Option<&PeriodicState>, along: &Along) -> Self {
        let start = along.places[instance as usize];
        let (remembers, options) = options(plan, instance);
        let moving = moving(plan, instance, D::DIM);
        let lightly = along.lightly.get(instance as usize).copied().unwrap_or(false);
        let options = Options {
            near: true,
            carried: last.is_some(),
            most: along.most.0 + along.most.1 * moving.as_ref().map_or(D::DIM, Vec::len) as u32,
            last_step: options.last_step.filter(|_| !lightly),
            stable: !lightly,
            ..options
        };
        let search = match last {
            Some(last) => {
                let slope = as_its_own::<D>(plan, instance, last).1;
                Search::guided(vector(&start), slope, (0..D::DIM).collect(), options)
            }
            None => Search::new(vector(&start), options),
        };
        let search = search.among(moving);
        Self { slot, periods: 0, start, remembers, search }
    }

    /// From a place that is thought to be next to a state, of whose slope nothing is known.
    fn next_to(plan: &Plan, slot: u32, instance: u32, start: Station) -> Self {
        let (remembers, options) = options(plan, instance);
        let search = Search::new(vector(&start), Options { near: true, ..options });
        let search = search.among(moving(plan, instance, D::DIM));
        Self { slot, periods: 0, start, remembers, search }
    }

    /// Periods stepped for the instance.
    fn stepped(&self) -> u32 {
        self.periods + self.search.evaluations()
    }

    /// Takes the map's answer with its slope.
    fn answer_sloped(&mut self, sloped: Option<Sloped>) {
        let answer = sloped.and_then(|Sloped { end, slope }| Some((self.useful(end)?, whole(&slope))));
        self.search.answer_sloped(answer);
    }

    /// The map's answer, if it is one: numbers, and the same contact as before.
    fn useful(&self, end: Station) -> Option<OVector<f64, D>> {
        let good = end.finite && (!self.remembers || end.touching == self.start.touching);
        good.then(|| vector(&end))
    }
}

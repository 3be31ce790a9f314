//! Many searches side by side: all that they ask for in one run.

use super::PeriodicState;
use super::map::{PeriodMap, free_slope, station, still, vector, with_own_steps};
use crate::contact::Law;
use crate::engine::{Engine, EngineError, Progress};
use crate::kernel::MODES_MAX;
use crate::periodic::{Ask, Memory, Options, Search, Size, Verdict};
use crate::plan::{Plan, Station};
use nalgebra::{Const, DefaultAllocator, DimName, OVector};
use rayon::prelude::*;

/// Instances searched for at a time: as many as keep the engine busy and the memory small.
const CHUNK: usize = 8192;
/// Periods stepped before a search begins, and after one in vain before the next. The first few are past the beginning
/// of contact, and before the beats that follow it, in which no stride is of use: with 3 a search took 38 periods in the
/// mean at a quality factor of 150 and 79 at 1000, with 8 54 and 131, with 32 108 and 543.
const WARM: [u32; 3] = [3, 32, 128];
/// Evaluations after which a search gives up.
const MOST: u32 = 300;
/// Distance to the periodic state that is aimed at, and that is near enough where the map is rough, as shares of the
/// accuracy asked for.
const NEAR: f64 = 1e-3;
const ENOUGH: f64 = 0.1;
/// Differences, in units of the free amplitude, that make the map's slope on the way and at the end: jumps of the
/// contact make it rough.
const SMOOTH: (f64, f64) = (1e-6, 1e-6);
const ROUGH: (f64, f64) = (3e-5, 3e-4);

/// What the searches ended with, by instance of the plan.
pub(super) struct Searched {
    pub found: Vec<Option<Box<PeriodicState>>>,
    pub periods: Vec<u32>,
    pub notes: Vec<String>,
}

/// Where searches begin.
#[derive(Clone, Copy, Debug)]
pub(super) enum Begin<'a> {
    /// At rest.
    Still,
    /// At states of the same instances with other steps, and where there is none at the free oscillation.
    Near(&'a [Option<Box<PeriodicState>>]),
}

impl Begin<'_> {
    /// A state of the instance with other steps.
    fn known(&self, instance: u32) -> Option<&PeriodicState> {
        match self {
            Self::Near(near) => near.get(instance as usize)?.as_deref(),
            Self::Still => None,
        }
    }

    /// Where the instance begins without one.
    fn place(&self, plan: &Plan, instance: u32) -> Station {
        match self {
            Self::Near(_) => Station::free(plan, instance),
            Self::Still => still(plan, instance),
        }
    }
}

/// Searches for the periodic states of `stepped` by an engine that can compute in f64.
pub(super) fn all(
    plan: &Plan,
    stepped: &[u32],
    from: Begin,
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<Searched, EngineError> {
    let mut done = Searched {
        found: vec![None; plan.cases.len()],
        periods: vec![0; plan.cases.len()],
        notes: Vec::new(),
    };
    let modes = |i: &u32| {
        let kept = &plan.drives[plan.cases[*i as usize].drive as usize].kept;
        kept.modes.len().clamp(1, MODES_MAX)
    };
    for count in 1..=MODES_MAX {
        let group: Vec<u32> = stepped.iter().copied().filter(|i| modes(i) == count).collect();
        for chunk in group.chunks(CHUNK) {
            if progress.stopped() {
                return Ok(done);
            }
            let mut batch = Batch {
                plan,
                from,
                instances: chunk,
                map: PeriodMap::new(plan, chunk, engine, progress)?,
                done: &mut done,
            };
            match count {
                1 => batch.run::<Const<2>>(),
                2 => batch.run::<Const<4>>(),
                3 => batch.run::<Const<6>>(),
                4 => batch.run::<Const<8>>(),
                5 => batch.run::<Const<10>>(),
                6 => batch.run::<Const<12>>(),
                7 => batch.run::<Const<14>>(),
                _ => batch.run::<Const<16>>(),
            }?;
            let notes = std::mem::take(&mut batch.map.notes);
            done.notes.extend(notes);
        }
    }
    Ok(done)
}

/// Instances with as many modes each, known here by their number in the list.
struct Batch<'a> {
    plan: &'a Plan,
    from: Begin<'a>,
    instances: &'a [u32],
    map: PeriodMap<'a>,
    done: &'a mut Searched,
}

impl Batch<'_> {
    fn run<D: Size + DimName + Send + Sync>(&mut self) -> Result<(), EngineError>
    where
        DefaultAllocator: Memory<D>,
        OVector<f64, D>: Send + Sync,
        One<D>: Send + Sync,
    {
        let (plan, instances, from) = (self.plan, self.instances, self.from);
        let slots = 0..instances.len() as u32;
        let instance = |slot: u32| instances[slot as usize];
        let close: Vec<Box<One<D>>> = slots
            .clone()
            .into_par_iter()
            .filter_map(|slot| {
                Some(Box::new(One::beside(plan, slot, instance(slot), from.known(instance(slot))?)))
            })
            .collect();
        let begin = |slot: u32| (slot, from.place(plan, instance(slot)));
        let mut left: Vec<(u32, Station)> =
            slots.filter(|slot| from.known(instance(*slot)).is_none()).map(begin).collect();
        let lost = self.together(close)?;
        left.extend(lost.into_iter().map(|(slot, _)| begin(slot)));
        for warm in WARM {
            // Waiting would be cheaper.
            if left.is_empty() || warm >= plan.run.periods {
                break;
            }
            left.iter().for_each(|(slot, _)| self.done.periods[instance(*slot) as usize] += warm);
            let ends = self.map.after(left.clone(), warm)?;
            let warmed = left.iter().zip(ends).filter_map(|((slot, _), end)| Some((*slot, end?)));
            let searches =
                warmed.map(|(slot, place)| Box::new(One::begin(plan, slot, instance(slot), place)));
            left = self.together(searches.collect())?;
        }
        Ok(())
    }

    /// Takes searches to their ends; those in vain come back with the place where they began.
    fn together<D: Size + DimName>(
        &mut self,
        mut all: Vec<Box<One<D>>>,
    ) -> Result<Vec<(u32, Station)>, EngineError>
    where
        DefaultAllocator: Memory<D>,
        OVector<f64, D>: Send + Sync,
        One<D>: Send + Sync,
    {
        let mut lost = Vec::new();
        while !all.is_empty() {
            let asks: Vec<Vec<_>> = all
                .par_iter()
                .map(|one| match one.search.ask() {
                    Ask::Map(states) => states,
                    Ask::Nothing => Vec::new(),
                })
                .collect();
            let of = |(one, states): (&Box<One<D>>, &Vec<_>)| -> Vec<(u32, Station)> {
                states.iter().map(|state| (one.slot, station::<D>(state, one.start.touching))).collect()
            };
            let starts: Vec<(u32, Station)> = all.par_iter().zip(&asks).flat_map_iter(of).collect();
            let ends = self.map.after(starts, 1)?;
            let mut first = 0;
            let shares: Vec<&[Option<Station>]> = asks
                .iter()
                .map(|states| {
                    first += states.len();
                    &ends[first - states.len()..first]
                })
                .collect();
            all.par_iter_mut().zip(shares).for_each(|(one, ends)| {
                let values: Vec<_> = ends.iter().map(|end| one.useful((*end)?)).collect();
                one.search.answer(&values);
            });
            let (ended, going): (Vec<_>, Vec<_>) =
                all.into_iter().partition(|one| one.search.verdict().is_some());
            all = going;
            lost.extend(ended.into_iter().filter_map(|one| self.keep(&one)));
        }
        Ok(lost)
    }

    /// Keeps what a search found; where that is nothing, says where it began.
    fn keep<D: Size + DimName>(&mut self, one: &One<D>) -> Option<(u32, Station)>
    where
        DefaultAllocator: Memory<D>,
    {
        let i = self.instances[one.slot as usize] as usize;
        self.done.periods[i] += one.search.evaluations();
        let Some(Verdict::Found(found)) = one.search.verdict() else { return Some((one.slot, one.start)) };
        self.done.found[i] = Some(Box::new(PeriodicState {
            station: station::<D>(&found.state, one.start.touching),
            spectrum: found.spectrum,
            steps: self.plan.cases[i].steps,
            slope: found.slope.as_slice().into(),
        }));
        None
    }
}

/// One instance's search.
struct One<D: Size>
where
    DefaultAllocator: Memory<D>,
{
    /// Its number in the batch.
    slot: u32,
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
        Self { slot, start, remembers, search: Search::guided(vector(&start), slope, columns, options) }
    }

    /// From a state with other steps.
    fn beside(plan: &Plan, slot: u32, instance: u32, place: &PeriodicState) -> Self {
        let (remembers, options) = options(plan, instance);
        let (start, slope) = with_own_steps::<D>(plan, instance, place);
        let search = Search::beside(vector(&start), slope, place.spectrum, options);
        Self { slot, start, remembers, search }
    }

    /// The map's answer, if it is one: numbers, and the same contact as before.
    fn useful(&self, end: Station) -> Option<OVector<f64, D>> {
        let good = end.finite && (!self.remembers || end.touching == self.start.touching);
        good.then(|| vector(&end))
    }
}

/// Whether contact is a memory, and how a search for the instance's state goes about.
fn options(plan: &Plan, instance: u32) -> (bool, Options) {
    let case = &plan.cases[instance as usize];
    let remembers = case.contact.law == Law::Jkr;
    let (step, last_step) = if remembers { ROUGH } else { SMOOTH };
    let options = Options {
        scale: plan.drives[case.drive as usize].free.tip.norm().max(1e-15),
        tolerance: NEAR * plan.run.accuracy,
        enough: ENOUGH * plan.run.accuracy,
        step,
        last_step,
        most: MOST,
        near: false,
        stable: true,
    };
    (remembers, options)
}

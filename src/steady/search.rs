//! Many searches side by side: all that they ask for in one run.

use super::PeriodicState;
use super::map::{PeriodMap, station, vector};
use crate::contact::Law;
use crate::engine::{Engine, EngineError, Progress};
use crate::kernel::MODES_MAX;
use crate::periodic::{Ask, Options, Search, Verdict};
use crate::plan::{Plan, Station};
use nalgebra::DVector;

/// Instances searched for at a time: as many as keep the engine busy and the memory small.
const CHUNK: usize = 8192;
/// Periods stepped before a search begins, and after one in vain before the next: past the first contacts, which
/// no stride could follow.
const WARM: [u32; 3] = [32, 128, 512];
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

/// One instance's search.
struct One {
    instance: u32,
    /// Where it began; contact at a period's start stays as it was there.
    start: Station,
    /// Whether contact is a memory of the past, not what the indentation says.
    remembers: bool,
    search: Search,
}

/// Where searches begin.
#[derive(Clone, Copy, Debug)]
pub(super) enum Begin<'a> {
    /// At rest.
    Still,
    /// At states of the same instances with other steps, and where there is none at the free oscillation.
    Near(&'a [Option<Box<PeriodicState>>]),
}

/// Searches for the periodic states of `stepped`.
pub(super) fn all(
    plan: &Plan,
    stepped: &[u32],
    from: Begin,
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<Searched, EngineError> {
    let mut map = PeriodMap::new(plan, engine, progress);
    let mut done = Searched {
        found: vec![None; plan.cases.len()],
        periods: vec![0; plan.cases.len()],
        notes: Vec::new(),
    };
    for chunk in stepped.chunks(CHUNK) {
        let known = |i: u32| match from {
            Begin::Near(near) => near.get(i as usize).and_then(|place| place.as_deref()),
            Begin::Still => None,
        };
        let begin = |map: &PeriodMap, i: u32| match from {
            Begin::Still => (i, map.still(i)),
            Begin::Near(_) => (i, Station::free(plan, i)),
        };
        let close = chunk.iter().filter_map(|&i| {
            let place = known(i)?;
            Some(One::begin(plan, i, map.with_own_steps(i, &place.station, place.steps), true))
        });
        let mut left: Vec<(u32, Station)> =
            chunk.iter().filter(|i| known(**i).is_none()).map(|i| begin(&map, *i)).collect();
        let lost = together(close.collect(), &mut map, &mut done)?;
        left.extend(lost.into_iter().map(|(i, _)| begin(&map, i)));
        for warm in WARM {
            // Waiting would be cheaper.
            if left.is_empty() || warm >= plan.run.periods {
                break;
            }
            left.iter().for_each(|(i, _)| done.periods[*i as usize] += warm);
            let ends = map.after(left.clone(), warm)?;
            let warmed = left.iter().zip(ends).filter_map(|((i, _), end)| Some((*i, end?)));
            let searches = warmed.map(|(i, place)| One::begin(plan, i, place, false)).collect();
            left = together(searches, &mut map, &mut done)?;
        }
        if progress.stopped() {
            break;
        }
    }
    done.notes = map.notes;
    Ok(done)
}

/// Takes searches to their ends; those in vain come back with the place where they began.
fn together(
    mut all: Vec<One>,
    map: &mut PeriodMap,
    done: &mut Searched,
) -> Result<Vec<(u32, Station)>, EngineError> {
    loop {
        let asks: Vec<(usize, Vec<_>)> = all
            .iter()
            .enumerate()
            .filter_map(|(n, one)| match one.search.ask() {
                Ask::Map(states) => Some((n, states)),
                Ask::Nothing => None,
            })
            .collect();
        if asks.is_empty() {
            break;
        }
        let starts = asks.iter().flat_map(|(n, states)| {
            let one = &all[*n];
            states.iter().map(|state| (one.instance, station(state, one.start.touching)))
        });
        let mut ends = map.after(starts.collect(), 1)?.into_iter();
        for (n, states) in asks {
            let one = &mut all[n];
            let values: Vec<_> = ends.by_ref().take(states.len()).map(|end| one.useful(end?)).collect();
            one.search.answer(&values);
        }
    }
    let mut lost = Vec::new();
    for one in all {
        let i = one.instance as usize;
        done.periods[i] += one.search.evaluations();
        match one.search.verdict() {
            Some(Verdict::Found(found)) => {
                done.found[i] = Some(Box::new(PeriodicState {
                    station: station(&found.state, one.start.touching),
                    multiplier: found.multiplier,
                    least_change: found.least_change,
                    steps: map.plan.cases[i].steps,
                }));
            }
            _ => lost.push((one.instance, one.start)),
        }
    }
    Ok(lost)
}

impl One {
    fn begin(plan: &Plan, instance: u32, start: Station, near: bool) -> Self {
        let case = &plan.cases[instance as usize];
        let driven = &plan.drives[case.drive as usize];
        let remembers = case.contact.law == Law::Jkr;
        let (step, last_step) = if remembers { ROUGH } else { SMOOTH };
        let options = Options {
            scale: driven.free.tip.norm().max(1e-15),
            tolerance: NEAR * plan.run.accuracy,
            enough: ENOUGH * plan.run.accuracy,
            step,
            last_step,
            most: MOST,
            near,
            stable: true,
        };
        let modes = driven.kept.modes.len().min(MODES_MAX);
        Self { instance, start, remembers, search: Search::new(vector(&start, modes), options) }
    }

    /// The map's answer, if it is one: numbers, and the same contact as before.
    fn useful(&self, end: Station) -> Option<DVector<f64>> {
        let good = end.finite && (!self.remembers || end.touching == self.start.touching);
        good.then(|| vector(&end, self.search.size() / 2))
    }
}

//! Many searches side by side: one run evaluates all that they ask for.

use super::harmonic_balance::balanced_orbit;
use super::initial_guess::{InitialGuess, Unconverged};
use super::instance_search::{InstanceSearch, padded};
use super::period_map::{PeriodMap, section, vector};
use super::size_dispatch::{BySize, by_size, with_size};
use super::tolerances::{
    FALLBACK_TOL_F32, NEWTON_TOL_F32, fallback_tol, jacobian_columns, jacobian_drop_tol, newton_tol, scale,
    starts_in_f32,
};
use super::{Jacobian, PeriodicState};
use crate::engine::{
    Engine, EngineError, JacobianStart, NewtonResult, NewtonStart, NewtonStarts, PeriodJacobian,
    ProfileSection, Progress,
};
use crate::kernel::Room;
use crate::periodic::{FixedPoint, Memory, PtcOutcome, SearchFailure, Size};
use crate::plan::{Plan, Precision, SectionState};
use nalgebra::{DefaultAllocator, DimName};
use std::sync::Arc;

/// Instances in one batch: enough to keep the engine busy, few enough for memory.
const BATCH_INSTANCES: usize = 8192;
/// The same for many modes: a Jacobian of 24 modes has 18 kB.
const BATCH_INSTANCES_MANY: usize = 1024;
/// Ends of the searches, by instance of the plan.
pub(super) struct BatchSolution {
    pub found: Vec<Option<Box<PeriodicState>>>,
    pub periods: Vec<u32>,
    /// Instances whose searches from the scene's start failed.
    pub left: Vec<Unconverged>,
    pub notes: Vec<String>,
}

/// Searches for the periodic states of `stepped`, on an engine that computes in f64.
pub(super) fn solve_batches(
    plan: &Plan,
    stepped: &[u32],
    from: InitialGuess,
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<BatchSolution, EngineError> {
    let (found, periods) = (vec![None; plan.len()], vec![0; plan.len()]);
    let mut done = BatchSolution { found, periods, left: Vec::new(), notes: Vec::new() };
    for (count, group) in by_size(plan, stepped) {
        for chunk in group.chunks(if count > 8 { BATCH_INSTANCES_MANY } else { BATCH_INSTANCES }) {
            if progress.stopped() {
                return Ok(done);
            }
            let map = PeriodMap::new(plan, chunk, engine, progress)?;
            let parts = map.spread(|slots| {
                let slots = (slots.start, slots.end);
                with_size(count, SearchBatch { plan, from, instances: chunk, map: &map, slots })
            });
            for part in parts {
                for end in part? {
                    let instance = chunk[end.slot as usize];
                    done.periods[instance as usize] += end.periods;
                    match end.state {
                        Ok(state) => done.found[instance as usize] = Some(state),
                        Err((waited, place)) => {
                            done.left.push(Unconverged {
                                instance,
                                section: place,
                                integrated: waited,
                                not_settling: false,
                            });
                        }
                    }
                }
            }
            done.notes.extend(map.notes());
        }
    }
    Ok(done)
}

/// The end of one instance's searches.
struct SearchEnd {
    /// Number in the batch.
    slot: u32,
    periods: u32,
    /// The state; else the periods from the first start to that of the last search, and the section state there.
    state: Result<Box<PeriodicState>, (u32, SectionState)>,
}

/// Instances of one size of state, numbered by their place in the list.
#[derive(Clone, Copy)]
struct SearchBatch<'a> {
    plan: &'a Plan,
    from: InitialGuess<'a>,
    instances: &'a [u32],
    map: &'a PeriodMap<'a>,
    /// Those of them that one thread takes.
    slots: (u32, u32),
}

/// An instance without a state yet, the periods stepped for it so far, and the start of the last search.
type UnsolvedSlot = (u32, u32, SectionState);

/// Whether a search follows one of these waits, after `waited` periods, before the run's end.
fn searches_later(waits: &[(u32, bool)], mut waited: u32, periods: u32) -> bool {
    waits.iter().any(|(warm, searches)| {
        waited += warm;
        *searches && waited < periods
    })
}

impl BySize for SearchBatch<'_> {
    type Output = Result<Vec<SearchEnd>, EngineError>;

    fn run<D: Size + DimName>(self) -> Self::Output
    where
        DefaultAllocator: Memory<D>,
    {
        let Self { plan, instances, from, .. } = self;
        let instance = |slot: u32| instances[slot as usize];
        let begin = |slot: u32| from.point(plan, instance(slot));
        let mut done = Vec::new();
        let (mut close, mut left): (Vec<Box<InstanceSearch<D>>>, Vec<UnsolvedSlot>) =
            (Vec::new(), Vec::new());
        for slot in self.slots.0..self.slots.1 {
            match self.near_start(slot) {
                Some(search) => close.push(search),
                None => left.push((slot, 0, begin(slot))),
            }
        }
        let lost = self.run_to_end(close, true, &mut done)?;
        left.extend(lost.into_iter().map(|(slot, periods, _)| (slot, periods, begin(slot))));
        let (mut waited, periods) = (0, plan.run.periods);
        for (n, &(warm, searches)) in from.warm_up().iter().enumerate() {
            // `[run] periods` bounds the searches, too: beyond it integration to steady state is cheaper.
            if left.is_empty() || waited + warm >= periods {
                break;
            }
            left = self.integrate_on(left, warm)?;
            waited += warm;
            if searches {
                let begun = |(slot, stepped, place)| {
                    let mut one = InstanceSearch::cold(plan, slot, instance(slot), place);
                    one.periods = stepped;
                    Box::new(one)
                };
                let last = !searches_later(&from.warm_up()[n + 1..], waited, periods);
                left = self.run_to_end(left.into_iter().map(begun).collect(), last, &mut done)?;
            }
        }
        self.map.progress.done(left.len() as u64);
        let end = |(slot, periods, place)| SearchEnd { slot, periods, state: Err((waited, place)) };
        done.extend(left.into_iter().map(end));
        Ok(done)
    }
}

impl SearchBatch<'_> {
    /// The search of an instance that begins near a periodic state; `None` if it begins elsewhere.
    fn near_start<D: Size + DimName>(self, slot: u32) -> Option<Box<InstanceSearch<D>>>
    where
        DefaultAllocator: Memory<D>,
    {
        let Self { plan, from, .. } = self;
        let instance = self.instances[slot as usize];
        let begin = || from.point(plan, instance);
        let search = match (from.state(instance), &from) {
            (known, InitialGuess::CurvePoints(along)) => {
                InstanceSearch::along_curve(plan, slot, instance, known, along)
            }
            (Some(place), _) => InstanceSearch::from_known(plan, slot, instance, place),
            (None, InitialGuess::Points(_) | InitialGuess::PointsOnly(_)) => {
                InstanceSearch::near(plan, slot, instance, begin())
            }
            (None, InitialGuess::Integrated(_)) => InstanceSearch::cold(plan, slot, instance, begin()),
            (None, _) if from.starts_free() => {
                InstanceSearch::near(plan, slot, instance, balanced_orbit(plan, instance)?)
            }
            (None, _) => return None,
        };
        Some(Box::new(search))
    }

    /// Integrates by `periods`; leaves out instances that were stopped.
    fn integrate_on(self, left: Vec<UnsolvedSlot>, periods: u32) -> Result<Vec<UnsolvedSlot>, EngineError> {
        let starts: Vec<_> = left.iter().map(|(slot, _, place)| (*slot, *place)).collect();
        let ends = self.map.after(&starts, periods)?.into_iter();
        Ok(left
            .into_iter()
            .zip(ends)
            .filter_map(|((slot, so_far, _), end)| Some((slot, so_far + periods, end?)))
            .collect())
    }

    /// Runs searches to their ends and returns those that failed. If no other search follows (`last`), rounds on the host
    /// repeat what the engine's own search does not find.
    fn run_to_end<D: Size + DimName>(
        self,
        all: Vec<Box<InstanceSearch<D>>>,
        last: bool,
        done: &mut Vec<SearchEnd>,
    ) -> Result<Vec<UnsolvedSlot>, EngineError>
    where
        DefaultAllocator: Memory<D>,
    {
        if all.is_empty() || !self.map.runs_newton() || matches!(self.from, InitialGuess::CurvePoints(_)) {
            return self.host_rounds(all, done);
        }
        let mut lost = Vec::new();
        let left = self.device_newton(all, last, (done, &mut lost))?;
        lost.extend(match last {
            true => self.host_rounds(left, done)?,
            false => left.into_iter().map(|one| (one.slot, one.stepped(), one.start)).collect(),
        });
        Ok(lost)
    }

    /// Searches round by round: evaluates all requests, then advances each search.
    fn host_rounds<D: Size + DimName>(
        self,
        mut all: Vec<Box<InstanceSearch<D>>>,
        done: &mut Vec<SearchEnd>,
    ) -> Result<Vec<UnsolvedSlot>, EngineError>
    where
        DefaultAllocator: Memory<D>,
    {
        let mut lost = Vec::new();
        if self.map.tells_jacobians() {
            let columns = |slot: u32| jacobian_columns(self.plan, self.instances[slot as usize]);
            all.iter_mut().for_each(|one| one.search.use_tangents(columns(one.slot)));
        }
        let mut room = Room::default();
        let (mut starts, mut slopes, mut values) = (Vec::new(), Vec::new(), Vec::new());
        while !all.is_empty() {
            starts.clear();
            slopes.clear();
            for one in &all {
                let places = one.search.ask().map(|state| section(state.as_slice(), one.start.touching));
                if one.search.wants_jacobian() {
                    let least = jacobian_drop_tol(self.plan, self.instances[one.slot as usize]);
                    slopes.extend(places.map(|station| JacobianStart { instance: one.slot, station, least }));
                } else {
                    starts.extend(places.map(|station| (one.slot, station)));
                }
            }
            let ends = self.map.after(&starts, 1)?;
            let mut sloped = self.map.after_with_jacobian(&slopes, &mut room)?.into_iter();
            let mut rest = ends.iter();
            self.map.progress.timed(ProfileSection::Algebra, || {
                for one in &mut all {
                    if one.search.wants_jacobian() {
                        one.tell_with_jacobian(sloped.next().flatten());
                        continue;
                    }
                    values.clear();
                    values.extend(rest.by_ref().take(one.search.ask_count()).map(|end| one.usable((*end)?)));
                    one.search.tell(&values);
                }
            });
            all.retain(|one| match one.search.verdict() {
                None => true,
                Some(PtcOutcome::Converged(found)) => {
                    done.push(self.end(one, found));
                    self.map.progress.done(1);
                    false
                }
                Some(PtcOutcome::Failed(why)) => {
                    self.map.progress.gave_up(*why);
                    lost.push((one.slot, one.stepped(), one.start));
                    false
                }
            });
        }
        Ok(lost)
    }

    /// Searches by the engine's own method, first in f32 where rounding allows, then in f64. Returns searches that failed; if
    /// another search follows, those that fail in f32 go there directly. Those that found an unstable state are `lost`.
    fn device_newton<D: Size + DimName>(
        self,
        mut all: Vec<Box<InstanceSearch<D>>>,
        last: bool,
        (done, lost): (&mut Vec<SearchEnd>, &mut Vec<UnsolvedSlot>),
    ) -> Result<Vec<Box<InstanceSearch<D>>>, EngineError>
    where
        DefaultAllocator: Memory<D>,
    {
        let (plan, instance) = (self.plan, |one: &InstanceSearch<D>| self.instances[one.slot as usize]);
        let early = |one: &InstanceSearch<D>| {
            one.search.pseudo_time().is_finite() && starts_in_f32(plan, instance(one))
        };
        let begin = |one: &InstanceSearch<D>| (one.slot, one.start, one.search.pseudo_time());
        let (which, begins): (Vec<usize>, Vec<_>) =
            (all.iter().enumerate()).filter(|(_, one)| early(one)).map(|(n, one)| (n, begin(one))).unzip();
        // States found in f32 are the start in f64, by full Newton steps.
        let mut next = Vec::new();
        for (n, sought) in which.into_iter().zip(self.newton_end(&begins, Precision::F32)?) {
            all[n].periods += sought.periods;
            next.extend(sought.found.map(|found| (n, found.end)));
        }
        let begins: Vec<_> = next.iter().map(|(n, place)| (all[*n].slot, *place, f64::INFINITY)).collect();
        let mut found: Vec<Option<PeriodJacobian>> = vec![None; all.len()];
        for ((n, _), sought) in next.iter().zip(self.newton_end(&begins, Precision::F64)?) {
            all[*n].periods += sought.periods;
            found[*n] = sought.found;
        }
        let (which, begins): (Vec<usize>, Vec<_>) = (all.iter().enumerate())
            .filter(|(n, one)| found[*n].is_none() && (last || !early(one)))
            .map(|(n, one)| (n, begin(one)))
            .unzip();
        for (n, sought) in which.into_iter().zip(self.newton_end(&begins, Precision::F64)?) {
            all[n].periods += sought.periods;
            found[n] = sought.found;
        }
        let mut left = Vec::new();
        for (one, found) in all.into_iter().zip(found) {
            let Some(PeriodJacobian { end, slope }) = found else {
                left.push(one);
                continue;
            };
            match FixedPoint::stable_fixed_point(vector(&end), padded(&slope)) {
                Some(found) => {
                    done.push(self.end(&one, &found));
                    self.map.progress.done(1);
                }
                None => {
                    self.map.progress.gave_up(SearchFailure::Unstable);
                    lost.push((one.slot, one.stepped(), one.start));
                }
            }
        }
        Ok(left)
    }

    /// Runs the engine's Newton searches from `begins` of (slot, section state, initial pseudo-time step in periods).
    fn newton_end(
        self,
        begins: &[(u32, SectionState, f64)],
        precision: Precision,
    ) -> Result<Vec<NewtonResult>, EngineError> {
        if begins.is_empty() {
            return Ok(Vec::new());
        }
        let plan = self.plan;
        let seek = |(slot, _, time): &(u32, SectionState, f64)| {
            let instance = self.instances[*slot as usize];
            NewtonStart {
                scale: scale(plan, instance),
                time: *time,
                least: jacobian_drop_tol(plan, instance),
            }
        };
        let (near, enough) = match precision {
            Precision::F32 => (NEWTON_TOL_F32, FALLBACK_TOL_F32),
            Precision::F64 => (newton_tol(plan), fallback_tol(plan)),
        };
        let seeks = NewtonStarts { near, enough, all: begins.iter().map(seek).collect() };
        self.map.newton(begins.iter().map(|(slot, place, _)| (*slot, *place)), &seeks, precision)
    }

    fn end<D: Size + DimName>(self, one: &InstanceSearch<D>, found: &FixedPoint<D>) -> SearchEnd
    where
        DefaultAllocator: Memory<D>,
    {
        let instance = self.instances[one.slot as usize];
        SearchEnd {
            slot: one.slot,
            periods: one.stepped(),
            state: Ok(Box::new(PeriodicState {
                section: section(found.state.as_slice(), one.start.touching),
                floquet: found.spectrum,
                steps: self.plan.steps(instance),
                basis: Arc::clone(&self.plan.driven(instance).kept),
                jacobian: Jacobian::Monodromy(found.slope.as_slice().into()),
                gap_slope: None,
            })),
        }
    }
}

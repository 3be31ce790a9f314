//! The period map of some instances, on any engine.

use super::free_jacobian::{free_monodromy, free_motion};
use super::{Jacobian, PeriodicState};
use crate::engine::{
    Engine, EngineError, JacobianStart, NewtonResult, NewtonResults, NewtonStarts, PeriodJacobian,
    PeriodJacobians, ProfileSection, Progress, ReturnMap,
};
use crate::kernel::{MODES_MAX, Room};
use crate::periodic::{Memory, Size};
use crate::plan::{KeptMode, Plan, Precision, ReducedBasis, SectionState, StartState};
use nalgebra::{Complex, DefaultAllocator, DimName, Matrix2, OMatrix, OVector, Vector2};
use rayon::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::ops::Range;
use std::sync::{Arc, Mutex, PoisonError};

/// Least and most instances that one thread takes through their searches: enough to fill its lanes, few enough for its cache.
/// Few instances are shared among all threads.
const INSTANCES_PER_THREAD: (u32, u32) = (8, 256);

/// Numbers of a fast mode are not multiplied or divided by more than this when a state is transferred.
const MAX_STORED_RATIO: f64 = 16.0;

/// Maps section states of a plan's instances to those some periods later, in f64.
pub(super) struct PeriodMap<'a> {
    pub plan: &'a Plan,
    instances: &'a [u32],
    engine: &'a dyn Engine,
    return_map: Option<Box<dyn ReturnMap>>,
    pub progress: &'a Progress,
    /// Messages of the engine.
    notes: Mutex<Vec<String>>,
}

impl<'a> PeriodMap<'a> {
    /// The map of these instances. The engine must compute in f64.
    pub fn new(
        plan: &'a Plan,
        instances: &'a [u32],
        engine: &'a dyn Engine,
        progress: &'a Progress,
    ) -> Result<Self, EngineError> {
        let quick = progress.timed(ProfileSection::Constants, || engine.return_map(plan, instances))?;
        Ok(Self { plan, instances, engine, return_map: quick, progress, notes: Mutex::default() })
    }

    /// Runs `work` for all instances: at once if the engine spreads a list over threads itself, else in parts on many threads.
    pub fn spread<T: Send>(&self, work: impl Fn(Range<u32>) -> T + Sync) -> Vec<T> {
        let count = self.instances.len() as u32;
        if self.return_map.is_none() {
            return vec![work(0..count)];
        }
        let size = count
            .div_ceil(rayon::current_num_threads() as u32)
            .clamp(INSTANCES_PER_THREAD.0, INSTANCES_PER_THREAD.1);
        let parts = (0..count.div_ceil(size)).into_par_iter();
        parts.map(|part| work(part * size..count.min((part + 1) * size))).collect()
    }

    /// Messages of the engine.
    pub fn notes(self) -> Vec<String> {
        self.notes.into_inner().unwrap_or_else(PoisonError::into_inner)
    }

    /// The section states `periods` later, for `starts` of (index in the list of instances, section state); `None` where the
    /// run was stopped.
    pub fn after(
        &self,
        starts: &[(u32, SectionState)],
        periods: u32,
    ) -> Result<Vec<Option<SectionState>>, EngineError> {
        if let Some(map) = &self.return_map {
            let steps = |slot: u32| self.plan.steps(self.instances[slot as usize]);
            let all: u64 = starts.iter().map(|(slot, _)| u64::from(steps(*slot))).sum();
            self.progress.foresee(all * u64::from(periods));
            return Ok(map.after(starts, periods, self.progress));
        }
        let trial = self.trial(starts.iter().copied(), periods);
        let outcome = self.engine.run(&trial, self.progress)?;
        self.notes.lock().unwrap_or_else(PoisonError::into_inner).extend(outcome.notes);
        Ok(outcome.ends.into_iter().map(|end| end.map(|end| *end)).collect())
    }

    /// A plan of `periods` periods from these starts.
    fn trial(&self, starts: impl Iterator<Item = (u32, SectionState)>, periods: u32) -> Plan {
        let (instances, places): (Vec<u32>, Vec<StartState>) =
            starts.map(|(slot, place)| (self.instances[slot as usize], StartState::from(place))).unzip();
        let mut trial = self.plan.trial(&instances, periods, 1);
        trial.precision = Precision::F64;
        trial.starts = Some(Arc::new(places));
        self.progress.foresee(trial.instance_steps());
        trial
    }
}

impl PeriodMap<'_> {
    /// Whether the map can compute Jacobians.
    pub fn tells_jacobians(&self) -> bool {
        self.return_map.is_some() || self.engine.tells_slopes()
    }

    /// The section states a period later, with the Jacobian of the period; `None` where the run was stopped or Jacobians are
    /// not available.
    pub fn after_with_jacobian(
        &self,
        starts: &[JacobianStart],
        room: &mut Room<f64>,
    ) -> Result<Vec<Option<PeriodJacobian>>, EngineError> {
        if let Some(map) = &self.return_map {
            let steps =
                |start: &JacobianStart| u64::from(self.plan.steps(self.instances[start.instance as usize]));
            self.progress.foresee(starts.iter().map(steps).sum());
            return Ok(map.sloped(starts, room, self.progress));
        }
        if starts.is_empty() {
            return Ok(Vec::new());
        }
        let trial = self.trial(starts.iter().map(|start| (start.instance, start.station)), 1);
        let least: Vec<f64> = starts.iter().map(|start| start.least).collect();
        let PeriodJacobians { all, notes } = self.engine.slopes(&trial, &least, self.progress)?;
        self.notes.lock().unwrap_or_else(PoisonError::into_inner).extend(notes);
        Ok(all)
    }
}

impl PeriodMap<'_> {
    /// Whether the engine runs whole Newton searches itself.
    pub fn runs_newton(&self) -> bool {
        self.engine.searches()
    }

    /// Results of the engine's own Newton searches from `starts` of (index in the list of instances, section state).
    pub fn newton(
        &self,
        starts: impl Iterator<Item = (u32, SectionState)>,
        seeks: &NewtonStarts,
        precision: Precision,
    ) -> Result<Vec<NewtonResult>, EngineError> {
        let trial = self.trial(starts, 1).in_precision(precision);
        let NewtonResults { all, notes } = self.engine.newton(&trial, seeks, self.progress)?;
        self.notes.lock().unwrap_or_else(PoisonError::into_inner).extend(notes);
        Ok(all)
    }
}

/// The lever at rest, apart from modes that are not kept, as the sample appears: a swing that grows from nothing.
pub(super) fn rest_state(plan: &Plan, instance: u32) -> SectionState {
    let case = plan.case(instance);
    let driven = plan.driven(instance);
    let free = &driven.free;
    // The run begins at the top of the free swing; section states lie half a step later.
    let angle = FRAC_PI_2 - free.angle + PI / f64::from(case.steps);
    let turn = Complex::from_polar(1.0, angle);
    let mut station = SectionState::FREE;
    for (k, mode) in driven.kept.modes.iter().enumerate().take(MODES_MAX) {
        let Some(index) = mode.index else { continue };
        let swing = free.mode(index) * turn * driven.instrument.modes[index].tip;
        (station.x[k], station.u[k]) = (-swing.im, -swing.re * free.omega / mode.omega);
    }
    let travel = free.amplitude * (PI / f64::from(case.steps)).cos() + station.x.iter().sum::<f64>();
    station.touching = case.contact.next_contact(-(case.gap + travel), false);
    station
}

/// Transfers a state with other steps per period or another lever to an instance's own. Section states lie half a step into
/// the period.
pub(super) struct BasisTransfer {
    /// Modes that both have.
    modes: Vec<ModeTransfer>,
}

/// A mode of both levers, or the law's memory. The residual oscillator of a smaller basis matches the mode that replaces it in
/// a larger one.
struct ModeTransfer {
    /// Index among the instance's modes, and among the other's.
    own: usize,
    other: usize,
    /// Free motion of the mode over the time between the two sections, forward and backward.
    there: Matrix2<f64>,
    back: Matrix2<f64>,
}

impl BasisTransfer {
    pub(super) fn new(
        plan: &Plan,
        instance: u32,
        (theirs, steps): (&ReducedBasis, u32),
        modes: usize,
    ) -> Self {
        let driven = plan.driven(instance);
        let own_steps = f64::from(plan.steps(instance));
        let later = PI / driven.free.omega * (1.0 / own_steps - 1.0 / f64::from(steps));
        let kept = driven.kept.modes.len();
        let own = &driven.kept.modes[..modes.min(kept)];
        // Modes of two levers are the same if their numbers are. The residual oscillators of two levers with the same modes stand
        // for the same motion.
        let copies = driven.kept.copies(theirs);
        let corresponding = |mode: &KeptMode| {
            let known = mode.index.is_some() || mode.is_static() || copies;
            theirs.modes.iter().position(|other| known && other.corresponds(mode))
        };
        let same = |mode: &KeptMode| {
            let equal = theirs.modes.iter().position(|other| other.omega == mode.omega);
            equal.or_else(|| corresponding(mode))
        };
        let turn = |mode: &KeptMode| {
            if later == 0.0 { Matrix2::identity() } else { free_motion(mode.omega * later, mode.damping) }
        };
        let both = |(own, mode): (usize, &KeptMode)| {
            let other = same(mode)?;
            let step = |steps: f64| TAU / (driven.free.omega * steps);
            let here = driven.kept.stored_share(mode, step(own_steps));
            let before = theirs.stored_share(&theirs.modes[other], step(f64::from(steps)));
            let ratio = stored_ratio(here, before);
            let there = turn(mode) * ratio;
            let back = there.try_inverse()?;
            Some(ModeTransfer { own, other, there, back })
        };
        let mut modes: Vec<ModeTransfer> = own.iter().enumerate().filter_map(both).collect();
        // A law's memory stays as it is.
        if plan.pairs(instance) > kept {
            let still = Matrix2::identity();
            modes.push(ModeTransfer { own: kept, other: theirs.modes.len(), there: still, back: still });
        }
        Self { modes }
    }

    /// Transfers the other's numbers, travels then rates, to `state`. A mode that the other lever lacks is at rest.
    pub(super) fn transfer<D: Size + DimName>(&self, theirs: &[f64], state: &mut OVector<f64, D>)
    where
        DefaultAllocator: Memory<D>,
    {
        let (modes, others) = (D::DIM / 2, theirs.len() / 2);
        state.fill(0.0);
        for ModeTransfer { own, other, there, .. } in &self.modes {
            let now = there * Vector2::new(theirs[*other], theirs[others + other]);
            (state[*own], state[modes + own]) = (now[0], now[1]);
        }
    }

    /// The map's Jacobian, from that of the other's map or, if this is unknown, from the free lever.
    fn monodromy<D: Size + DimName>(
        &self,
        plan: &Plan,
        instance: u32,
        theirs: &Jacobian,
    ) -> OMatrix<f64, D, D>
    where
        DefaultAllocator: Memory<D>,
    {
        let mut slope = free_monodromy::<D>(plan, instance).0;
        if let Some(theirs) = theirs.monodromy() {
            self.transfer_jacobian(&theirs, &mut slope);
        }
        slope
    }

    /// Transfers the other's Jacobian or resolvent, column by column, into `slope`. `slope` holds that of the free lever
    /// before, which remains for modes that the other lever lacks.
    pub(super) fn transfer_jacobian<D: Size + DimName>(&self, theirs: &[f64], slope: &mut OMatrix<f64, D, D>)
    where
        DefaultAllocator: Memory<D>,
    {
        // There is a row and a column for each number of a state; many may be at rest.
        let (modes, others) = (D::DIM / 2, theirs.len().isqrt() / 2);
        let theirs = |row: usize, column: usize| theirs[column * 2 * others + row];
        for ModeTransfer { own: k, other: j, there, .. } in &self.modes {
            for ModeTransfer { own: l, other: i, back, .. } in &self.modes {
                let (n, m) = (others + j, others + i);
                let block = Matrix2::new(theirs(*j, *i), theirs(*j, m), theirs(n, *i), theirs(n, m));
                let block = there * block * back;
                (slope[(*k, *l)], slope[(*k, modes + l)]) = (block[(0, 0)], block[(0, 1)]);
                (slope[(modes + k, *l)], slope[(modes + k, modes + l)]) = (block[(1, 0)], block[(1, 1)]);
            }
        }
    }

    /// A mode that the other lever lacks is at rest, that is free.
    fn section(&self, place: &PeriodicState) -> SectionState {
        let mut moved = SectionState { touching: place.section.touching, ..SectionState::FREE };
        for ModeTransfer { own, other, there, .. } in &self.modes {
            let now = there * Vector2::new(place.section.x[*other], place.section.u[*other]);
            (moved.x[*own], moved.u[*own]) = (now[0], now[1]);
        }
        moved
    }
}

/// A state found with other steps per period or another lever, as the instance's own section state.
pub(super) fn transfer_section(plan: &Plan, instance: u32, place: &PeriodicState) -> SectionState {
    let same = Arc::ptr_eq(&plan.driven(instance).kept, &place.basis) && plan.steps(instance) == place.steps;
    if same {
        place.section
    } else {
        BasisTransfer::new(plan, instance, (&place.basis, place.steps), MODES_MAX).section(place)
    }
}

/// Factor of a mode's numbers from a state that has the share `before` of them to one that has `here`. A mean near zero tells
/// little of what it is the mean of.
fn stored_ratio(here: f64, before: f64) -> f64 {
    let ratio = here / before;
    if ratio.is_finite() && ratio.abs() < MAX_STORED_RATIO && ratio.abs() > 1.0 / MAX_STORED_RATIO {
        ratio
    } else {
        1.0
    }
}

/// Distance between two section states, m.
pub(super) fn distance(a: &SectionState, b: &SectionState) -> f64 {
    let squares = |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum() };
    (squares(&a.x, &b.x) + squares(&a.u, &b.u)).sqrt()
}

/// Travels of `modes` modes, then their rates.
pub(super) fn section_numbers(station: &SectionState, modes: usize) -> Box<[f64]> {
    station.x[..modes].iter().chain(&station.u[..modes]).copied().collect()
}

/// Transfers a state found with other steps per period or another lever to the instance's own, with the map's Jacobian there.
pub(super) fn transfer_with_jacobian<D: Size + DimName>(
    plan: &Plan,
    instance: u32,
    place: &PeriodicState,
) -> (SectionState, OMatrix<f64, D, D>)
where
    DefaultAllocator: Memory<D>,
{
    let turned = BasisTransfer::new(plan, instance, (&place.basis, place.steps), D::DIM / 2);
    let slope = turned.monodromy(plan, instance, &place.jacobian);
    (turned.section(place), slope)
}

/// Travels of the modes, then their rates.
pub(super) fn vector<D: Size + DimName>(station: &SectionState) -> OVector<f64, D>
where
    DefaultAllocator: Memory<D>,
{
    let modes = D::DIM / 2;
    OVector::<f64, D>::from_iterator(station.x[..modes].iter().chain(&station.u[..modes]).copied())
}

/// The section state of these numbers: travels of the modes, then their rates.
pub(super) fn section(numbers: &[f64], touching: bool) -> SectionState {
    let (x, u) = numbers.split_at(numbers.len() / 2);
    let mut section = SectionState { touching, ..SectionState::FREE };
    section.x[..x.len()].copy_from_slice(x);
    section.u[..u.len()].copy_from_slice(u);
    section
}

//! Searches by Newton's method: one period with its Jacobian after another, each from the state that the last step reached,
//! until one is periodic.

use super::period_jacobian::{begun, ended, of_class};
use super::return_map::{CpuReturnMap, MapPassage};
use super::{EngineError, Noted, PeriodJacobian, ProfileSection, Progress};
use crate::kernel::broyden::{Arrival, Phase};
use crate::kernel::newton::{Aim, ROUNDS, Striding, Walk, arrive};
use crate::kernel::{LENGTH, Lane, Room, Rounding};
use crate::plan::{Plan, Precision, SectionState, StartState};
use rayon::prelude::*;

/// Instances in one thread's batch.
const INSTANCES_PER_BATCH: usize = 256;

/// Options of the searches for a plan's instances.
#[derive(Clone, Debug)]
pub struct NewtonStarts {
    /// Newton's tolerance on the step, in units of [`NewtonStart::scale`], and the tolerance where the map is too rough for
    /// that.
    pub near: f64,
    pub enough: f64,
    /// By instance of the plan.
    pub all: Vec<NewtonStart>,
}

/// Options of an instance's search.
#[derive(Clone, Copy, Debug)]
pub struct NewtonStart {
    /// Length unit of a state, m.
    pub scale: f64,
    /// Pseudo-time of the first step, periods; infinite for a full Newton step.
    pub time: f64,
    /// Approximate size of terms that Jacobians may drop.
    pub least: f64,
}

/// The end of a search.
#[derive(Clone, Debug)]
pub struct NewtonResult {
    /// `On` if the periods did not suffice.
    pub phase: Phase,
    /// Periods stepped.
    pub periods: u32,
    /// The state found, and the Jacobian of the last period, which began close to it.
    pub found: Option<PeriodJacobian>,
}

impl NewtonResult {
    /// Before the first period.
    pub const NOT_RUN: Self = Self { phase: Phase::On, periods: 0, found: None };
}

/// The ends of searches, by instance of the plan.
pub type NewtonResults = Noted<NewtonResult>;

impl NewtonStarts {
    /// The tolerances of an instance, in the kernel's units.
    pub(super) fn aim<E: Lane<Element = E>>(&self, instance: u32) -> Aim<E> {
        let scale = self.all[instance as usize].scale / LENGTH;
        Aim { scale: E::splat(scale), near: E::splat(self.near), enough: E::splat(self.enough) }
    }
}

/// The state that a search from `start` has reached, from its numbers in the kernel's units: travels, then rates.
pub(super) fn state(start: &SectionState, numbers: usize, number: impl Fn(usize) -> f64) -> SectionState {
    let touching = f64::from(u8::from(start.touching));
    ended(start, numbers / 2, |row| if row < numbers { number(row) } else { touching })
}

/// Runs the searches of these instances to their ends on the processor, in order and in the plan's precision.
pub(super) fn all(
    plan: &Plan,
    instances: &[u32],
    seeks: &NewtonStarts,
    rounding: Rounding,
    progress: &Progress,
) -> Result<Vec<NewtonResult>, EngineError> {
    let parts = instances.par_chunks(INSTANCES_PER_BATCH).map(|some| match plan.precision {
        Precision::F64 => {
            let map =
                progress.timed(ProfileSection::Constants, || CpuReturnMap::new(plan, some, rounding))?;
            let mut room = Room::default();
            run(iterates(plan, some, seeks), progress, |all, left| {
                in_f64((&map, &mut room), all, left, progress);
                Ok(())
            })
        }
        Precision::F32 => run(iterates(plan, some, seeks), progress, |all, left| {
            in_f32(plan, all, left, (rounding, progress))
        }),
    });
    Ok(parts.collect::<Result<Vec<_>, EngineError>>()?.concat())
}

/// A search in progress.
struct Iterate<E> {
    /// Number in the plan.
    instance: u32,
    start: SectionState,
    steps: u32,
    /// Whether contact depends on the past.
    remembers: bool,
    least: f64,
    aim: Aim<E>,
    /// See [`Striding`].
    place: Vec<E>,
    stride: Vec<E>,
    walk: Walk<E>,
    factors: Vec<E>,
    sought: NewtonResult,
}

fn iterates<E: Lane<Element = E>>(plan: &Plan, instances: &[u32], seeks: &NewtonStarts) -> Vec<Iterate<E>> {
    instances.iter().map(|instance| Iterate::new(plan, *instance, seeks)).collect()
}

impl<E: Lane<Element = E>> Iterate<E> {
    fn new(plan: &Plan, instance: u32, seeks: &NewtonStarts) -> Self {
        let start = begun(plan, instance);
        let modes = plan.pairs(instance);
        let numbers = start.x[..modes].iter().chain(&start.u[..modes]);
        let place: Vec<E> = numbers.map(|number| E::element(number / LENGTH)).collect();
        let seek = seeks.all[instance as usize];
        Self {
            instance,
            steps: plan.steps(instance),
            remembers: plan.law(instance).has_hysteresis(),
            least: seek.least,
            aim: seeks.aim(instance),
            stride: vec![E::splat(0.0); place.len()],
            walk: Walk::new(seek.time),
            factors: vec![E::splat(0.0); place.len().pow(2)],
            sought: NewtonResult::NOT_RUN,
            place,
            start,
        }
    }

    /// The start of the next period, in the kernel's units.
    fn from(&self) -> Vec<f64> {
        self.place.iter().zip(&self.stride).map(|(place, stride)| (*place + *stride).lane(0)).collect()
    }

    /// Handles the end of a period and its Jacobian.
    fn arrive(&mut self, end: &[f64], (touching, finite): (bool, bool), slope: Box<[f64]>) {
        let numbers = |list: &[f64]| list.iter().map(|value| E::element(*value)).collect::<Vec<E>>();
        let same = !self.remembers || touching == self.start.touching;
        let arrival = Arrival { strode: self.sought.periods > 0, sound: finite && same };
        let Self { place, stride, walk, factors, .. } = self;
        let here = Striding { place, stride, walk, factors };
        let phase = arrive(&numbers(end), &numbers(&slope), &self.aim, arrival, here);
        let found = (phase == Phase::Found).then(|| PeriodJacobian {
            end: state(&self.start, self.place.len(), |row| self.place[row].lane(0)),
            slope,
        });
        self.sought = NewtonResult { phase, periods: self.sought.periods + 1, found };
    }
}

/// Runs a thread's searches to their ends: `period` takes those in progress, given by index, through a period with its
/// Jacobian.
fn run<E: Lane<Element = E>>(
    mut all: Vec<Iterate<E>>,
    progress: &Progress,
    mut period: impl FnMut(&mut [Iterate<E>], &[usize]) -> Result<(), EngineError>,
) -> Result<Vec<NewtonResult>, EngineError> {
    let mut left: Vec<usize> = (0..all.len()).filter(|n| all[*n].steps > 0).collect();
    for round in 0..ROUNDS {
        if left.is_empty() || progress.stopped() {
            break;
        }
        if round > 0 {
            // One period of each is already expected with the plan.
            progress.foresee(left.iter().map(|n| u64::from(all[*n].steps)).sum());
        }
        period(&mut all, &left)?;
        left.retain(|n| all[*n].sought.phase == Phase::On);
    }
    Ok(all.into_iter().map(|way| way.sought).collect())
}

/// A period of each of these, by a map whose constants are made once.
fn in_f64(
    (map, room): (&CpuReturnMap, &mut Room<f64>),
    all: &mut [Iterate<f64>],
    left: &[usize],
    progress: &Progress,
) {
    let mut places: Vec<Vec<f64>> = left.iter().map(|n| all[*n].from()).collect();
    let least: Vec<f64> = left.iter().map(|n| all[*n].least).collect();
    let mut passing = Vec::with_capacity(left.len());
    for (n, state) in left.iter().zip(&mut places) {
        let touching = all[*n].start.touching;
        passing.push(MapPassage { instance: *n as u32, state, touching, finite: true });
    }
    let ended = |end: &MapPassage, slope| {
        all[end.instance as usize].arrive(end.state, (end.touching, end.finite), slope);
    };
    map.sloping((&mut passing, &least), room, ended, progress);
}

/// The same in f32. Numbers of f32 come back from metres unchanged.
fn in_f32(
    plan: &Plan,
    all: &mut [Iterate<f32>],
    left: &[usize],
    (rounding, progress): (Rounding, &Progress),
) -> Result<(), EngineError> {
    let instances: Vec<u32> = left.iter().map(|n| all[*n].instance).collect();
    let least: Vec<f64> = left.iter().map(|n| all[*n].least).collect();
    let place = |n: &usize| {
        let from = all[*n].from();
        StartState::from(state(&all[*n].start, from.len(), |row| from[row]))
    };
    let part = plan.part(&instances).starting_at(left.iter().map(place).collect());
    for class in &part.classes() {
        let told = of_class(&part, class, &least, rounding, progress)?;
        for (i, PeriodJacobian { end, slope }) in
            class.instances.iter().zip(told).filter_map(|(i, one)| Some((*i, one?)))
        {
            let way = &mut all[left[i as usize]];
            let modes = way.place.len() / 2;
            let numbers: Vec<f64> =
                end.x[..modes].iter().chain(&end.u[..modes]).map(|number| number / LENGTH).collect();
            way.arrive(&numbers, (end.touching, end.finite), slope);
        }
    }
    Ok(())
}

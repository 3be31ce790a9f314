//! Searches by Newton's steps, from where instances stand: one period with its Jacobian after another, each from where a step from
//! the last one has led, until one is a periodic state.

use super::period_jacobian::{begun, ended, of_class};
use super::return_map::{CpuReturnMap, MapPassage};
use super::{EngineError, PeriodJacobian, ProfileSection, Progress};
use crate::kernel::broyden::{Arrival, Phase};
use crate::kernel::newton::{Aim, ROUNDS, Striding, Walk, arrive};
use crate::kernel::{LENGTH, Lane, Room, Rounding};
use crate::plan::{Plan, Precision, SectionState, StartState};
use rayon::prelude::*;

/// Instances that one thread takes along together.
const INSTANCES_PER_BATCH: usize = 256;

/// How the instances of a plan are searched for.
#[derive(Clone, Debug)]
pub struct NewtonStarts {
    /// The longest step of Newton's that leads to a state, in units of [`NewtonStart::scale`]; and the same where the map is too rough
    /// for that.
    pub near: f64,
    pub enough: f64,
    /// By instance of the plan.
    pub all: Vec<NewtonStart>,
}

/// How an instance is.
#[derive(Clone, Copy, Debug)]
pub struct NewtonStart {
    /// Length of a state that is not small, m.
    pub scale: f64,
    /// Time that the first step stands for, periods; of infinitely many it is Newton's step.
    pub time: f64,
    /// About as much as may be left out of Jacobians.
    pub least: f64,
}

/// What became of a search.
#[derive(Clone, Debug)]
pub struct NewtonResult {
    /// On where so many periods were too few.
    pub phase: Phase,
    /// Periods stepped.
    pub periods: u32,
    /// The state that was found, and the Jacobian of the last period, which began next to it.
    pub found: Option<PeriodJacobian>,
}

impl NewtonResult {
    /// Before the first period.
    pub const NOT_RUN: Self = Self { phase: Phase::On, periods: 0, found: None };
}

/// What became of searches, by instance of the plan.
#[derive(Clone, Debug)]
pub struct NewtonResults {
    pub all: Vec<NewtonResult>,
    /// What a user should know of how it went: one line each.
    pub notes: Vec<String>,
}

impl NewtonResults {
    /// Before anything is searched for.
    pub fn none(plan: &Plan) -> Self {
        Self { all: vec![NewtonResult::NOT_RUN; plan.len()], notes: Vec::new() }
    }
}

impl NewtonStarts {
    /// What one looks for, in the kernel's units.
    pub(super) fn aim<E: Lane<Element = E>>(&self, instance: u32) -> Aim<E> {
        let scale = self.all[instance as usize].scale / LENGTH;
        Aim { scale: E::splat(scale), near: E::splat(self.near), enough: E::splat(self.enough) }
    }
}

/// The state that a search from `start` has come to, by its numbers in the kernel's units: travels, then rates.
pub(super) fn state(start: &SectionState, numbers: usize, number: impl Fn(usize) -> f64) -> SectionState {
    let touching = f64::from(u8::from(start.touching));
    ended(start, numbers / 2, |row| if row < numbers { number(row) } else { touching })
}

/// Takes searches of these instances to their ends on the processor, in their order and in the plan's precision.
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

/// A search on its way.
struct Iterate<E> {
    /// Of the plan.
    instance: u32,
    start: SectionState,
    steps: u32,
    /// Whether contact is a memory of the past.
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
        let modes = plan.driven(instance).kept.modes.len();
        let numbers = start.x[..modes].iter().chain(&start.u[..modes]);
        let place: Vec<E> = numbers.map(|number| E::element(number / LENGTH)).collect();
        let seek = seeks.all[instance as usize];
        Self {
            instance,
            steps: plan.steps(instance),
            remembers: plan.law(instance).has_memory(),
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

    /// Where the next period begins, in the kernel's units.
    fn from(&self) -> Vec<f64> {
        self.place.iter().zip(&self.stride).map(|(place, stride)| (*place + *stride).lane(0)).collect()
    }

    /// Takes in where a period has led, and its Jacobian.
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

/// Takes searches that one thread has to their ends: `period` takes those under way, by their numbers among all, through a
/// period with its Jacobian.
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
            // One period of each was foreseen with the plan.
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

/// The same in f32. Numbers of f32 come back from metres as they were.
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

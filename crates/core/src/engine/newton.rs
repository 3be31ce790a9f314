//! Searches by Newton's steps, from where instances stand: one period with its slope after another, each from where a stride from
//! the last one has led, until one is a periodic state.

use super::return_map::{Map, Passing};
use super::slopes::{begun, ended};
use super::{Busy, EngineError, Progress, Sloped};
use crate::kernel::broyden::{Arrival, Phase};
use crate::kernel::newton::{Aim, ROUNDS, Striding, Walk, arrive};
use crate::kernel::{LENGTH, Room, Rounding};
use crate::plan::{Plan, Station};
use rayon::prelude::*;

/// Instances that one thread takes along together.
const TOGETHER: usize = 256;

/// How the instances of a plan are searched for.
#[derive(Clone, Debug)]
pub struct Seeks {
    /// The longest step of Newton's that leads to a state, in units of [`Seek::scale`]; and the same where the map is too rough
    /// for that.
    pub near: f64,
    pub enough: f64,
    /// By instance of the plan.
    pub all: Vec<Seek>,
}

/// How an instance is.
#[derive(Clone, Copy, Debug)]
pub struct Seek {
    /// Length of a state that is not small, m.
    pub scale: f64,
    /// Time that the first stride stands for, periods; of infinitely many it is Newton's step.
    pub time: f64,
    /// About as much as may be left out of slopes.
    pub least: f64,
}

/// What became of a search.
#[derive(Clone, Debug)]
pub struct Sought {
    /// On where so many periods were too few.
    pub phase: Phase,
    /// Periods stepped.
    pub periods: u32,
    /// The state that was found, and the slope of the last period, which began next to it.
    pub found: Option<Sloped>,
}

impl Sought {
    /// Before the first period.
    pub const NOT_RUN: Self = Self { phase: Phase::On, periods: 0, found: None };
}

/// What became of searches, by instance of the plan.
#[derive(Clone, Debug)]
pub struct Searches {
    pub all: Vec<Sought>,
    /// What a user should know of how it went: one line each.
    pub notes: Vec<String>,
}

impl Searches {
    /// Before anything is searched for.
    pub fn none(plan: &Plan) -> Self {
        Self { all: vec![Sought::NOT_RUN; plan.len()], notes: Vec::new() }
    }
}

impl Seeks {
    /// What one looks for, in the kernel's units.
    pub(super) fn aim(&self, instance: u32) -> Aim<f64> {
        let scale = self.all[instance as usize].scale / LENGTH;
        Aim { scale, near: self.near, enough: self.enough }
    }
}

/// The state that a search from `start` has come to, by its numbers in the kernel's units: travels, then rates.
pub(super) fn state(start: &Station, numbers: usize, number: impl Fn(usize) -> f64) -> Station {
    let touching = f64::from(u8::from(start.touching));
    ended(start, numbers / 2, |row| if row < numbers { number(row) } else { touching })
}

/// Takes searches of these instances to their ends on the processor, in their order.
pub(super) fn all(
    plan: &Plan,
    instances: &[u32],
    seeks: &Seeks,
    rounding: Rounding,
    progress: &Progress,
) -> Result<Vec<Sought>, EngineError> {
    let parts = instances.par_chunks(TOGETHER).map(|some| {
        let map = progress.timed(Busy::Constants, || Map::new(plan, some, rounding))?;
        let all = some.iter().map(|instance| Way::new(plan, *instance, seeks)).collect();
        Ok(Together { map, all }.run(progress))
    });
    Ok(parts.collect::<Result<Vec<_>, EngineError>>()?.concat())
}

/// Searches that one thread takes along.
struct Together {
    map: Map,
    all: Vec<Way>,
}

/// One of them.
struct Way {
    start: Station,
    steps: u32,
    /// Whether contact is a memory of the past.
    remembers: bool,
    least: f64,
    aim: Aim<f64>,
    /// See [`Striding`].
    place: Vec<f64>,
    stride: Vec<f64>,
    walk: Walk<f64>,
    sought: Sought,
}

impl Way {
    fn new(plan: &Plan, instance: u32, seeks: &Seeks) -> Self {
        let start = begun(plan, instance);
        let modes = plan.driven(instance).kept.modes.len();
        let place: Vec<f64> =
            start.x[..modes].iter().chain(&start.u[..modes]).map(|number| number / LENGTH).collect();
        let seek = seeks.all[instance as usize];
        Self {
            steps: plan.steps(instance),
            remembers: plan.law(instance).has_memory(),
            least: seek.least,
            aim: seeks.aim(instance),
            stride: vec![0.0; place.len()],
            walk: Walk::new(seek.time),
            sought: Sought::NOT_RUN,
            place,
            start,
        }
    }

    /// Takes in where a period has led, and its slope.
    fn arrive(&mut self, end: &Passing, slope: Box<[f64]>, factors: &mut Vec<f64>) {
        factors.resize(slope.len(), 0.0);
        let same = !self.remembers || end.touching == self.start.touching;
        let arrival = Arrival { strode: self.sought.periods > 0, sound: end.finite && same };
        let Self { place, stride, walk, .. } = self;
        let here = Striding { place, stride, walk, factors };
        let phase = arrive(end.state, &slope, &self.aim, arrival, here);
        let found = (phase == Phase::Found)
            .then(|| Sloped { end: state(&self.start, self.place.len(), |row| self.place[row]), slope });
        self.sought = Sought { phase, periods: self.sought.periods + 1, found };
    }
}

impl Together {
    fn run(mut self, progress: &Progress) -> Vec<Sought> {
        let (mut room, mut factors) = (Room::default(), Vec::new());
        let mut left: Vec<usize> = (0..self.all.len()).filter(|n| self.all[*n].steps > 0).collect();
        for round in 0..ROUNDS {
            if left.is_empty() || progress.stopped() {
                break;
            }
            let from = |n: &usize| -> Vec<f64> {
                let way = &self.all[*n];
                way.place.iter().zip(&way.stride).map(|(place, stride)| place + stride).collect()
            };
            let mut places: Vec<Vec<f64>> = left.iter().map(from).collect();
            let least: Vec<f64> = left.iter().map(|n| self.all[*n].least).collect();
            let mut passing = Vec::with_capacity(left.len());
            for (n, state) in left.iter().zip(&mut places) {
                let touching = self.all[*n].start.touching;
                passing.push(Passing { instance: *n as u32, state, touching, finite: true });
            }
            if round > 0 {
                // One period of each was foreseen with the plan.
                progress.foresee(left.iter().map(|n| u64::from(self.all[*n].steps)).sum());
            }
            let all = &mut self.all;
            let ended = |end: &Passing, slope| all[end.instance as usize].arrive(end, slope, &mut factors);
            self.map.sloping((&mut passing, &least), &mut room, ended, progress);
            left.retain(|n| self.all[*n].sought.phase == Phase::On);
        }
        self.all.into_iter().map(|way| way.sought).collect()
    }
}

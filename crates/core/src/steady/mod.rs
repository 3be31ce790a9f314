//! The periodic state of each instance: waited for, or searched for and then run on from.

mod aims;
mod approach;
mod begin;
mod beside;
mod between;
mod carried;
mod feedback;
mod follow;
mod found;
mod guess;
mod late;
mod led;
mod linear;
mod lossless;
mod map;
mod measured;
mod missed;
mod node;
mod one;
mod own;
mod search;
mod setpoint;
mod sizes;
mod slow;
mod states;
mod turns;
mod wait;

pub use carried::{carried, carried_on};
pub use follow::{jumps_moved, place_jumps};
pub use led::{Patience, from_neighbours};
pub use linear::Linear;
pub use node::{Hint, Lead, Neighbour, Node};
pub use states::States;
pub use wait::SETTLED;

use crate::engine::{Cpu, Engine, EngineError, Finished, Outcome, Progress};
use crate::observe::Status;
use crate::periodic::Spectrum;
use crate::plan::{Plan, ReducedBasis, Station};
use crate::scene::{Start, Steady};
use begin::Begin;
use found::{found, run_on};
use std::sync::Arc;

/// A periodic state that was found.
#[derive(Clone, Debug, PartialEq)]
pub struct PeriodicState {
    pub station: Station,
    /// What the period map does to small deviations.
    pub spectrum: Spectrum,
    /// Steps per period with which it was found, and the lever.
    pub steps: u32,
    pub kept: Arc<ReducedBasis>,
    /// What is known of the period map near it; unknown where nobody is to search on from there.
    pub linear: Linear,
}

impl PeriodicState {
    /// At the free oscillation, with nothing known of the map there.
    fn unknown(steps: u32, kept: &Arc<ReducedBasis>) -> Self {
        let spectrum = Spectrum { multiplier: f64::NAN, least_change: f64::NAN };
        Self { station: Station::FREE, spectrum, steps, kept: Arc::clone(kept), linear: Linear::Unknown }
    }

    /// Whether a search found it; else waiting did.
    pub fn searched(&self) -> bool {
        !self.spectrum.multiplier.is_nan()
    }
}

/// A plan carried out.
#[derive(Clone, Debug)]
pub struct Settled {
    pub outcome: Outcome,
    /// By instance; empty where nothing was searched for, none where waiting found it or nothing did.
    pub found: Vec<Option<Box<PeriodicState>>>,
    /// By instance, periods stepped: those of the search, and those run on or waited.
    pub periods: Vec<u32>,
    /// By instance, whether its curve's state was not reached continuously from the point before; empty without curves.
    pub jumps: Vec<bool>,
}

impl Settled {
    /// The state found of an instance.
    pub fn state(&self, instance: usize) -> Option<&PeriodicState> {
        self.found.get(instance).and_then(Option::as_deref)
    }
}

/// Runs the plan as its scene says: periods waited for, or from states searched for. `near` holds states of the
/// same instances with other steps or levers, or nothing.
///
/// A state found is held to be one only if it is stable and, run on from, stays within the accuracy asked for (where
/// f32 is too coarse to tell, in f64); every other instance is waited for.
///
/// # Errors
/// What the engine says.
pub fn run(
    plan: &Plan,
    near: &[Option<&PeriodicState>],
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<Settled, EngineError> {
    begun(plan, near, Patience::Waits, engine, progress)
}

/// As [`run`], but that nothing is waited for where states are searched for: what no search finds is left as not run.
///
/// # Errors
/// What the engine says.
pub fn sought(
    plan: &Plan,
    near: &[Option<&PeriodicState>],
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<Settled, EngineError> {
    begun(plan, near, Patience::One, engine, progress)
}

fn begun(
    plan: &Plan,
    near: &[Option<&PeriodicState>],
    patience: Patience,
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<Settled, EngineError> {
    progress.part();
    if plan.run.steady == Steady::Wait || plan.stepped().is_empty() {
        return wait::run(plan, engine, progress);
    }
    // What a curve or an approach leads to is not to be looked for elsewhere.
    let told = plan.ensemble.curves.is_some() || plan.has_setpoints();
    let followed = told && near.iter().any(Option::is_some);
    let begin = if followed { Begin::Followed(near) } else { Begin::Near(near) };
    searched(plan, begin, (&[], patience), engine, progress)
}

/// As [`run`], but that a search begins at these states themselves, of whose slopes nothing need be known: it looks for the
/// states next to them, and not for others.
///
/// # Errors
/// What the engine says.
pub fn beside_states(
    plan: &Plan,
    states: &[Option<&PeriodicState>],
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<Settled, EngineError> {
    if plan.run.steady == Steady::Wait || states.is_empty() {
        return run(plan, states, engine, progress);
    }
    progress.part();
    searched(plan, Begin::Followed(states), (&[], Patience::Waits), engine, progress)
}

/// The plan's instances as a search from there finds them, or where neighbours lead, one by one, if they have `leads`; what is
/// not found is waited for, or left as not run.
fn searched(
    plan: &Plan,
    begin: Begin,
    (leads, patience): (&[Lead], Patience),
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<Settled, EngineError> {
    let (mut settled, mut left) = found(plan, &plan.stepped(), begin, engine, progress)?;
    settled.by_each(plan, leads, (|_| true, 1), engine, progress)?;
    left.retain(|one| settled.found[one.instance as usize].is_none());
    if matches!(begin, Begin::Brief(_)) {
        if patience == Patience::Later {
            settled.search_on(plan, left, engine, progress)?;
        }
        return Ok(settled);
    }
    let waits = patience == Patience::Waits;
    let left = match begin {
        Begin::Near(_) | Begin::Aside(_) if waits && plan.run.start == Start::Steady => {
            late::run(plan, left, &mut settled, engine, progress)?
        }
        _ => Vec::new(),
    };
    for wait in late::waits(plan, begin, left, waits, &settled) {
        settled.wait_for(plan, wait, engine, progress)?;
    }
    Ok(settled)
}

/// The first run of a plan: along its curves if it has some and searches, to its set-points if it has these, else each
/// instance on its own. Other runs of the same instances go on from what this one finds. The plan's gaps become those
/// that hold the set-points, NaN where none does.
///
/// # Errors
/// What the engine says.
pub fn begin(plan: &mut Plan, engine: &dyn Engine, progress: &Progress) -> Result<Settled, EngineError> {
    if plan.has_setpoints() {
        progress.part();
        return setpoint::begin(plan, engine, progress);
    }
    if plan.ensemble.curves.is_none() || plan.run.steady == Steady::Wait {
        return run(plan, &[], engine, progress);
    }
    progress.part();
    let cpu = Cpu::default();
    let double: &dyn Engine = if engine.double() { engine } else { &cpu };
    let followed = follow::along(plan, double, progress)?;
    let near: Vec<Option<&PeriodicState>> = followed.states.iter().map(Option::as_ref).collect();
    let mut settled = match progress.stopped() {
        true => as_followed(plan, &near, engine)?,
        false => run(plan, &near, engine, progress)?,
    };
    settled.periods.iter_mut().zip(&followed.periods).for_each(|(all, some)| *all += some);
    settled.outcome.notes.splice(0..0, followed.notes);
    settled.jumps = followed.jumps;
    Ok(settled)
}

/// Curves that were stopped on their way: what each point that they have reached is like, and nothing vouches for it.
fn as_followed(
    plan: &Plan,
    near: &[Option<&PeriodicState>],
    engine: &dyn Engine,
) -> Result<Settled, EngineError> {
    let count = plan.len();
    let mut outcome = Outcome { ends: Vec::new(), ..Outcome::of(plan) };
    let reached: Vec<u32> = plan.instances().filter(|i| near[*i as usize].is_some()).collect();
    let states: Vec<Option<&PeriodicState>> = reached.iter().map(|i| near[*i as usize]).collect();
    // A few periods of each: whoever stops a run waits for them.
    let on = run_on(plan.part(&reached), &states, engine, &Progress::default())?;
    for (i, finished) in reached.into_iter().zip(on.results) {
        outcome.results[i as usize] = Finished { status: Status::NotRun, ..finished };
    }
    Ok(Settled { outcome, found: vec![None; count], periods: vec![0; count], jumps: Vec::new() })
}

/// Another run of the plan's instances, with other steps or bases: as [`run`], and set-points are held again, from the plan's
/// gaps and the states `near`.
///
/// # Errors
/// What the engine says.
pub fn again(
    plan: &mut Plan,
    near: &[Option<&PeriodicState>],
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<Settled, EngineError> {
    let searches = plan.run.steady == Steady::Search && plan.ensemble.curves.is_none();
    match plan.has_setpoints() {
        true => setpoint::again(plan, near, engine, progress),
        false if searches && !near.is_empty() => own::run(plan, near, engine, progress),
        false => run(plan, near, engine, progress),
    }
}

/// States that are found from the lever at rest in place of its free oscillation, of these instances; the others'
/// results are not run. Of two branches of a tapping point it tends to find the one with less amplitude.
///
/// # Errors
/// What the engine says.
pub fn from_rest(
    plan: &Plan,
    instances: &[u32],
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<Settled, EngineError> {
    progress.part();
    Ok(found(plan, instances, Begin::Still, engine, progress)?.0)
}

/// States that are found from these places, one for each instance of the plan, in place of its free oscillation.
///
/// # Errors
/// What the engine says.
pub fn from_places(
    plan: &Plan,
    places: &[Station],
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<Settled, EngineError> {
    let all: Vec<u32> = plan.instances().collect();
    Ok(found(plan, &all, Begin::At(places), engine, progress)?.0)
}

/// States next to those of others, of one for each instance of the plan, as they are met with its steps and lever; nothing else is
/// looked for.
///
/// # Errors
/// What the engine says.
pub fn next_to(
    plan: &Plan,
    others: &[&PeriodicState],
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<Settled, EngineError> {
    let all: Vec<u32> = plan.instances().collect();
    let places: Vec<Station> = all.iter().zip(others).map(|(i, other)| map::own(plan, *i, other)).collect();
    Ok(found(plan, &all, Begin::NextTo(&places), engine, progress)?.0)
}

/// The states of these instances, for a plan of them alone; nothing where none were searched for.
pub fn of<'a>(found: &'a [Option<Box<PeriodicState>>], instances: &[u32]) -> Vec<Option<&'a PeriodicState>> {
    match found.is_empty() {
        true => Vec::new(),
        false => instances.iter().map(|i| found[*i as usize].as_deref()).collect(),
    }
}

/// The other way: states of a plan of `instances` alone, for the plan of which they are some, and which has `count`.
pub fn among<'a>(
    found: &'a [Option<Box<PeriodicState>>],
    instances: &[u32],
    count: usize,
) -> Vec<Option<&'a PeriodicState>> {
    let mut all = vec![None; if found.is_empty() { 0 } else { count }];
    instances.iter().zip(found).for_each(|(i, state)| all[*i as usize] = state.as_deref());
    all
}

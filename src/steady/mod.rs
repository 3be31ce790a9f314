//! The periodic state of each instance: waited for, or searched for and then run on from.

mod carried;
mod map;
mod search;
mod wait;

pub use carried::carried;
pub use wait::SETTLED;

use crate::engine::{Cpu, Engine, EngineError, Outcome, Progress};
use crate::periodic::Spectrum;
use crate::plan::{Plan, Precision, ReducedBasis, Station};
use crate::scene::Steady;
use search::Begin;
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
    /// The period map's slope there, column by column: travel of the kept modes, then rate over angular frequency.
    /// Empty where nobody is to search on from there.
    pub slope: Box<[f64]>,
}

/// A plan carried out.
#[derive(Clone, Debug)]
pub struct Settled {
    pub outcome: Outcome,
    /// By instance; empty where nothing was searched for, none where waiting found it or nothing did.
    pub found: Vec<Option<Box<PeriodicState>>>,
    /// By instance, periods stepped: those of the search, and those run on or waited.
    pub periods: Vec<u32>,
}

/// Periods that are run on from a state found, and measured but for the first: in a periodic state a few are as good as
/// many, and a period's change counts four periods long, but the first one's is not known.
const ON: u32 = 5;

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
    near: &[Option<Box<PeriodicState>>],
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<Settled, EngineError> {
    progress.part();
    let stepped = stepped(plan);
    if plan.run.steady == Steady::Wait || stepped.is_empty() {
        return wait::run(plan, &stepped, engine, progress);
    }
    let mut settled = found(plan, &stepped, Begin::Near(near), engine, progress)?;
    let rest = stepped.into_iter().filter(|i| settled.found[*i as usize].is_none());
    let rest: Vec<u32> = rest.collect();
    // What is free of the sample is finished beside those that wait.
    let free = plan.classes.iter().filter(|class| class.steps == 0);
    let others: Vec<u32> = free.flat_map(|class| &class.instances).chain(&rest).copied().collect();
    if !others.is_empty() && !progress.stopped() {
        let waited = wait::run(&plan.only(&others), &rest, engine, progress)?;
        others
            .iter()
            .for_each(|i| settled.outcome.results[*i as usize] = waited.outcome.results[*i as usize]);
        rest.iter().for_each(|i| settled.periods[*i as usize] += waited.periods[*i as usize]);
        settled.outcome.notes.extend(waited.outcome.notes);
    }
    Ok(settled)
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
    found(plan, instances, Begin::Still, engine, progress)
}

/// States that are found from these places, by instance of the plan, in place of its free oscillation; the results of
/// instances that are not asked for are not run.
///
/// # Errors
/// What the engine says.
pub fn from_places(
    plan: &Plan,
    instances: &[u32],
    places: &[Station],
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<Settled, EngineError> {
    found(plan, instances, Begin::At(places), engine, progress)
}

/// The plan's instances that need steps, in the classes' order.
fn stepped(plan: &Plan) -> Vec<u32> {
    let classes = plan.classes.iter().filter(|class| class.steps > 0);
    classes.flat_map(|class| class.instances.iter().copied()).collect()
}

/// What a search finds and running on confirms.
fn found(
    plan: &Plan,
    instances: &[u32],
    begin: Begin,
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<Settled, EngineError> {
    let cpu = Cpu::default();
    let double: &dyn Engine = if engine.double() { engine } else { &cpu };
    progress.task("search", instances.len() as u64);
    let searched = search::all(plan, instances, begin, double, progress)?;
    let (mut found, mut periods) = (searched.found, searched.periods);
    let chosen: Vec<u32> = instances.iter().copied().filter(|i| found[*i as usize].is_some()).collect();
    let mut outcome = run_on(plan, &chosen, &found, engine, progress)?;
    outcome.notes.splice(0..0, searched.notes);
    chosen.iter().for_each(|i| periods[*i as usize] += ON);
    let left = |outcome: &Outcome| -> Vec<u32> {
        let stays = |i: u32| outcome.results[i as usize].status.is_steady();
        chosen.iter().copied().filter(|i| !stays(*i)).collect()
    };
    let rough = left(&outcome);
    if plan.precision == Precision::F32 && !rough.is_empty() && !progress.stopped() {
        // A weakly damped state drifts in f32 by more than it may.
        let finer = Plan { precision: Precision::F64, ..plan.only(&rough) };
        let again = run_on(&finer, &rough, &found, double, progress)?;
        for i in rough {
            outcome.results[i as usize] = again.results[i as usize];
            periods[i as usize] += ON;
        }
    }
    left(&outcome).into_iter().for_each(|i| found[i as usize] = None);
    Ok(Settled { outcome, found, periods })
}

/// Measures these instances from the states found.
fn run_on(
    plan: &Plan,
    chosen: &[u32],
    found: &[Option<Box<PeriodicState>>],
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<Outcome, EngineError> {
    let mut from = plan.only(chosen);
    (from.run.periods, from.run.measure) = (ON, plan.run.measure.min(ON - 1));
    let mut stations = vec![Station::FREE; plan.cases.len()];
    for ((case, station), place) in from.cases.iter_mut().zip(&mut stations).zip(found) {
        if let Some(place) = place {
            *station = place.station;
            case.least_change = Some(place.spectrum.least_change);
        }
    }
    from.stations = Some(Arc::new(stations));
    progress.task("running on", 0);
    progress.foresee(from.instance_steps());
    let mut outcome = engine.run(&from, progress)?;
    outcome.ends = Vec::new();
    Ok(outcome)
}

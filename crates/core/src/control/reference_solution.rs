//! Results of the reference engine for instances that a stepped engine has run.

use super::{Arithmetic, ChunkRun, RunResult, step_reduction};
use crate::compare::Scales;
use crate::engine::{Cpu, Engine, EngineError, Finished, Progress, Reference, TOLERANCE, solve_near};
use crate::observe::{Measured, Status};
use crate::orbit::{self, OrbitSolution, OrbitTable};
use crate::plan::{Plan, Precision, SectionState};
use crate::scene::{Start, Steady};
use rayon::prelude::*;

/// A run by the reference engine. If the scene wants a search, the reference finds its own state near the one that the CPU
/// engine found.
///
/// # Errors
/// Those of the engines.
pub fn by_reference(
    plan: &Plan,
    reference: &Reference,
    progress: &Progress,
) -> Result<ChunkRun, EngineError> {
    progress.stage(&["reference"]);
    let search = plan.run.steady == Steady::Search;
    let mut plan = plan.clone();
    let mut settled = match search {
        true => by_search(&mut plan, progress)?,
        false => orbit::solve(&plan, &[], reference, progress)?,
    };
    if search {
        // The reference replaces the CPU engine's results, except where no set-point was found.
        let held = |i: &u32| settled.outcome.results[*i as usize].status != Status::NoSetpoint;
        let stepped: Vec<u32> = plan.stepped().into_iter().filter(held).collect();
        let truths = match progress.stopped() {
            true => vec![Finished::NOT_RUN; stepped.len()],
            false => {
                let known = |i: u32| settled.state(i as usize).map(|place| place.section);
                reference_solutions(&plan, true, &stepped, &known, &ReferenceSolver::of(reference), progress)?
            }
        };
        stepped.iter().zip(truths).for_each(|(i, truth)| settled.outcome.results[*i as usize] = truth);
    }
    let reason = "the reference engine has no other".into();
    let arithmetic = Arithmetic { of: vec![Precision::F64; plan.len()], rounding: f64::NAN, reason };
    Ok(ChunkRun::unestimated(plan, settled, arithmetic))
}

/// Searches with the CPU engine in the way of a controlled run, so that both find the same of two states. The plan takes the
/// gaps that hold its set-points.
fn by_search(plan: &mut Plan, progress: &Progress) -> Result<OrbitSolution, EngineError> {
    let (engine, stepped) = (Cpu::default(), plan.stepped());
    let mut fine = plan.clone().in_precision(Precision::F64);
    let settled = match plan.run.steps_per_period {
        Some(_) => orbit::solve_first(&mut fine, &engine, progress)?,
        None => {
            let mut quarter = step_reduction::quarter_steps(fine.part(&stepped));
            let rough = orbit::solve_first(&mut quarter, &engine, progress)?;
            let near = orbit::scatter(&rough.found, &stepped, plan.len());
            fine.take_gaps(&stepped, &quarter);
            let settled = orbit::solve_again(&mut fine, &near, &engine, progress)?;
            let mut jumps = vec![false; if rough.jumps.is_empty() { 0 } else { plan.len() }];
            stepped.iter().zip(&rough.jumps).for_each(|(i, jump)| jumps[*i as usize] = *jump);
            OrbitSolution { jumps, ..settled }
        }
    };
    let all: Vec<u32> = plan.instances().collect();
    plan.take_gaps(&all, &fine);
    Ok(settled)
}

/// Section state of an instance in its periodic motion, if known.
pub(super) type KnownSections<'a> = &'a (dyn Fn(u32) -> Option<SectionState> + Sync);

/// The section states of these orbits.
pub(super) fn known_sections(found: &OrbitTable) -> impl Fn(u32) -> Option<SectionState> + Sync + '_ {
    |instance| found.get(instance as usize).map(|state| state.section)
}

/// Section states of these instances in their periodic motion: those found, or else those at the end of a run of the stepped
/// engine. None for runs from rest, whose start matters.
fn stations(
    plan: &Plan,
    instances: &[u32],
    known: KnownSections,
    progress: &Progress,
) -> Result<Vec<Option<SectionState>>, EngineError> {
    if plan.run.start == Start::Rest {
        return Ok(vec![None; instances.len()]);
    }
    let waiting: Vec<u32> = instances.iter().copied().filter(|i| known(*i).is_none()).collect();
    let mut ends = std::collections::HashMap::new();
    if !waiting.is_empty() {
        let mut trial = plan.trial(&waiting, plan.run.periods, plan.run.measure);
        trial.precision = Precision::F64;
        let starts = trial.instances().map(|i| SectionState::free(&trial, i).into()).collect();
        let ended = Cpu::default().run(&trial.starting_at(starts), progress)?.ends;
        ends.extend(waiting.into_iter().zip(ended));
    }
    let end = |i: u32| ends.get(&i)?.as_deref().copied().filter(|station| station.finite);
    Ok(instances.iter().map(|i| known(*i).or_else(|| end(*i))).collect())
}

/// The reference engine, with a callback for each finished instance.
pub(super) struct ReferenceSolver<'a> {
    pub reference: &'a Reference,
    /// Called with an instance of the plan and its result.
    pub told: &'a (dyn Fn(u32, &Finished) + Sync),
}

impl<'a> ReferenceSolver<'a> {
    /// A solver without a callback.
    pub fn of(reference: &'a Reference) -> Self {
        Self { reference, told: &|_, _| () }
    }
}

/// Result of an instance near whose state the reference finds none.
const NO_REFERENCE: Finished = Finished { measured: Measured::NONE, status: Status::NotSteady };

/// The reference's results for these instances: their periodic states near where the stepped engine was. If there is none,
/// the instance runs whole if `wait` is set, and else is not steady. Runs from rest are whole. Contact time is always
/// measured.
pub(super) fn reference_solutions(
    plan: &Plan,
    wait: bool,
    instances: &[u32],
    known: KnownSections,
    judge: &ReferenceSolver,
    progress: &Progress,
) -> Result<Vec<Finished>, EngineError> {
    let waits = wait || plan.run.start == Start::Rest;
    let told = |i: u32, found: Option<&Finished>| match found {
        Some(one) if one.status != Status::NotRun => (judge.told)(i, one),
        // A stopped search has not looked everywhere.
        None if !waits && !progress.stopped() => (judge.told)(i, &NO_REFERENCE),
        _ => (),
    };
    let near = near((plan, instances), known, judge.reference, &told, progress)?;
    let none = || (0..instances.len()).filter(|n| near[*n].is_none());
    let left: Vec<u32> = match waits {
        true => none().map(|n| instances[n]).collect(),
        false => Vec::new(),
    };
    let lost = if progress.stopped() { Finished::NOT_RUN } else { NO_REFERENCE };
    let mut whole = whole(plan, &left, judge, progress)?.into_iter();
    Ok(near.into_iter().map(|one| one.or_else(|| whole.next()).unwrap_or(lost)).collect())
}

/// The reference's periodic state of an instance near a section state, at the plan's gap.
fn near_station(
    (plan, n): (&Plan, usize),
    station: &SectionState,
    reference: &Reference,
    progress: &Progress,
) -> Result<Option<Finished>, EngineError> {
    let near = solve_near(plan, n, station, reference, progress)?;
    match near.and_then(|one| finer(plan, n, &one.measured, reference)) {
        Some(finer) => solve_near(plan, n, station, &finer, progress),
        None => Ok(near),
    }
}

/// The reference's periodic states of these instances near where the stepped engine was, at their gaps or at those that hold
/// their set-points. None if there is none, or the start matters.
fn near(
    (plan, instances): (&Plan, &[u32]),
    known: KnownSections,
    reference: &Reference,
    told: &(dyn Fn(u32, Option<&Finished>) + Sync),
    progress: &Progress,
) -> Result<Vec<Option<Finished>>, EngineError> {
    let stations = stations(plan, instances, known, progress)?;
    let part = with_contact(plan, instances);
    progress.task("periodic states", instances.len() as u64);
    // Keep the order: a stopped run has done the first ones.
    let mut near = vec![None; instances.len()];
    let done: Vec<(usize, Option<Finished>)> = stations
        .iter()
        .enumerate()
        .par_bridge()
        .filter_map(|(n, station)| Some((n, station.as_ref()?)))
        .map(|(n, station)| {
            let near = match part.has_setpoints() {
                true => {
                    let tolerance = SETPOINT_TOL_SHARE * part.run.accuracy;
                    let at = |plan: &Plan| near_station((plan, 0), station, reference, progress);
                    orbit::hold_setpoint(&part.part(&[n as u32]), tolerance, at)?
                }
                false => near_station((&part, n), station, reference, progress)?,
            };
            told(instances[n], near.as_ref());
            progress.done(1);
            Ok((n, near))
        })
        .collect::<Result<_, EngineError>>()?;
    done.into_iter().for_each(|(n, found)| near[n] = found);
    Ok(near)
}

/// The reference with finer steps, if those it has move the contact force by too much. Their tolerance is one of travel: a
/// stiff contact that holds the tip of a lever driven far turns it into a large part of a small force.
fn finer(plan: &Plan, instance: usize, measured: &Measured, reference: &Reference) -> Option<Reference> {
    let (driven, contact) = (plan.driven(instance as u32), plan.contact(instance as u32));
    let stiffness = contact.stiffness(measured.indentation_max, true).abs();
    let force = Scales::of(plan, instance, measured).force;
    let error = reference.tolerance * driven.free_amplitude() * stiffness / force;
    let allowed = STEP_ERROR_SHARE * plan.run.accuracy;
    let tolerance = (reference.tolerance * allowed / error).max(TOLERANCE);
    (error > allowed && tolerance < reference.tolerance).then_some(Reference { tolerance, ..*reference })
}

/// Whole runs of these instances, in their order.
fn whole(
    plan: &Plan,
    instances: &[u32],
    judge: &ReferenceSolver,
    progress: &Progress,
) -> Result<Vec<Finished>, EngineError> {
    if instances.is_empty() {
        return Ok(Vec::new());
    }
    let left = with_contact(plan, instances);
    progress.task("waiting", 0);
    progress.foresee(left.instance_steps());
    let one = |(n, i): (usize, &u32)| {
        let finished = judge.reference.alone(&left, n, progress)?;
        if finished.status != Status::NotRun {
            (judge.told)(*i, &finished);
        }
        Ok(finished)
    };
    instances.par_iter().enumerate().map(one).collect()
}

/// The plan of these instances, with contact time measured.
fn with_contact(plan: &Plan, instances: &[u32]) -> Plan {
    let mut part = plan.part(instances);
    part.wants.contact = true;
    part
}

/// How the reference reached a result.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReferenceStart {
    /// By the run that the scene describes.
    Run,
    /// By its own periodic state near the end of the run or the state found.
    State,
}

impl ReferenceStart {
    /// A few words for the user.
    pub fn words(self) -> &'static str {
        match self {
            Self::Run => "run as the scene says",
            Self::State => "periodic state next to the run's",
        }
    }
}

/// The reference's results for these instances, to compare with a run. For a scene that integrates, the reference does the
/// whole run and, if that does not settle, finds the periodic state near the run's end. For a scene that searches, it finds
/// the periodic state near the run's and, if there is none, does the whole run. Points of a curve have no run of their own:
/// the reference can only start from the curve's states.
///
/// # Errors
/// Those of the engines.
pub fn beside(
    run: &RunResult,
    chosen: &[u32],
    reference: &Reference,
    progress: &Progress,
) -> Result<Vec<(Finished, ReferenceStart)>, EngineError> {
    // Without a gap that holds its set-point an instance has no place where the reference could begin.
    let held = |i: &u32| !run.plan.case(*i).gap.is_nan();
    let some: Vec<u32> = chosen.iter().copied().filter(held).collect();
    let mut found = beside_held(run, &some, reference, progress)?.into_iter();
    let one = |i: &u32| if held(i) { found.next() } else { None };
    let lost = (orbit::NO_SETPOINT, ReferenceStart::State);
    Ok(chosen.iter().map(one).map(|one| one.unwrap_or(lost)).collect())
}

/// The same for instances that have a gap.
fn beside_held(
    run: &RunResult,
    chosen: &[u32],
    reference: &Reference,
    progress: &Progress,
) -> Result<Vec<(Finished, ReferenceStart)>, EngineError> {
    let plan = &run.plan;
    let search = plan.run.steady == Steady::Search;
    let first: Vec<Option<(Finished, ReferenceStart)>> = match search {
        true => {
            let near = near((plan, chosen), &known_sections(&run.found), reference, &|_, _| (), progress)?;
            near.into_iter().map(|one| one.map(|one| (one, ReferenceStart::State))).collect()
        }
        false => {
            let whole = whole(plan, chosen, &ReferenceSolver::of(reference), progress)?;
            whole.into_iter().map(|one| Some((one, ReferenceStart::Run))).collect()
        }
    };
    let settled =
        |one: &Option<(Finished, ReferenceStart)>| one.is_some_and(|(one, _)| one.status == Status::Ok);
    let unsettled = chosen.iter().zip(&first).filter(|(_, one)| !settled(one));
    let left: Vec<u32> = unsettled.map(|(i, _)| *i).collect();
    let second: Vec<Option<Finished>> = match search {
        true if plan.ensemble.curves.is_some() => vec![None; left.len()],
        true => {
            whole(plan, &left, &ReferenceSolver::of(reference), progress)?.into_iter().map(Some).collect()
        }
        false => near((plan, &left), &known_sections(&run.found), reference, &|_, _| (), progress)?,
    };
    let way = if search { ReferenceStart::Run } else { ReferenceStart::State };
    let mut second = second.into_iter();
    let last = |first: Option<(Finished, ReferenceStart)>| {
        if settled(&first) {
            return first;
        }
        let second = second.next().flatten().map(|one| (one, way));
        if settled(&second) || first.is_none() { second } else { first }
    };
    let not_run = (Finished::NOT_RUN, ReferenceStart::Run);
    Ok(first.into_iter().map(last).map(|one| one.unwrap_or(not_run)).collect())
}

/// Whether the tip touches the sample. Contact time must have been measured.
pub fn touches(one: &Finished) -> bool {
    one.measured.contact_time > 0.0
}

/// Share of the tip's flexibility up to which the reference truncates modes.
const REFERENCE_DROP_SHARE: f64 = 1e-6;
/// Largest error from replacing modes far faster than the contact by an oscillator or two, found on random levers redone with
/// all modes (0.23 N/m on 33 GPa, JKR, requested accuracy 1e-4). At a looser accuracy more modes are replaced, so the error
/// is bounded by a share of the accuracy.
const REDUCTION_ERROR: f64 = 4e-5;
const REDUCTION_ERROR_SHARE: f64 = 0.4;
/// Largest error of the contact force by the reference's steps, as a share of the accuracy.
const STEP_ERROR_SHARE: f64 = 0.1;
/// Set-points are held by the reference to this share of the accuracy, and their gaps, in free amplitudes.
const SETPOINT_TOL_SHARE: f64 = 5e-3;
/// The reference's steps may leave an error of this many of their tolerances, whatever it truncates.
const MIN_STEP_ERROR_TOLERANCES: f64 = 100.0;

/// Upper bound of the reference's own error. Truncated modes act like a spring of their flexibility in series with the
/// contact, unless there are enough of them for an oscillator. Its steps have a tolerance.
pub fn reference_error(plan: &Plan, instance: usize, measured: &Measured) -> f64 {
    let modes = &plan.driven(instance as u32).instrument.modes;
    let mut shares: Vec<f64> =
        modes.iter().map(|mode| (mode.inverse_mass() / (mode.omega * mode.omega)).abs()).collect();
    shares.sort_by(f64::total_cmp);
    let whole: f64 = shares.iter().sum();
    let mut left = 0.0;
    for share in shares {
        if left + share > REFERENCE_DROP_SHARE * whole {
            break;
        }
        left += share;
    }
    let error = gives_way(plan, instance, measured, left);
    let most = REDUCTION_ERROR.max(REDUCTION_ERROR_SHARE * plan.run.accuracy);
    if error.is_finite() { error.clamp(MIN_STEP_ERROR_TOLERANCES * TOLERANCE, most) } else { f64::NAN }
}

/// Approximate error from omitting `flexibility` (m/N) of the tip: a spring in series with the contact. The contact's
/// stiffness is that at the deepest indentation measured or, without one, expected.
pub(super) fn gives_way(plan: &Plan, instance: usize, measured: &Measured, flexibility: f64) -> f64 {
    let contact = plan.contact(instance as u32);
    let depth = match measured.indentation_max.is_nan() {
        true => plan.expected_depth(instance as u32),
        false => measured.indentation_max,
    };
    flexibility * contact.stiffness(depth, true).abs()
}

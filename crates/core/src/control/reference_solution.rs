//! What the reference engine makes of instances whose motion a stepped engine has seen.

use super::{Arithmetic, ChunkRun, RunResult, step_reduction};
use crate::engine::{
    Cpu, Engine, EngineError, Finished, Progress, Reference, TOLERANCE, dropped_flexibility, solve_near,
};
use crate::observe::{Measured, Status};
use crate::orbit::{self, OrbitSolution, OrbitTable};
use crate::plan::{Plan, Precision, SectionState};
use crate::scene::{Start, Steady};
use rayon::prelude::*;

/// A run by the reference engine. States that the scene wants searched for are the reference's own next to those that
/// the CPU engine finds.
///
/// # Errors
/// What the engines say.
pub fn by_reference(
    plan: &Plan,
    reference: &Reference,
    progress: &Progress,
) -> Result<ChunkRun, EngineError> {
    progress.stage(&["reference"]);
    let count = plan.len();
    let search = plan.run.steady == Steady::Search;
    let mut plan = plan.clone();
    let OrbitSolution { mut outcome, found, periods, jumps } = match search {
        true => by_search(&mut plan, progress)?,
        false => orbit::solve(&plan, &[], reference, progress)?,
    };
    if search {
        // What the CPU engine found is not the reference's word, but where it found no set-point.
        let held = |i: &u32| outcome.results[*i as usize].status != Status::NoSetpoint;
        let stepped: Vec<u32> = plan.stepped().into_iter().filter(held).collect();
        let truths = match progress.stopped() {
            true => vec![Finished::NOT_RUN; stepped.len()],
            false => {
                let known = |i: u32| found.get(i as usize)?.as_deref().map(|place| place.section);
                reference_solutions(&plan, true, &stepped, &known, &ReferenceSolver::of(reference), progress)?
            }
        };
        stepped.iter().zip(truths).for_each(|(i, truth)| outcome.results[*i as usize] = truth);
    }
    let unknown = vec![f64::NAN; count];
    Ok(ChunkRun {
        plan: plan.clone(),
        outcome,
        estimates: unknown.clone(),
        truncation: unknown,
        found,
        periods,
        jumps,
        neighbour_started: Vec::new(),
        arithmetic: Arithmetic::of(
            &plan.clone().in_precision(Precision::F64),
            "the reference engine has no other",
        ),
        solved: Vec::new(),
        from_rest: Vec::new(),
    })
}

/// The states that the CPU engine finds by the same way as a controlled run, so that of two it is the same one; the plan
/// takes the gaps that hold its set-points.
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

/// Where an instance is in its periodic motion, if that is known.
pub(super) type KnownSections<'a> = &'a (dyn Fn(u32) -> Option<SectionState> + Sync);

/// As these states tell.
pub(super) fn known_sections(found: &OrbitTable) -> impl Fn(u32) -> Option<SectionState> + Sync + '_ {
    |instance| found.get(instance as usize).map(|state| state.section)
}

/// Where these instances are in their periodic motion: as found, or else as the stepped engine leaves them at the
/// end of the run; none for runs from rest, whose beginning counts.
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

/// The reference engine, and who is told of each instance that it has redone.
pub(super) struct ReferenceSolver<'a> {
    pub reference: &'a Reference,
    /// Told of an instance of the plan and what has become of it.
    pub told: &'a (dyn Fn(u32, &Finished) + Sync),
}

impl<'a> ReferenceSolver<'a> {
    /// Nobody is told.
    pub fn of(reference: &'a Reference) -> Self {
        Self { reference, told: &|_, _| () }
    }
}

/// What is said of an instance next to whose state the reference finds none.
const NO_REFERENCE: Finished = Finished { measured: Measured::NONE, status: Status::NotSteady };

/// The reference's results of these instances: their periodic states next to where the stepped engine was; where that
/// has none, a whole run if it is to `wait`, and else the word that it is not steady. Runs from rest are whole ones.
/// Contact time is measured, whether the plan wants it or not.
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
        // Who was stopped on the way has not looked everywhere.
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

/// The reference's periodic states of these instances next to where the stepped engine was; none where it finds none or
/// the beginning counts.
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
    // In their order: a run that is stopped has done the first ones.
    let mut near = vec![None; instances.len()];
    let done: Vec<(usize, Option<Finished>)> = stations
        .iter()
        .enumerate()
        .par_bridge()
        .filter_map(|(n, station)| Some((n, station.as_ref()?)))
        .map(|(n, station)| {
            let near = solve_near(&part, n, station, reference, progress)?;
            told(instances[n], near.as_ref());
            progress.done(1);
            Ok((n, near))
        })
        .collect::<Result<_, EngineError>>()?;
    done.into_iter().for_each(|(n, found)| near[n] = found);
    Ok(near)
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

/// These instances alone, with the contact time measured.
fn with_contact(plan: &Plan, instances: &[u32]) -> Plan {
    let mut part = plan.part(instances);
    part.wants.contact = true;
    part
}

/// How the reference came to a result.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReferenceStart {
    /// By the run that the scene describes.
    Run,
    /// As its own periodic state next to where the run ended or what its search found.
    State,
}

impl ReferenceStart {
    /// In a few words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Run => "run as the scene says",
            Self::State => "periodic state next to the run's",
        }
    }
}

/// What the reference makes of these instances of a run, to be held against it: of a scene that waits the whole run, or,
/// where that does not settle, the periodic state next to where the run ended; of one that searches the periodic state
/// next to the one found, or, where there is none, the whole run. Points of a curve have no run of their own: where the
/// curve has led is all that the reference can begin at.
///
/// # Errors
/// What the engines say.
pub fn beside(
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

/// Whether the tip touches the sample, where the contact time was measured.
pub fn touches(one: &Finished) -> bool {
    one.measured.contact_time > 0.0
}

/// What an oscillator or two in place of modes far faster than the contact cost at the most: the largest of random levers
/// that were redone with all modes (one of 0.23 N/m on 33 GPa, JKR, asked for 1e-4). Where less is asked for, more modes are
/// left to them: it is no larger share of the accuracy.
const MAX_REDUCED_FLEXIBILITY: f64 = 4e-5;
const REDUCED_FLEXIBILITY_SHARE: f64 = 0.4;
/// Largest distance to the periodic state that the reference's steps allow, in tolerances of theirs.
const MAX_TRUNCATION_MODES: f64 = 100.0;

/// What the reference itself may be off by, at the most: the modes that it leaves out give way to the contact like a spring
/// of their flexibility in series with it, unless they are many enough to be an oscillator; and its steps have a tolerance.
pub fn truncation_error(plan: &Plan, instance: usize, measured: &Measured) -> f64 {
    let case = plan.case(instance as u32);
    let left = dropped_flexibility(plan.driven(instance as u32), &case.contact, case.gap);
    let error = gives_way(plan, instance, measured, left);
    let most = MAX_REDUCED_FLEXIBILITY.max(REDUCED_FLEXIBILITY_SHARE * plan.run.accuracy);
    if error.is_finite() { error.clamp(MAX_TRUNCATION_MODES * TOLERANCE, most) } else { f64::NAN }
}

/// About what it costs to leave out `flexibility` (m/N) of the tip: it is a spring in series with the contact, as stiff as
/// that is at the deepest indentation measured, or else expected.
pub(super) fn gives_way(plan: &Plan, instance: usize, measured: &Measured, flexibility: f64) -> f64 {
    let contact = plan.contact(instance as u32);
    let depth = match measured.indentation_max.is_nan() {
        true => plan.expected_depth(instance as u32),
        false => measured.indentation_max,
    };
    flexibility * contact.stiffness(depth, true).abs()
}

//! Audit: the reference engine redoes a few instances.

use super::chunk::ChunkJournal;
use super::followup::{FollowupKey, FollowupKind, FollowupResult};
use super::journaled_run::JournaledRun;
use super::{RunResult, reference_solution};
use crate::compare::{Ranking, Scales, error, ranked, worst};
use crate::engine::{EngineError, Finished, Progress, Reference, ResultColumns, TOLERANCE};
use crate::observe::{Observable, Status};
use crate::plan::Plan;
use std::ops::ControlFlow;

/// Tolerance of the reference's steps, as a share of the requested accuracy.
const REFERENCE_TOL_SHARE: f64 = 1e-5;
/// Instances for each thread that are integrated together.
const SEARCHES_PER_THREAD: usize = 32;

/// One audited instance.
#[derive(Clone, Debug)]
pub struct AuditedInstance {
    pub instance: u32,
    /// The result of the reference engine.
    pub reference: Finished,
    /// Error of the run in each of the plan's observables, on its scale.
    pub errors: Vec<f64>,
    /// The largest error. None unless both the run and the reference call the instance ok.
    pub worst: Option<f64>,
    /// Error of the reference itself, from truncated modes and from its steps.
    pub truncation: f64,
}

impl AuditedInstance {
    /// Whether the tip touches the sample, according to the reference.
    pub fn touches(&self) -> bool {
        reference_solution::touches(&self.reference)
    }

    /// Whether the error of the run is above `accuracy`.
    pub fn above(&self, accuracy: f64) -> bool {
        self.worst.is_some_and(|error| error > accuracy)
    }

    /// The observable with the largest error, by its place in the plan.
    pub fn worst_place(&self) -> Option<usize> {
        let size = |n: &usize| if self.errors[*n].is_nan() { f64::INFINITY } else { self.errors[*n] };
        (0..self.errors.len()).max_by(|a, b| size(a).total_cmp(&size(b)))
    }
}

/// Redoes up to `count` instances of a finished run that are ok: by turns the most extreme ones and random ones, half of
/// each, so that a stopped audit has some of both. Instances without steps are left out, because their free motion has a
/// closed form. For steady motion the reference finds its own periodic state near the run's (`found` holds the states that
/// the run searched for). That gives the run's error, but not whether time integration would reach the same state. Runs from
/// rest are redone whole.
///
/// `keep` provides instances that an earlier audit redid and receives each new one. A stopped audit returns what it has.
///
/// # Errors
/// Those of the reference engine.
pub fn audit(
    run: &RunResult,
    count: usize,
    keep: &dyn ChunkJournal,
    progress: &Progress,
) -> Result<Vec<AuditedInstance>, EngineError> {
    let chosen = ranked(&run.plan, &auditable(&run.plan, &run.results), count, 1);
    audit_of(run, &chosen, keep, progress)
}

/// The instances that an audit may choose from.
fn auditable(plan: &Plan, results: &ResultColumns) -> Vec<u32> {
    let counts = |i: &u32| plan.steps(*i) > 0 && results.statuses()[*i as usize] == Status::Ok;
    plan.instances().filter(counts).collect()
}

/// The instances that [`audit`] would redo, for a run that is not all in memory.
///
/// # Errors
/// A stored chunk cannot be read.
pub fn audit_selection(run: &JournaledRun, count: usize) -> Result<Vec<u32>, EngineError> {
    let (mut ranking, places) = (Ranking::default(), AuditableInstances::of(run));
    if places.count > count {
        run.each(&mut |piece| {
            let plan = piece.plan();
            for (n, i) in plan.instances().zip(piece.instances).filter(|(_, i)| is_auditable(run, **i)) {
                ranking.offer(*i, &plan, n);
            }
            ControlFlow::Continue(())
        })?;
    }
    Ok(ranking.chosen((places.count, &|place| places.at(run, place)), count, 1))
}

/// Whether an audit may choose an instance.
fn is_auditable(run: &JournaledRun, i: u32) -> bool {
    let mark = run.marks()[i as usize];
    mark.stepped() && mark.status() == Status::Ok
}

/// An index of the instances that an audit may choose from, of very many.
struct AuditableInstances {
    /// Their number before each stretch of instances.
    before: Vec<usize>,
    count: usize,
}

/// Instances in a stretch.
const STRETCH_INSTANCES: usize = 4096;

impl AuditableInstances {
    fn of(run: &JournaledRun) -> Self {
        let (mut before, mut count) = (Vec::new(), 0);
        for i in 0..run.len() {
            if i.is_multiple_of(STRETCH_INSTANCES) {
                before.push(count);
            }
            count += usize::from(is_auditable(run, i as u32));
        }
        Self { before, count }
    }

    /// The instance of this number among them.
    fn at(&self, run: &JournaledRun, place: usize) -> u32 {
        let stretch = self.before.partition_point(|before| *before <= place) - 1;
        let from = (stretch * STRETCH_INSTANCES) as u32;
        let mut all = (from..run.len() as u32).filter(|i| is_auditable(run, *i));
        all.nth(place - self.before[stretch]).unwrap_or(from)
    }
}

/// The auditable instances that touch the sample, as far as observables and plan show it, the cheapest to redo first.
///
/// # Errors
/// A stored chunk cannot be read.
pub fn contacts_by_cost(run: &JournaledRun) -> Result<Vec<u32>, EngineError> {
    let (wants, mut all) = (run.plan.wants, Vec::new());
    run.each(&mut |piece| {
        let plan = piece.plan();
        let [times, depths] = [
            wants.contact.then(|| piece.observed(Observable::ContactTime)),
            wants.extremes.then(|| piece.observed(Observable::IndentationMax)),
        ];
        for (n, i) in plan.instances().zip(piece.instances).filter(|(_, i)| is_auditable(run, **i)) {
            let touches = match (&times, &depths) {
                (Some(times), _) => times[n as usize] > 0.0,
                (None, Some(depths)) => !depths[n as usize].is_nan(),
                (None, None) => plan.expected_depth(n) > 0.0,
            };
            if touches {
                all.push((plan.steps(n), *i));
            }
        }
        ControlFlow::Continue(())
    })?;
    all.sort_unstable();
    Ok(all.into_iter().map(|(_, i)| i).collect())
}

/// Calls [`audit_of`] for a run that is not all in memory.
///
/// # Errors
/// Those of the reference engine, or a stored chunk cannot be read.
pub fn audit_of_run(
    run: &JournaledRun,
    chosen: &[u32],
    keep: &dyn ChunkJournal,
    progress: &Progress,
) -> Result<Vec<AuditedInstance>, EngineError> {
    let few = run.some(chosen)?;
    let all: Vec<u32> = few.plan.instances().collect();
    let mut done = audit_of(&few, &all, keep, progress)?;
    done.iter_mut().for_each(|one| one.instance = chosen[one.instance as usize]);
    done.sort_unstable_by_key(|one| one.instance);
    Ok(done)
}

/// An [`audit`] of these instances.
///
/// # Errors
/// Those of the reference engine.
pub fn audit_of(
    run: &RunResult,
    chosen: &[u32],
    keep: &dyn ChunkJournal,
    progress: &Progress,
) -> Result<Vec<AuditedInstance>, EngineError> {
    let RunResult { plan, results, .. } = run;
    if chosen.is_empty() {
        return Ok(Vec::new());
    }
    progress.stage(&["audit"]);
    let truths = reference_solutions_of(run, chosen, keep, progress)?;
    let one = |(&instance, truth): (&u32, Finished)| {
        let ours = results.get(instance as usize);
        let scales = Scales::of(plan, instance as usize, &truth.measured);
        let of = |observable| error(observable, &ours.measured, &truth.measured, &scales);
        let counts = ours.status == Status::Ok && truth.status == Status::Ok;
        AuditedInstance {
            instance,
            reference: truth,
            errors: plan.observables.iter().map(|observable| of(*observable)).collect(),
            worst: counts.then(|| worst(&plan.observables, &ours.measured, &truth.measured, &scales)),
            truncation: reference_solution::reference_error(plan, instance as usize, &truth.measured),
        }
    };
    // Skip instances that a stopped audit has not redone.
    let done = |(_, truth): &(&u32, Finished)| truth.status != Status::NotRun;
    let mut all: Vec<AuditedInstance> = chosen.iter().zip(truths).filter(done).map(one).collect();
    all.sort_unstable_by_key(|one| one.instance);
    Ok(all)
}

/// The reference engine's results for these instances, from now or from an earlier run.
fn reference_solutions_of(
    run: &RunResult,
    chosen: &[u32],
    keep: &dyn ChunkJournal,
    progress: &Progress,
) -> Result<Vec<Finished>, EngineError> {
    let RunResult { plan, found, .. } = run;
    // Far below visible errors, and several times faster than the reference's own tolerance.
    let tolerance = (REFERENCE_TOL_SHARE * plan.run.accuracy).max(TOLERANCE);
    let reference = Reference { tolerance, ..Reference::default() };
    let known = reference_solution::known_sections(found);
    let question = |i: u32| FollowupKey::new(FollowupKind::Truth, plan, i, known(i).as_ref());
    let asked: Vec<FollowupKey> = chosen.iter().map(|i| question(*i)).collect();
    let recalled: Vec<Option<Finished>> =
        keep.recalled(&asked).into_iter().map(|one| Some(one?.finished)).collect();
    let left = chosen.iter().zip(&recalled).filter(|(_, known)| known.is_none());
    let left: Vec<u32> = left.map(|(i, _)| *i).collect();
    let told = |i: u32, finished: &Finished| {
        let answer = FollowupResult { finished: *finished, orbit: None };
        if keep.answered(&[(question(i), answer)]).is_break() {
            progress.stop();
        }
    };
    let judge = reference_solution::ReferenceSolver { reference: &reference, told: &told };
    // Without searched states, the instances of a piece are integrated to steady state before any of them is redone.
    let waits = keep.lasts() && found.is_empty();
    let size = if waits { SEARCHES_PER_THREAD * rayon::current_num_threads() } else { left.len().max(1) };
    let mut truths = Vec::with_capacity(left.len());
    for piece in left.chunks(size) {
        match progress.stopped() {
            true => truths.extend(piece.iter().map(|_| Finished::NOT_RUN)),
            false => truths.extend(reference_solution::reference_solutions(
                plan, false, piece, &known, &judge, progress,
            )?),
        }
    }
    let mut truths = truths.into_iter();
    Ok(recalled.into_iter().filter_map(|known| known.or_else(|| truths.next())).collect())
}

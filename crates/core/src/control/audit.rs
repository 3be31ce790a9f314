//! A few instances redone by the reference engine.

use super::{Controlled, truth};
use crate::compare::{Scales, error, ranked, worst};
use crate::engine::{Columns, EngineError, Finished, Progress, Reference, TOLERANCE};
use crate::observe::Status;
use crate::plan::Plan;

/// Tolerance of the reference's steps in units of the accuracy asked for.
const FINER: f64 = 1e-5;

/// One audited instance.
#[derive(Clone, Debug)]
pub struct Audited {
    pub instance: u32,
    /// What the reference makes of it.
    pub truth: Finished,
    /// The run's error in each of the plan's observables, on its scale.
    pub errors: Vec<f64>,
    /// The largest of them; none where either the run or the reference does not call the instance ok.
    pub worst: Option<f64>,
    /// What the reference itself may be off by, by the modes that it leaves out and by its steps.
    pub blind: f64,
}

impl Audited {
    /// Whether the tip touches the sample, by the reference.
    pub fn touches(&self) -> bool {
        truth::touches(&self.truth)
    }

    /// Whether the run's error is above `accuracy`.
    pub fn above(&self, accuracy: f64) -> bool {
        self.worst.is_some_and(|error| error > accuracy)
    }

    /// The observable with the largest error, by its place in the plan.
    pub fn worst_place(&self) -> Option<usize> {
        let size = |n: &usize| if self.errors[*n].is_nan() { f64::INFINITY } else { self.errors[*n] };
        (0..self.errors.len()).max_by(|a, b| size(a).total_cmp(&size(b)))
    }
}

/// Redoes up to `count` instances of a finished run that are called ok: half of them the most extreme ones, the
/// others at random, and by turns, so that one that is stopped has done some of both. What needs no steps is left out:
/// its motion is the free one, in closed form. Steady motion is redone as the reference's own periodic state next to the
/// run's (`found` holds
/// the states that the run searched for): that tells its error, and leaves open whether waiting would end in the
/// same state. Runs from rest are redone whole.
///
/// # Errors
/// What the reference engine says.
pub fn audit(run: &Controlled, count: usize, progress: &Progress) -> Result<Vec<Audited>, EngineError> {
    let chosen = ranked(&run.plan, counted(&run.plan, &run.results), count, 1);
    audit_of(run, &chosen, progress)
}

/// The instances that an audit may choose from.
pub fn counted(plan: &Plan, results: &Columns) -> Vec<u32> {
    let counts = |i: &u32| plan.steps(*i) > 0 && results.statuses()[*i as usize] == Status::Ok;
    plan.instances().filter(counts).collect()
}

/// Of those the ones that touch the sample, as far as the run's observables and its plan tell, the cheapest to redo first.
pub fn contacts(Controlled { plan, results, .. }: &Controlled) -> Vec<u32> {
    let touches = |i: &u32| {
        let measured = results.get(*i as usize).measured;
        match () {
            () if plan.wants.contact => measured.contact_time > 0.0,
            () if plan.wants.extremes => !measured.indentation_max.is_nan(),
            () => plan.expected_depth(*i) > 0.0,
        }
    };
    let mut all = counted(plan, results);
    all.retain(touches);
    all.sort_by_key(|i| plan.steps(*i));
    all
}

/// [`audit`] of these instances.
///
/// # Errors
/// What the reference engine says.
pub fn audit_of(run: &Controlled, chosen: &[u32], progress: &Progress) -> Result<Vec<Audited>, EngineError> {
    let Controlled { plan, results, found, .. } = run;
    progress.stage(&["audit"]);
    if chosen.is_empty() {
        return Ok(Vec::new());
    }
    // Far below what is to be seen, and several times faster than the reference's own.
    let tolerance = (FINER * plan.run.accuracy).max(TOLERANCE);
    let reference = Reference { tolerance, ..Reference::default() };
    let truths = truth::truths(plan, false, chosen, &truth::known(found), &reference, progress)?;
    let one = |(&instance, truth): (&u32, Finished)| {
        let ours = results.get(instance as usize);
        let scales = Scales::of(plan, instance as usize, &truth.measured);
        let of = |observable| error(observable, &ours.measured, &truth.measured, &scales);
        let counts = ours.status == Status::Ok && truth.status == Status::Ok;
        Audited {
            instance,
            truth,
            errors: plan.observables.iter().map(|observable| of(*observable)).collect(),
            worst: counts.then(|| worst(&plan.observables, &ours.measured, &truth.measured, &scales)),
            blind: truth::blind(plan, instance as usize, &truth.measured),
        }
    };
    // Stopped on the way: what was not redone says nothing.
    let done = |(_, truth): &(&u32, Finished)| truth.status != Status::NotRun;
    let mut all: Vec<Audited> = chosen.iter().zip(truths).filter(done).map(one).collect();
    all.sort_unstable_by_key(|one| one.instance);
    Ok(all)
}

/// Takes the status ok from the instances that an audit found above the accuracy asked for.
pub fn mark(results: &mut Columns, audited: &[Audited], accuracy: f64) {
    for one in audited.iter().filter(|one| one.above(accuracy)) {
        let place = one.instance as usize;
        if results.statuses()[place] == Status::Ok {
            results.set_status(place, Status::AccuracyNotMet);
        }
    }
}

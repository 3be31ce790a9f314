//! Error control: each instance's error is estimated, and what misses the accuracy asked for is done again
//! with more steps or more modes; a few instances are audited by the reference engine.

mod around;
mod audit;
mod branches;
mod decide;
mod difference;
mod first;
mod levels;
mod modes;
mod neighbours;
mod portions;
mod precision;
mod prescribed;
mod refine;
mod sample;
mod second;
mod sensitive;
mod trial;
mod truth;
mod unfinished;
mod verdict;

pub use audit::{Audited, audit, audit_of, contacts, mark};
pub use branches::{Other, Others, others};
pub use truth::{Way, beside, by_reference, touches};
pub use verdict::{Verdict, basis};

use crate::engine::{Engine, EngineError, Outcome, Progress};
use crate::observe::Status;
use crate::plan::{Plan, Precision};
use crate::scene::Steady;
use crate::steady::{self, PeriodicState, Settled};
use levels::Levels;
use portions::Batch;

/// A run to the accuracy asked for.
#[derive(Clone, Debug)]
pub struct Controlled {
    /// The plan that was carried out: modes and steps as the estimates asked for them.
    pub plan: Plan,
    pub outcome: Outcome,
    /// Of each instance the error of its worst observable, on its scale; NaN where nothing was estimated.
    pub estimates: Vec<f64>,
    /// The part of it that modes left out have.
    pub left_out: Vec<f64>,
    /// Of each instance the periodic state that was found; empty where none was searched for.
    pub found: Vec<Option<Box<PeriodicState>>>,
    /// Of each instance the periods of its last run, those of the search among them.
    pub periods: Vec<u32>,
    /// Of each instance whether its curve's state was not reached continuously from the point before; empty without curves.
    pub jumps: Vec<bool>,
    /// Of each instance whether its search began at its neighbours' states and led to its result; empty where none did.
    pub neighbour_started: Vec<bool>,
    pub arithmetic: Arithmetic,
    /// Of each instance what others begin at; empty where none does.
    solved: Vec<around::Solved>,
}

/// Which arithmetic stepped what, and why.
#[derive(Clone, Debug)]
pub struct Arithmetic {
    /// Of each instance that of its last run.
    pub of: Vec<Precision>,
    /// Largest effect of rounding in the sample that ran in both, on the scale of accuracy; NaN where none did.
    pub rounding: f64,
    pub reason: String,
}

impl Controlled {
    /// The share of the instances whose results began at their neighbours' states.
    pub fn neighbour_started(&self) -> f64 {
        let count = self.neighbour_started.iter().filter(|one| **one).count();
        count as f64 / self.plan.len().max(1) as f64
    }
}

impl Arithmetic {
    /// The plan's for all instances.
    pub fn of(plan: &Plan, reason: &str) -> Self {
        let of = vec![plan.precision; plan.len()];
        Self { of, rounding: f64::NAN, reason: reason.into() }
    }

    /// `f32`, `f64` or `mixed`.
    pub fn name(&self) -> &'static str {
        let first = self.of.first().copied().unwrap_or_default();
        if self.of.iter().any(|one| *one != first) { "mixed" } else { first.name() }
    }
}

/// Runs the plan so that the estimated error of every instance that is called ok is below the accuracy asked
/// for. Of instances for which that cannot be said even with the most steps and the richest basis tried, the status is accuracy_not_met.
///
/// Steps: every instance runs with a quarter and with half of the plan's steps, which are on the safe side, and
/// what the two leave in doubt runs again with twice as many, up to four times. Modes: a sample of the instances
/// runs with poorer and richer bases, and each instance takes the one that serves its neighbours in it; the first of its
/// two runs is with the next poorer one, so that the difference tells of modes as of steps, and what of it the steps
/// do not explain goes on with a richer one. A scene that prescribes its modes has its way, and what they leave out is not looked at; where it
/// prescribes its steps, they are kept, and the estimate comes from another run with half of them. Instances that had to run with more steps run once more from a start
/// moved a little: where that moves the result, it is called sensitive.
///
/// Precision: where the plan leaves it open, the sample runs in f64 and in f32; where that moves it by little, the run
/// is in f32, and what f32 does not bring to the accuracy goes on in f64. Where f32 is prescribed, a sample tells what
/// rounding costs, and the estimates count it.
///
/// Stopped on the way, it gives what is done: every instance that it would have gone on with is called not_run.
///
/// # Errors
/// What the engine says.
pub fn run(planned: &Plan, engine: &dyn Engine, progress: &Progress) -> Result<Controlled, EngineError> {
    let stepped = planned.stepped();
    if stepped.is_empty() {
        let (count, mut plan) = (planned.len(), planned.clone());
        // What feels no sample is as it is, but holds no set-point.
        let outcome = match plan.has_setpoints() {
            true => steady::begin(&mut plan, engine, progress)?.outcome,
            false => engine.run(&plan, progress)?,
        };
        let arithmetic = Arithmetic::of(&plan, "nothing was stepped");
        return Ok(Controlled {
            plan,
            outcome,
            estimates: vec![0.0; count],
            left_out: vec![0.0; count],
            found: Vec::new(),
            periods: vec![0; count],
            jumps: Vec::new(),
            neighbour_started: Vec::new(),
            arithmetic,
            solved: Vec::new(),
        });
    }
    progress.stage(&["trial"]);
    let modes::Choice { mut plan, poorer, left_out, mut notes } =
        modes::choose(planned, &stepped, engine, progress)?;
    let levels = Levels::of(planned);
    let mut chosen = match levels.is_some() && engine.double() && plan.precision_open {
        true => precision::for_neighbours(&plan),
        false => precision::choose(&plan, &stepped, engine, progress)?,
    };
    notes.append(&mut chosen.notes);
    (plan.precision, plan.precision_open) = (chosen.precision, false);
    if progress.stopped() {
        // In the trials, which no instance's result comes from.
        return Ok(Controlled::not_begun(plan, &chosen));
    }
    let first = first::First::alone(poorer, left_out, &chosen);
    progress.stage(&["estimate", "run", "refinement"]);
    let mut all = match (&levels, plan.len() > engine.portions().0) {
        (None, false) => unfinished::marked(plan, &stepped, first, engine, progress)?,
        _ => portions::run(plan, &batches(planned, levels.as_ref()), first, engine, progress)?,
    };
    all.outcome.notes.splice(0..0, notes);
    if chosen.precision == Precision::F32 && !chosen.mixed && !progress.stopped() {
        precision::add_rounding(&mut all, &stepped, engine, progress)?;
    }
    for &i in &stepped {
        let i = i as usize;
        let doubtful = all.estimates[i] > all.plan.run.accuracy;
        if doubtful && all.outcome.results[i].status == Status::Ok {
            all.outcome.results[i].status = Status::AccuracyNotMet;
        }
    }
    Ok(all)
}

/// The order in which a plan's instances are taken to their ends: within a batch that in which the plan runs them. Curves
/// stay whole.
fn batches<'a>(planned: &Plan, levels: Option<&'a Levels<'a>>) -> Vec<Batch<'a>> {
    let Some(levels) = levels else {
        let instances = match planned.ensemble.curves {
            Some(_) => planned.instances().collect(),
            None => planned.by_class(),
        };
        return vec![Batch { instances, level: None, leads_on: false }];
    };
    let alike = |points: &[u32]| -> Vec<u32> {
        planned.part(points).by_class().into_iter().map(|place| points[place as usize]).collect()
    };
    let scouts = Batch { instances: alike(&levels.scouts), level: None, leads_on: true };
    let later = levels.later.iter().enumerate().map(|(n, level)| Batch {
        instances: alike(&level.points),
        level: Some(level),
        leads_on: levels.leads_on(n),
    });
    std::iter::once(scouts).chain(later).collect()
}

/// Runs the plan once as it is: nothing is estimated, in the arithmetic that was chosen for this `reason`.
///
/// # Errors
/// What the engine says.
pub fn once(
    mut plan: Plan,
    reason: &str,
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<Controlled, EngineError> {
    progress.stage(&["run"]);
    let Settled { mut outcome, found, periods, jumps } = steady::begin(&mut plan, engine, progress)?;
    if progress.stopped() && plan.run.steady == Steady::Search {
        // What no search settles is waited for, and was not.
        let waits = outcome.results.iter_mut().filter(|one| one.status == Status::NotSteady);
        waits.for_each(|one| one.status = Status::NotRun);
    }
    let unknown = vec![f64::NAN; plan.len()];
    let (left_out, arithmetic) = (unknown.clone(), Arithmetic::of(&plan, reason));
    Ok(Controlled {
        plan,
        outcome,
        estimates: unknown,
        left_out,
        found,
        periods,
        jumps,
        neighbour_started: Vec::new(),
        arithmetic,
        solved: Vec::new(),
    })
}

//! Error control: each instance's error is estimated, and what misses the accuracy asked for is done again
//! with more steps or more modes; a few instances are audited by the reference engine.

mod audit;
mod basis_choice;
mod basis_rules;
mod basis_trials;
mod block_solver;
mod branch_switching;
mod choices;
mod chunk;
mod chunk_run;
mod chunk_scheduler;
mod chunk_view;
mod chunking;
mod codec;
mod compact_orbit;
mod contact_sample;
mod decision;
mod difference_scale;
mod error_summary;
mod first_estimate;
mod fixed_steps;
mod followup;
mod grid_adjacency;
mod grid_hierarchy;
mod hierarchy;
mod instance_flags;
mod instance_record;
mod interruption;
mod journaled_run;
mod kd_tree;
mod memory_journal;
mod orbit_pair;
mod precision_trial;
mod rbf;
mod reference_solution;
mod refinement;
mod scattered_hierarchy;
mod search_checkpoints;
mod second_orbit;
mod second_orbit_table;
mod second_refinement;
mod sensitivity;
mod stencils;
mod step_reduction;

pub use audit::{AuditedInstance, audit, audit_of, audit_of_run, audit_selection, contacts_by_cost};
pub use branch_switching::second_orbits;
pub use choices::{Choices, Course, choose};
pub use chunk::{Chunk, ChunkJournal};
pub use chunk_run::ChunkRun;
pub use chunk_view::ChunkView;
pub use chunking::Chunking;
pub use codec::{
    answers_from_bytes, answers_to_bytes, budget_from_bytes, budget_to_bytes, keys, numbers_from_bytes,
    numbers_key, numbers_to_bytes, portion_number, portion_to_bytes,
};
pub use compact_orbit::CompactOrbit;
pub use error_summary::{ErrorSummary, basis};
pub use followup::{AuditBudget, FollowupKey, FollowupKind, FollowupResult};
use instance_flags::InstanceFacts;
pub use instance_flags::InstanceFlags;
pub use instance_record::{ChunkMeta, InstanceRecord};
pub use journaled_run::JournaledRun;
pub use memory_journal::MemoryJournal;
pub use reference_solution::{ReferenceStart, beside, by_reference, touches};
pub use second_orbit::{SecondOrbit, SecondOrbits};

use crate::engine::{Engine, EngineError, Progress, ResultColumns};
use crate::observe::Status;
use crate::orbit::{self, OrbitSolution, OrbitTable};
use crate::plan::{Plan, Precision};
use crate::scene::Steady;

/// A run of all instances to the accuracy asked for, or of some of them, in memory.
#[derive(Clone, Debug)]
pub struct RunResult {
    /// The plan that was carried out: modes and steps as the estimates asked for them.
    pub plan: Plan,
    /// Of the numbers that are measured in any case only those that observables asked for are made of, amplitude, phase,
    /// forces and contact.
    pub results: ResultColumns,
    /// What a user should know of how it went: one line each.
    pub notes: Vec<String>,
    /// Of each instance the error of its worst observable, on its scale; NaN where nothing was estimated.
    pub estimates: Vec<f64>,
    /// The part of it that modes left out have.
    pub truncation: Vec<f64>,
    /// Of each instance the periodic state that was found; empty where none was searched for.
    pub found: OrbitTable,
    /// Of each instance the periods of its last run, those of the search among them.
    pub periods: Vec<u32>,
    /// Of each instance whether its curve's state was not reached continuously from the point before; empty without curves.
    pub jumps: Vec<bool>,
    /// Of each instance whether its search began at its neighbours' states and led to its result; empty where none did.
    pub neighbour_started: Vec<bool>,
    pub arithmetic: Arithmetic,
    /// What the searches from the lever at rest found; empty where they were not done.
    from_rest: second_orbit_table::SecondOrbitTable,
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

impl RunResult {
    /// Before anything.
    fn not_begun(plan: Plan, choices: &Choices) -> Self {
        let count = plan.len();
        Self {
            results: ResultColumns::of_observables(count, &plan.observables),
            notes: Vec::new(),
            estimates: vec![f64::NAN; count],
            truncation: vec![f64::NAN; count],
            found: OrbitTable::default(),
            periods: vec![0; count],
            jumps: Vec::new(),
            neighbour_started: Vec::new(),
            arithmetic: choices.precision.arithmetic(count),
            from_rest: second_orbit_table::SecondOrbitTable::default(),
            plan,
        }
    }

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
/// two runs is with the next smaller one, so that the difference tells of modes as of steps, and what of it the steps
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
pub fn run(planned: &Plan, engine: &dyn Engine, progress: &Progress) -> Result<RunResult, EngineError> {
    let keep = MemoryJournal::default();
    match choose(planned, Course::Controlled, engine, progress)? {
        Some(choices) => run_chunks(planned.clone(), &choices, &keep, engine, progress)?.gathered(),
        None => Ok(RunResult::not_begun(planned.clone(), &Choices::stopped(planned, engine))),
    }
}

/// Carries out what was chosen for the scene's plan: what [`run`] does once it has chosen. `keep` knows chunks that an
/// earlier run has ended, and is told of each that this one ends.
///
/// # Errors
/// What the engine says.
pub fn run_chunks<'k>(
    planned: Plan,
    choices: &Choices,
    keep: &'k dyn ChunkJournal,
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<JournaledRun<'k>, EngineError> {
    let is_stepped = planned.instances().any(|i| planned.steps(i) > 0);
    let mut all = chunk_scheduler::run(planned, choices, keep, engine, progress)?;
    all.notes.splice(0..0, choices.notes.iter().cloned());
    let chosen = &choices.precision;
    let single = chosen.precision == Precision::F32 && !chosen.mixed;
    if choices.course == Course::Controlled && single && is_stepped && !keep.partly() && !progress.stopped() {
        let whole = all.gathered()?;
        let cost = precision_trial::cost_of_rounding(&whole, engine, progress)?;
        all.notes.extend(cost.notes);
        if let Some((rounding, added)) = cost.told {
            (all.rounding, all.added) = (rounding, added);
            let over = |i: &u32| {
                let i = *i as usize;
                whole.plan.steps(i as u32) > 0 && whole.estimates[i] + all.added[i] > whole.plan.run.accuracy
            };
            let missed: Vec<u32> = whole.plan.instances().filter(over).collect();
            missed.into_iter().for_each(|i| all.miss(i));
        }
    }
    Ok(all)
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
) -> Result<ChunkRun, EngineError> {
    progress.stage(&["run"]);
    let OrbitSolution { mut outcome, found, periods, jumps } =
        orbit::solve_first(&mut plan, engine, progress)?;
    if progress.stopped() && plan.run.steady == Steady::Search {
        // What no search settles is integrated to steady state, and was not.
        let waits = outcome.results.iter_mut().filter(|one| one.status == Status::NotSteady);
        waits.for_each(|one| one.status = Status::NotRun);
    }
    let unknown = vec![f64::NAN; plan.len()];
    let (left_out, arithmetic) = (unknown.clone(), Arithmetic::of(&plan, reason));
    Ok(ChunkRun {
        plan,
        outcome,
        estimates: unknown,
        truncation: left_out,
        found,
        periods,
        jumps,
        neighbour_started: Vec::new(),
        arithmetic,
        solved: Vec::new(),
        from_rest: Vec::new(),
    })
}

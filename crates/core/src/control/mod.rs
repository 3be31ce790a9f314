//! Error control. The run estimates each instance's error and repeats the instances that miss the requested accuracy with
//! more steps or more modes. The reference engine audits a few instances.

mod audit;
mod basis_choice;
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
mod energy_balance;
mod error_parts;
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
mod missed_compliance;
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
pub use error_summary::{ErrorSummary, estimate_comment};
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
use crate::orbit::{self, OrbitTable};
use crate::plan::{Plan, Precision};
use crate::scene::Steady;

/// A run of all or some instances to the requested accuracy, in memory.
#[derive(Clone, Debug)]
pub struct RunResult {
    /// The plan as it ran: with the modes and steps that the estimates led to.
    pub plan: Plan,
    /// Quantities that every run measures are kept only if a requested observable needs them. Amplitude, phase, forces and
    /// contact are always kept.
    pub results: ResultColumns,
    /// Messages for the user, one line each.
    pub notes: Vec<String>,
    /// Error of each instance's worst observable, on that observable's scale. NaN if nothing was estimated.
    pub estimates: Vec<f64>,
    /// The part of the estimate that comes from truncated modes.
    pub truncation: Vec<f64>,
    /// Periodic state found for each instance. Empty if no states were searched for.
    pub found: OrbitTable,
    /// Periods of each instance's last run, those of its search included.
    pub periods: Vec<u32>,
    /// For each instance, whether its curve jumped to this state from the point before. Empty without curves.
    pub jumps: Vec<bool>,
    /// For each instance, whether its result comes from a search started at its neighbours' states. Empty if none did.
    pub neighbour_started: Vec<bool>,
    pub arithmetic: Arithmetic,
    /// Results of the searches from the lever at rest. Empty if there were no such searches.
    from_rest: second_orbit_table::SecondOrbitTable,
}

/// The arithmetic of each instance, and the reason for it.
#[derive(Clone, Debug)]
pub struct Arithmetic {
    /// Arithmetic of each instance's last run.
    pub of: Vec<Precision>,
    /// Largest effect of rounding in the sample that ran in both, on the scale of accuracy. NaN without a sample.
    pub rounding: f64,
    pub reason: String,
}

impl RunResult {
    /// The share of the instances whose results come from searches started at their neighbours' states.
    pub fn neighbour_started(&self) -> f64 {
        let count = self.neighbour_started.iter().filter(|one| **one).count();
        count as f64 / self.plan.len().max(1) as f64
    }
}

impl Arithmetic {
    /// Gives all instances the plan's arithmetic.
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

/// Runs the plan until every instance with status ok has an estimated error below the requested accuracy. An instance that
/// misses it even with the most steps and the richest basis gets the status accuracy_not_met.
///
/// Steps: the plan's number of steps is on the safe side. Every instance runs with a quarter and with half of it, and while
/// in doubt again with twice the steps, up to four times. Prescribed steps are kept; a run with half of them gives the
/// estimate. An integrated instance that was refined runs again from a shifted start. It is sensitive if its result moves.
///
/// Modes: a sample runs with smaller and richer bases, and each instance takes the basis that serves its neighbours in the
/// sample. Its first run has the next smaller basis, so the difference contains the truncation error. If steps do not explain
/// it, a richer basis follows. Prescribed modes are kept without an estimate of their truncation error.
///
/// Precision: if the plan leaves it open, the sample runs in f64 and in f32. If they agree, the run uses f32, and instances
/// that miss the accuracy continue in f64. If f32 is prescribed, the estimates include the rounding error of a sample.
///
/// A stopped run returns what it has. Every instance that it would have continued has the status not_run.
///
/// # Errors
/// Those of the engine.
pub fn run(planned: &Plan, engine: &dyn Engine, progress: &Progress) -> Result<RunResult, EngineError> {
    let keep = MemoryJournal::default();
    let chosen = choose(planned, Course::Controlled, engine, progress)?;
    let choices = chosen.unwrap_or_else(|| Choices::stopped(planned, engine));
    run_chunks(planned.clone(), &choices, &keep, engine, progress)?.gathered()
}

/// Runs the plan with the given choices; [`run`] calls this once it has chosen. `keep` provides the chunks that an earlier
/// run finished and receives each chunk that this run finishes.
///
/// # Errors
/// Those of the engine.
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

/// Runs the plan once without error estimates. `reason` says why it runs in the plan's arithmetic.
///
/// # Errors
/// Those of the engine.
pub fn once(
    plan: Plan,
    reason: &str,
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<ChunkRun, EngineError> {
    progress.stage(&["run"]);
    let mut plan = plan.resonant();
    let mut settled = orbit::solve_first(&mut plan, engine, progress)?;
    if progress.stopped() && plan.run.steady == Steady::Search {
        // Time integration would have settled the instances that no search found; it did not run.
        let waits = settled.outcome.results.iter_mut().filter(|one| one.status == Status::NotSteady);
        waits.for_each(|one| one.status = Status::NotRun);
    }
    let arithmetic = Arithmetic::of(&plan, reason);
    Ok(ChunkRun::unestimated(plan, settled, arithmetic))
}

//! The periodic state of each instance, by integration to steady state or by a search that a run confirms.

mod continuation;
mod drift;
mod envelope_solver;
mod free_jacobian;
mod harmonic_balance;
mod initial_guess;
mod instance_search;
mod jacobian;
mod midpoint_restart;
mod neighbour_start;
mod orbit_table;
mod orbit_transfer;
mod period_map;
mod predictor;
mod quasi_newton;
mod residual;
mod restart;
mod search_batch;
mod setpoint_branch;
mod setpoint_continuation;
mod setpoint_residual;
mod setpoint_solver;
mod settling;
mod size_dispatch;
mod stencil;
mod time_integration;
mod tolerances;
mod transfer_cache;
mod verification;

pub use continuation::{jumps_moved, locate_jumps};
pub use jacobian::Jacobian;
pub use neighbour_start::{OnFailure, solve_from_neighbours};
pub use orbit_table::OrbitTable;
pub use orbit_transfer::{transfer_orbit, transfer_orbit_corrected};
pub use setpoint_solver::{NO_SETPOINT, hold_setpoint};
pub use stencil::{SolvedNeighbour, Stencil, StencilPoint, StencilStart};
pub use time_integration::SETTLED_SHARE;

use crate::engine::{Engine, EngineError, Finished, Outcome, Progress, in_double};
use crate::observe::Status;
use crate::periodic::Floquet;
use crate::plan::{Plan, ReducedBasis, SectionState};
use crate::scene::{Start, Steady};
use initial_guess::InitialGuess;
use std::sync::Arc;
use verification::{run_on, search_and_verify};

/// A periodic state that was found.
#[derive(Clone, Debug, PartialEq)]
pub struct PeriodicState {
    pub section: SectionState,
    /// Effect of the period map on small deviations.
    pub floquet: Floquet,
    /// Steps per period and basis of the search.
    pub steps: u32,
    pub basis: Arc<ReducedBasis>,
    /// The period map's Jacobian near the state; unknown if no search is to start here.
    pub jacobian: Jacobian,
    /// The slope of its set-point's residual over the gap, 1/m, where it is known.
    pub gap_slope: Option<f64>,
}

impl PeriodicState {
    /// The free oscillation, with an unknown Jacobian.
    fn unknown(steps: u32, kept: &Arc<ReducedBasis>) -> Self {
        let spectrum = Floquet { multiplier: f64::NAN, sigma_min: f64::NAN };
        Self {
            section: SectionState::FREE,
            floquet: spectrum,
            steps,
            basis: Arc::clone(kept),
            jacobian: Jacobian::Unknown,
            gap_slope: None,
        }
    }

    /// Whether a search found it; otherwise integration did.
    pub fn is_solved(&self) -> bool {
        !self.floquet.multiplier.is_nan()
    }
}

/// The result of a plan.
#[derive(Clone, Debug)]
pub struct OrbitSolution {
    pub outcome: Outcome,
    /// By instance; empty if nothing was searched for. Integration yields states only at points of curves and of
    /// set-points.
    pub found: Vec<Option<Box<PeriodicState>>>,
    /// By instance: periods stepped by searches, confirmation and integration.
    pub periods: Vec<u32>,
    /// By instance: whether its curve did not reach its state continuously from the point before. Empty without curves.
    pub jumps: Vec<bool>,
}

impl OrbitSolution {
    /// The plan's instances before any run.
    pub fn not_run(plan: &Plan) -> Self {
        let outcome = Outcome { ends: Vec::new(), ..Outcome::of(plan) };
        Self { found: vec![None; plan.len()], ..Self::without_states(outcome) }
    }

    /// Results that no search found.
    pub fn without_states(outcome: Outcome) -> Self {
        let periods = vec![0; outcome.results.len()];
        Self { outcome, found: Vec::new(), periods, jumps: Vec::new() }
    }

    /// The state found of an instance.
    pub fn state(&self, instance: usize) -> Option<&PeriodicState> {
        self.found.get(instance).and_then(Option::as_deref)
    }
}

/// Runs the plan as its scene says: integrates to steady state, or searches for periodic states. `near` holds states of the
/// same instances with other steps or levers, or is empty.
///
/// A state counts as found only if it is stable and a run from it stays within the requested accuracy (in f64, where f32 is
/// too coarse to tell). Every other instance is integrated to steady state.
///
/// # Errors
/// Returns the engine's error.
pub fn solve(
    plan: &Plan,
    near: &[Option<&PeriodicState>],
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<OrbitSolution, EngineError> {
    solve_or(plan, near, OnFailure::SettleThenIntegrate, engine, progress)
}

/// Like [`solve`], without integration after searches: instances that no search finds stay as not run.
///
/// # Errors
/// Returns the engine's error.
pub fn solve_without_integration(
    plan: &Plan,
    near: &[Option<&PeriodicState>],
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<OrbitSolution, EngineError> {
    solve_or(plan, near, OnFailure::LeaveUnsolved, engine, progress)
}

fn solve_or(
    plan: &Plan,
    near: &[Option<&PeriodicState>],
    on_failure: OnFailure,
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<OrbitSolution, EngineError> {
    progress.part();
    if plan.run.steady == Steady::Wait || plan.stepped().is_empty() {
        return time_integration::integrate(plan, engine, progress);
    }
    // A state that a curve or an approach has reached is searched for near itself only.
    let told = plan.ensemble.curves.is_some() || plan.has_setpoints();
    let followed = told && near.iter().any(Option::is_some);
    let begin = if followed { InitialGuess::CurveStates(near) } else { InitialGuess::States(near) };
    search_or_integrate(plan, begin, (&[], on_failure), engine, progress)
}

/// Like [`solve`], but each search, and the integration after it, starts at the given state, even if its Jacobian is unknown.
///
/// # Errors
/// Returns the engine's error.
pub fn solve_near_states(
    plan: &Plan,
    states: &[Option<&PeriodicState>],
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<OrbitSolution, EngineError> {
    if plan.run.steady == Steady::Wait || states.is_empty() {
        return solve(plan, states, engine, progress);
    }
    progress.part();
    search_or_integrate(
        plan,
        InitialGuess::CurveStates(states),
        (&[], OnFailure::SettleThenIntegrate),
        engine,
        progress,
    )
}

/// Searches from `begin`, then from each neighbour in `leads` alone. Instances not found are integrated to steady state or
/// stay as not run, as `on_failure` says.
fn search_or_integrate(
    plan: &Plan,
    begin: InitialGuess,
    (leads, on_failure): (&[StencilStart], OnFailure),
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<OrbitSolution, EngineError> {
    let (mut settled, mut left) = search_and_verify(plan, &plan.stepped(), begin, engine, progress)?;
    settled.vote_of_neighbours(plan, leads, (|_| true, 1), engine, progress)?;
    left.retain(|one| settled.found[one.instance as usize].is_none());
    if matches!(begin, InitialGuess::StatesOnce(_)) {
        if on_failure == OnFailure::RetryLater {
            settled.retry_later(plan, left, engine, progress)?;
        }
        return Ok(settled);
    }
    let waits = on_failure == OnFailure::SettleThenIntegrate;
    let left = match begin {
        InitialGuess::States(_) | InitialGuess::StatesOrDefer(_)
            if waits && plan.run.start == Start::Steady =>
        {
            settling::settle_and_search(plan, left, &mut settled, engine, progress)?
        }
        _ => Vec::new(),
    };
    for wait in settling::integrations(plan, begin, left, waits, &settled) {
        settled.integrate(plan, wait, engine, progress)?;
    }
    Ok(settled)
}

/// The first run of a plan: to its set-points, along its curves if it searches, or each instance by itself. Later runs of the
/// same instances start from these states. The plan's gaps become those that hold the set-points, NaN where none does.
///
/// # Errors
/// Returns the engine's error.
pub fn solve_first(
    plan: &mut Plan,
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<OrbitSolution, EngineError> {
    if plan.has_setpoints() {
        progress.part();
        return setpoint_solver::solve_first(plan, engine, progress);
    }
    if plan.ensemble.curves.is_none() || plan.run.steady == Steady::Wait {
        return solve(plan, &[], engine, progress);
    }
    progress.part();
    let double = in_double(engine);
    let followed = continuation::continue_curves(plan, double, progress)?;
    let near: Vec<Option<&PeriodicState>> = followed.states.iter().map(Option::as_ref).collect();
    let mut settled = match progress.stopped() {
        true => measure_curve_states(plan, &near, engine)?,
        false => solve(plan, &near, engine, progress)?,
    };
    settled.periods.iter_mut().zip(&followed.periods).for_each(|(all, some)| *all += some);
    settled.outcome.notes.splice(0..0, followed.notes);
    settled.jumps = followed.jumps;
    Ok(settled)
}

/// Measures the points that interrupted curves have reached. Their results stay marked as not run.
fn measure_curve_states(
    plan: &Plan,
    near: &[Option<&PeriodicState>],
    engine: &dyn Engine,
) -> Result<OrbitSolution, EngineError> {
    let mut settled = OrbitSolution::not_run(plan);
    let reached: Vec<u32> = plan.instances().filter(|i| near[*i as usize].is_some()).collect();
    let states: Vec<Option<&PeriodicState>> = reached.iter().map(|i| near[*i as usize]).collect();
    // These few periods run to the end although the run is stopped.
    let on = run_on(plan.part(&reached), &states, engine, &Progress::default())?;
    for (i, finished) in reached.into_iter().zip(on.results) {
        settled.outcome.results[i as usize] = Finished { status: Status::NotRun, ..finished };
    }
    Ok(settled)
}

/// Runs the plan's instances again, with other steps or bases. Like [`solve`], and holds set-points again, from the plan's
/// gaps and the states `near`.
///
/// # Errors
/// Returns the engine's error.
pub fn solve_again(
    plan: &mut Plan,
    near: &[Option<&PeriodicState>],
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<OrbitSolution, EngineError> {
    let searches = plan.run.steady == Steady::Search && plan.ensemble.curves.is_none();
    match plan.has_setpoints() {
        true => setpoint_solver::hold_again(plan, near, engine, progress),
        false if searches && !near.is_empty() => restart::solve_from_own_states(plan, near, engine, progress),
        false => solve(plan, near, engine, progress),
    }
}

/// Searches these instances from the lever at rest instead of its free oscillation; all others stay as not run. Of two
/// branches of a tapping point it tends to find the one with the smaller amplitude.
///
/// # Errors
/// Returns the engine's error.
pub fn solve_from_rest(
    plan: &Plan,
    instances: &[u32],
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<OrbitSolution, EngineError> {
    progress.part();
    Ok(search_and_verify(plan, instances, InitialGuess::AtRest, engine, progress)?.0)
}

/// Searches from these section states, one for each instance of the plan, instead of the free oscillation.
///
/// # Errors
/// Returns the engine's error.
pub fn solve_from_sections(
    plan: &Plan,
    places: &[SectionState],
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<OrbitSolution, EngineError> {
    let all: Vec<u32> = plan.instances().collect();
    Ok(search_and_verify(plan, &all, InitialGuess::Points(places), engine, progress)?.0)
}

/// Searches near the states `others`, one for each instance of the plan, transferred to the plan's steps and lever, and
/// nowhere else.
///
/// # Errors
/// Returns the engine's error.
pub fn solve_near(
    plan: &Plan,
    others: &[&PeriodicState],
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<OrbitSolution, EngineError> {
    let all: Vec<u32> = plan.instances().collect();
    let places: Vec<SectionState> =
        all.iter().zip(others).map(|(i, other)| period_map::transfer_section(plan, *i, other)).collect();
    Ok(search_and_verify(plan, &all, InitialGuess::PointsOnly(&places), engine, progress)?.0)
}

/// The states of these instances, in the order of a plan of them; empty if nothing was searched for.
pub fn gather<'a>(
    found: &'a [Option<Box<PeriodicState>>],
    instances: &[u32],
) -> Vec<Option<&'a PeriodicState>> {
    match found.is_empty() {
        true => Vec::new(),
        false => instances.iter().map(|i| found[*i as usize].as_deref()).collect(),
    }
}

/// The reverse: places the states of a plan of `instances` in a plan of `count` instances that contains them.
pub fn scatter<'a>(
    found: &'a [Option<Box<PeriodicState>>],
    instances: &[u32],
    count: usize,
) -> Vec<Option<&'a PeriodicState>> {
    let mut all = vec![None; if found.is_empty() { 0 } else { count }];
    instances.iter().zip(found).for_each(|(i, state)| all[*i as usize] = state.as_deref());
    all
}

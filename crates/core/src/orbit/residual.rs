//! One measured period from a periodic state: its result, and what its own change says of the state.

use super::PeriodicState;
use super::period_map::distance;
use crate::engine::{Engine, EngineError, Outcome, Progress};
use crate::observe::Measured;
use crate::plan::{Plan, Precision, SectionState, StartState};

/// Share of the accuracy within which the state has to be for the period to be its result, by the bound that its change
/// gives. Forces magnify a state's error by about twenty, and the bound is some fifteen times the distance.
pub(super) const RESIDUAL_TOL: f64 = 0.03;
/// The same where the period is in f32: its rounding is in the change, and the state is not the worse for it.
const RESIDUAL_TOL_F32: f64 = 0.3;

/// One measured period of each of the plan's instances from these places; where they end is told too. Whether they are
/// steady is not judged: of one period nothing could be said but by its change.
pub(super) fn measure_period(
    plan: Plan,
    places: impl Iterator<Item = SectionState>,
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<Outcome, EngineError> {
    // Of no change, however large, anything is left.
    let start = |station| StartState { section: station, least_change: Some(f64::INFINITY) };
    let mut one = plan.starting_at(places.map(start).collect());
    (one.run.periods, one.run.measure) = (1, 1);
    progress.foresee(one.instance_steps());
    engine.run(&one, progress)
}

/// How much the largest force changes, as a share of itself, where the tip stands aside by this distance (m); 0 where it does not
/// touch.
pub(super) fn force_share(plan: &Plan, instance: u32, one: &Measured, distance: f64) -> f64 {
    let force = one.force_max.abs().max(one.force_min.abs());
    let change = plan.contact(instance).stiffness(one.indentation_max, true).abs() * distance;
    if change > 0.0 { change / force } else { 0.0 }
}

/// Whether a period that leads from a state to this end bears it out: by the bound on the distance from the periodic
/// state, and in the same contact.
pub(super) fn residual_confirms(
    plan: &Plan,
    instance: u32,
    state: &PeriodicState,
    end: Option<&SectionState>,
) -> bool {
    let Some(end) = end.filter(|end| end.finite) else { return false };
    let same_contact = !plan.law(instance).has_memory() || end.touching == state.section.touching;
    let change = distance(end, &state.section) / state.floquet.sigma_min;
    let share = if plan.precision == Precision::F32 { RESIDUAL_TOL_F32 } else { RESIDUAL_TOL };
    same_contact && change <= share * plan.run.accuracy * plan.driven(instance).free_amplitude().max(1e-15)
}

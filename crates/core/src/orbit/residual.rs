//! One measured period from a periodic state: its result, and what its residual says of the state.

use super::PeriodicState;
use super::period_map::distance;
use crate::engine::{Engine, EngineError, Outcome, Progress};
use crate::observe::Measured;
use crate::plan::{Plan, Precision, SectionState, StartState};

/// Largest error bound of a state whose single period counts as its result, as a share of the accuracy; the bound follows from
/// the residual. Forces magnify a state's error by about twenty, and the bound is some fifteen times the distance.
pub(super) const RESIDUAL_TOL: f64 = 0.03;
/// The same for a period in f32, whose residual includes rounding that the state itself does not have.
const RESIDUAL_TOL_F32: f64 = 0.3;

/// Measures one period of each of the plan's instances from these section states, and returns their ends, too. It does not
/// judge steadiness: one period alone tells only its residual.
pub(super) fn measure_period(
    plan: Plan,
    places: impl Iterator<Item = SectionState>,
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<Outcome, EngineError> {
    // With an infinite `least_change` no change counts against the state.
    let start = |station| StartState { section: station, least_change: Some(f64::INFINITY) };
    let mut one = plan.starting_at(places.map(start).collect());
    (one.run.periods, one.run.measure) = (1, 1);
    progress.foresee(one.instance_steps());
    engine.run(&one, progress)
}

/// Relative change of the largest force if the tip moves by `distance` (m); 0 without contact.
pub(super) fn force_share(plan: &Plan, instance: u32, one: &Measured, distance: f64) -> f64 {
    let force = one.force_max.abs().max(one.force_min.abs());
    let change = plan.contact(instance).stiffness(one.indentation_max, true).abs() * distance;
    if change > 0.0 { change / force } else { 0.0 }
}

/// Whether a period from `state` to `end` confirms it: the error bound is small enough and the contact is the same.
pub(super) fn residual_confirms(
    plan: &Plan,
    instance: u32,
    state: &PeriodicState,
    end: Option<&SectionState>,
) -> bool {
    let Some(end) = end.filter(|end| end.finite) else { return false };
    let same_contact = !plan.law(instance).has_hysteresis() || end.touching == state.section.touching;
    let change = distance(end, &state.section) / state.floquet.sigma_min;
    let share = if plan.precision == Precision::F32 { RESIDUAL_TOL_F32 } else { RESIDUAL_TOL };
    same_contact && change <= share * plan.run.accuracy * plan.driven(instance).free_amplitude().max(1e-15)
}

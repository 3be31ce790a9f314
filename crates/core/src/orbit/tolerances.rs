//! Tolerances of searches, and bounds for stability.

use crate::kernel::Attraction;
use crate::periodic::NewtonOptions;
use crate::plan::{KeptMode, Plan};
use std::f64::consts::TAU;

/// Evaluations after which a search gives up.
const MAX_NEWTON_EVALUATIONS: u32 = 300;
/// Newton's tolerance on the distance to the periodic state, and the tolerance that suffices where the map is rough, as shares
/// of the requested accuracy.
const NEWTON_TOL_SHARE: f64 = 1e-3;
const FALLBACK_TOL_SHARE: f64 = 0.1;
/// Finite-difference steps for the map's Jacobian, on the way and at the end, in free amplitudes. Jumps of the contact make
/// the map rough.
const FD_STEPS_SMOOTH: (f64, Option<f64>) = (1e-6, None);
const FD_STEPS_ROUGH: (f64, Option<f64>) = (3e-5, Some(3e-4));

/// Tolerance of a search in f32, the one that suffices there where the map is rough, and the approximate rounding of a number
/// in one period of f32.
pub(super) const NEWTON_TOL_F32: f64 = 1e-3;
pub(super) const FALLBACK_TOL_F32: f64 = 1e-2;
const PERIOD_ROUNDING_F32: f64 = 5e-7;

/// The share in [`stable_below`], and the limits on the bounds of it and of [`stable_below_fd`].
const STABILITY_DOUBT_SHARE: f64 = 0.35;
const STABLE_BELOW_RANGE: (f64, f64) = (0.99, 0.999);

/// See [`jacobian_columns`]: for a law that acts in some steps of a period, and for one that acts in all.
const JACOBIAN_COST_COLUMNS: (usize, usize) = (3, 12);

/// See [`jacobian_drop_tol`].
const JACOBIAN_DROP_SHARE: f64 = 0.02;

/// The bound for multipliers by one-sided differences, which are good to a thousandth.
fn stable_below_fd(plan: &Plan, instance: u32) -> f64 {
    stable_below(plan, instance).min(STABLE_BELOW_RANGE.1)
}

/// Stable without doubt is a multiplier below this: 1 - multiplier is at least 35 % of the free lever's.
pub(super) fn stable_below(plan: &Plan, instance: u32) -> f64 {
    (1.0 - STABILITY_DOUBT_SHARE * (1.0 - free_multiplier(plan, instance))).max(STABLE_BELOW_RANGE.0)
}

/// Length unit of a state, positive even without amplitude, m.
pub(super) fn scale(plan: &Plan, instance: u32) -> f64 {
    plan.driven(instance).free_amplitude().max(1e-15)
}

/// Newton's tolerance on the distance to the periodic state, in units of [`scale`].
pub(super) fn newton_tol(plan: &Plan) -> f64 {
    NEWTON_TOL_SHARE * plan.run.accuracy
}

/// The same where the map is rough.
pub(super) fn fallback_tol(plan: &Plan) -> f64 {
    FALLBACK_TOL_SHARE * plan.run.accuracy
}

/// Terms of a period's Jacobian below this may be dropped: a small share of 1 minus the free lever's largest multiplier.
pub(super) fn jacobian_drop_tol(plan: &Plan, instance: u32) -> f64 {
    JACOBIAN_DROP_SHARE * (1.0 - free_multiplier(plan, instance))
}

/// Whether a search may begin in f32: rounding at a fixed point stays below the tolerance there.
pub(super) fn starts_in_f32(plan: &Plan, instance: u32) -> bool {
    PERIOD_ROUNDING_F32 < 0.5 * NEWTON_TOL_F32 * (1.0 - free_multiplier(plan, instance))
}

/// Number of finite-difference columns that cost as much as the whole Jacobian by tangents.
pub(super) fn jacobian_columns(plan: &Plan, instance: u32) -> usize {
    match plan.law(instance).attraction() {
        Attraction::Distant => JACOBIAN_COST_COLUMNS.1,
        Attraction::None | Attraction::Contact => JACOBIAN_COST_COLUMNS.0,
    }
}

/// The free lever's largest multiplier.
pub(super) fn free_multiplier(plan: &Plan, instance: u32) -> f64 {
    let driven = plan.driven(instance);
    let left = |mode: &KeptMode| (-TAU * mode.damping * mode.omega / driven.free.omega).exp();
    driven.kept.modes.iter().map(left).fold(0.0, f64::max)
}

/// Whether contact depends on the past, and the options of a search for the instance's state.
pub(super) fn newton_options(plan: &Plan, instance: u32) -> (bool, NewtonOptions) {
    let case = plan.case(instance);
    let remembers = case.contact.law.has_hysteresis();
    let (step, last_step) = if remembers { FD_STEPS_ROUGH } else { FD_STEPS_SMOOTH };
    let options = NewtonOptions {
        scale: scale(plan, instance),
        tolerance: newton_tol(plan),
        fallback_tolerance: fallback_tol(plan),
        fd_step: step,
        central_fd_step: last_step,
        max_evaluations: MAX_NEWTON_EVALUATIONS,
        start_is_close: false,
        reuse_jacobian: false,
        jacobian_columns: None,
        stable_below_fd: stable_below_fd(plan, instance),
        stable_below: stable_below(plan, instance),
        require_stable: true,
    };
    (remembers, options)
}

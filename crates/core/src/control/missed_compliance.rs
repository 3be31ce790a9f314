//! What a basis misses of the tip's compliance while a contact lasts.

use super::basis_choice::unbent;
use super::difference_scale::remaining_error_factor;
use crate::compare::Scales;
use crate::observe::{Measured, Observable};
use crate::plan::{Plan, compliance};
use std::f64::consts::TAU;

/// The rate of a contact times its duration: a Hertzian collision of depth d and speed v lasts 2.94 d/v and has the rate
/// 1.37 v/d.
const RATE_BY_DURATION: f64 = 4.0;
/// The error of the largest force, over what the rate of the contact alone would make it: onset and end of the contact are
/// faster than its middle.
const ONSET_MARGIN: f64 = 2.0;

/// A share of the accuracy that no estimate needs.
const NEGLIGIBLE_SHARE: f64 = 0.01;

/// Error of an instance's largest force, on its scale, from what its basis misses of the tip's compliance at the rate of the
/// contact that was measured.
///
/// A plan expects a contact as long as a collision of the free tip. A tip that grazes the sample touches it for a shorter
/// time, and moves more modes. Few members of a sample do so. 0 if the force is not requested, nothing was touched, or the
/// scene prescribes the modes.
pub(super) fn missed(plan: &Plan, instance: u32, measured: &Measured) -> f64 {
    let share = measured.contact_time / measured.contacts;
    let depth = measured.indentation_max;
    let known = share > 0.0 && share.is_finite() && depth > 0.0;
    if !known || plan.run.modes.is_some() || !plan.observables.contains(&Observable::ForceMax) {
        return 0.0;
    }
    let (driven, contact) = (plan.driven(instance), plan.contact(instance));
    let rate = RATE_BY_DURATION * driven.free.omega / (TAU * share);
    let whole =
        compliance(driven.instrument.modes.iter().map(|mode| (mode.omega, mode.inverse_mass())), rate);
    let kept = compliance(driven.kept.modes.iter().map(|mode| (mode.omega, mode.inverse_mass)), rate);
    let stiffness = contact.stiffness_at(depth, rate);
    let part = stiffness * (kept - whole).abs() / (1.0 + stiffness * whole.abs());
    let moved = ONSET_MARGIN * part * contact.law().elastic_force(depth).max(measured.force_max);
    // The scale of forces is no less than the largest of them, and takes longer to tell.
    let largest = measured.force_max.abs().max(measured.force_min.abs());
    if moved <= NEGLIGIBLE_SHARE * plan.run.accuracy * largest {
        return 0.0;
    }
    let error = moved / Scales::of(plan, instance as usize, measured).force;
    if error.is_finite() { error } else { 0.0 }
}

/// Truncation error of an instance whose result differs by `apart` from that with a poorer basis.
pub(super) fn truncation_error(plan: &Plan, instance: u32, apart: f64, measured: &Measured) -> f64 {
    let of_bases = remaining_error_factor(plan, instance) * apart + unbent(plan, instance, measured);
    of_bases.max(missed(plan, instance, measured))
}

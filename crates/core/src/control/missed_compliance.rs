//! What a basis misses of the tip's compliance.

use super::difference_scale::remaining_error_factor;
use crate::compare::{self, Scales};
use crate::observe::{Measured, Observable};
use crate::orbit::{OrbitSolution, PeriodicState};
use crate::plan::{Driven, Plan, compliance};
use nalgebra::Complex;
use std::f64::consts::TAU;

/// The rate of a contact times its duration: a Hertzian collision of depth d and speed v lasts 2.94 d/v and has the rate
/// 1.37 v/d.
const RATE_BY_DURATION: f64 = 4.0;
/// The error of the largest force, over what the rate of the contact alone would make it: onset and end of the contact are
/// faster than its middle.
const ONSET_MARGIN: f64 = 2.0;

/// A share of the accuracy that no estimate needs.
const NEGLIGIBLE_SHARE: f64 = 0.01;

/// What an estimate knows of a motion that was found.
#[derive(Clone, Copy)]
pub(super) struct FoundMotion<'a> {
    pub measured: &'a Measured,
    /// The slope of its set-point's residual over the gap, 1/m, if it is known.
    gap_slope: Option<f64>,
}

impl<'a> FoundMotion<'a> {
    pub fn new(measured: &'a Measured, state: Option<&PeriodicState>) -> Self {
        Self { measured, gap_slope: state.and_then(|state| state.gap_slope) }
    }

    /// The motion of an instance of this run.
    pub fn of_run(run: &'a OrbitSolution, instance: u32) -> Self {
        let n = instance as usize;
        Self::new(&run.outcome.results[n].measured, run.state(n))
    }

    /// Error of an instance, on its scales, if the tip swings by `travel` (m) too little or too much. The gap of a set-point is
    /// off by much more than that where the amplitude hardly depends on it.
    pub fn travel_error(&self, plan: &Plan, instance: u32, travel: f64) -> f64 {
        let error = travel / plan.driven(instance).free_amplitude();
        match self.gap_slope {
            Some(slope) => error.max(travel / (slope.abs() * plan.driven(instance).free_amplitude().powi(2))),
            None => error,
        }
    }
}

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

/// Error of an instance, on its scales, from the travel of the tip that no oscillator makes: under the mean force, which also
/// does work on it, and under the fundamental of the force. A force that nobody measured counts as none.
///
/// To the sample this travel is a shift of the gap. A contact that lasts gives way to it: the tip moves by what the contact's
/// stiffness leaves of it.
pub(super) fn missed_travel(plan: &Plan, instance: u32, found: FoundMotion) -> f64 {
    let (driven, measured) = (plan.driven(instance), found.measured);
    let kept = &driven.kept;
    let bent = (kept.residual_share * kept.flexibility * measured.force_mean).abs();
    let swing = (kept.missed_response * fundamental(driven, measured)).norm();
    let of_virial = plan.observables.contains(&Observable::Virial);
    let travel = bent / driven.free_amplitude() + found.travel_error(plan, instance, swing);
    if !of_virial && travel <= NEGLIGIBLE_SHARE * plan.run.accuracy {
        return 0.0;
    }
    let scales = Scales::of(plan, instance as usize, measured);
    let mut error = 0.0_f64;
    if of_virial {
        let work = bent * measured.force_mean.abs();
        error = work / scales.work.max(measured.virial.abs());
    }
    // A scene that prescribes the modes wants no others.
    if plan.run.modes.is_none() {
        let stiffness = lasting_stiffness(plan, instance, measured);
        let rest = bent / (1.0 + stiffness * kept.flexibility);
        let swing = swing * lasting_response(plan, instance, measured, 1.0);
        // The gap of a set-point takes the whole shift.
        let shift = if plan.has_setpoints() { bent } else { rest };
        let travel = shift / scales.length + found.travel_error(plan, instance, swing);
        error = error.max(travel).max(stiffness * (rest + swing) / scales.force);
    }
    if error.is_nan() { 0.0 } else { error }
}

/// Fundamental of the contact force, N, from that of the tip's travel: the instrument is linear.
pub(super) fn fundamental(driven: &Driven, measured: &Measured) -> Complex<f64> {
    (compare::tip(measured) - driven.free.tip) / driven.free.compliance
}

/// The tip's travel per travel that its lever misses, both at this harmonic of the drive: a contact that lasts resists it, or
/// amplifies it next to a resonance of the pressed lever. 1 for any other contact.
pub(super) fn lasting_response(plan: &Plan, instance: u32, measured: &Measured, harmonic: f64) -> f64 {
    let driven = plan.driven(instance);
    let stiffness = lasting_stiffness(plan, instance, measured);
    if stiffness == 0.0 {
        return 1.0;
    }
    let omega = harmonic * driven.free.omega;
    let compliance: Complex<f64> = driven.kept.modes.iter().map(|mode| mode.response(omega)).sum();
    (1.0 + stiffness * compliance).norm().recip()
}

/// Stiffness of a contact that lasts for the whole period, N/m, at half of its deepest indentation. 0 for any other contact.
fn lasting_stiffness(plan: &Plan, instance: u32, measured: &Measured) -> f64 {
    let lasts = measured.contact_time >= 1.0 && measured.indentation_max > 0.0;
    if lasts { plan.contact(instance).stiffness(0.5 * measured.indentation_max, true).abs() } else { 0.0 }
}

/// Truncation error of an instance whose result differs by `apart` from that with a poorer basis.
pub(super) fn truncation_error(plan: &Plan, instance: u32, apart: f64, found: FoundMotion) -> f64 {
    let of_bases = remaining_error_factor(plan, instance) * apart + missed_travel(plan, instance, found);
    of_bases.max(missed(plan, instance, found.measured))
}

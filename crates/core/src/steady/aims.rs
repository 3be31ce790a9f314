//! How near a search is to come, and what is stable without a doubt.

use crate::kernel::Attraction;
use crate::periodic::Options;
use crate::plan::{KeptMode, Plan};
use std::f64::consts::TAU;

/// Evaluations after which a search gives up.
const MOST: u32 = 300;
/// Distance to the periodic state that is aimed at, and that is near enough where the map is rough, as shares of the
/// accuracy asked for.
const NEAR: f64 = 1e-3;
const ENOUGH: f64 = 0.1;
/// Differences, in units of the free amplitude, that make the map's slope on the way and at the end: jumps of the
/// contact make it rough.
const SMOOTH: (f64, Option<f64>) = (1e-6, None);
const ROUGH: (f64, Option<f64>) = (3e-5, Some(3e-4));

/// Distance to a state up to which a search may go in f32, and what is near enough there where the map is rough; and what f32 leaves
/// of a number in a period, about.
pub(super) const NEAR_F32: f64 = 1e-3;
pub(super) const ENOUGH_F32: f64 = 1e-2;
const LEFT_F32: f64 = 5e-7;

/// See [`clearly`]: the share, and its least and largest value.
const DOUBTED: f64 = 0.35;
const CLEARLY: (f64, f64) = (0.99, 0.999);

/// See [`tangent_columns`]: where the law acts in some steps of a period, and where it acts in all.
const WORTH: (usize, usize) = (3, 12);

/// See [`least`].
const LEFT_OUT: f64 = 0.02;

/// Below which multiplier a state is stable without a doubt: where so large a share is left of the distance to 1 that the
/// free lever's largest multiplier has. One-sided differences are good to a thousandth.
fn clearly(plan: &Plan, instance: u32) -> f64 {
    certainly(plan, instance).min(CLEARLY.1)
}

/// The same for multipliers that are known well.
pub(super) fn certainly(plan: &Plan, instance: u32) -> f64 {
    (1.0 - DOUBTED * (1.0 - free_multiplier(plan, instance))).max(CLEARLY.0)
}

/// Length of a state that is not small, m.
pub(super) fn scale(plan: &Plan, instance: u32) -> f64 {
    plan.driven(instance).free_amplitude().max(1e-15)
}

/// The distance to the periodic state that is aimed at, in units of that.
pub(super) fn near(plan: &Plan) -> f64 {
    NEAR * plan.run.accuracy
}

/// The same where the map is rough.
pub(super) fn enough(plan: &Plan) -> f64 {
    ENOUGH * plan.run.accuracy
}

/// What may be left out of a period's slope: so small a share of the distance to 1 that the free lever's largest multiplier has.
pub(super) fn least(plan: &Plan, instance: u32) -> f64 {
    LEFT_OUT * (1.0 - free_multiplier(plan, instance))
}

/// Whether a search may begin in f32: what its rounding comes to at a fixed point is less than the distance that it may leave.
pub(super) fn begins_in_f32(plan: &Plan, instance: u32) -> bool {
    LEFT_F32 < 0.5 * NEAR_F32 * (1.0 - free_multiplier(plan, instance))
}

/// How many columns of a slope by differences take as long as the slope by tangents.
pub(super) fn tangent_columns(plan: &Plan, instance: u32) -> usize {
    match plan.law(instance).attraction() {
        Attraction::Distant => WORTH.1,
        Attraction::None | Attraction::Contact => WORTH.0,
    }
}

/// The free lever's largest multiplier.
fn free_multiplier(plan: &Plan, instance: u32) -> f64 {
    let driven = plan.driven(instance);
    let left = |mode: &KeptMode| (-TAU * mode.damping * mode.omega / driven.free.omega).exp();
    driven.kept.modes.iter().map(left).fold(0.0, f64::max)
}

/// Whether contact is a memory, and how a search for the instance's state goes about.
pub(super) fn options(plan: &Plan, instance: u32) -> (bool, Options) {
    let case = plan.case(instance);
    let remembers = case.contact.law.has_memory();
    let (step, last_step) = if remembers { ROUGH } else { SMOOTH };
    let options = Options {
        scale: scale(plan, instance),
        tolerance: near(plan),
        enough: enough(plan),
        step,
        last_step,
        most: MOST,
        near: false,
        carried: false,
        tangent: None,
        clearly: clearly(plan, instance),
        certainly: certainly(plan, instance),
        stable: true,
    };
    (remembers, options)
}

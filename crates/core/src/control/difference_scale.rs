//! The difference between two runs of an instance, and the share of it that remains in the better run's error.

use crate::compare::{Scales, worst};
use crate::engine::Finished;
use crate::plan::{BasisRule, Plan};
use rayon::prelude::*;
use std::f64::consts::{PI, TAU};

/// Difference of two results of an instance: that of the worst observable on its scale.
pub(super) fn scaled_difference(plan: &Plan, i: u32, a: &Finished, b: &Finished) -> f64 {
    let scales = Scales::of(plan, i as usize, &b.measured);
    worst(&plan.observables, &a.measured, &b.measured, &scales)
}

/// Differences of these instances between `other`, a run of them alone, and `all`, a run of all instances.
pub(super) fn scaled_differences(
    plan: &Plan,
    instances: &[u32],
    other: &[Finished],
    all: &[Finished],
) -> Vec<f64> {
    let apart = |(i, other): (&u32, &Finished)| scaled_difference(plan, *i, other, &all[*i as usize]);
    instances.par_iter().zip(other).map(apart).collect()
}

/// Share of the difference between two bases that remains in the richer one's error, for this contact.
pub(super) fn remaining_error_factor(plan: &Plan, i: u32) -> f64 {
    let policy = &plan.policy;
    let jumps = plan.law(i).jumps();
    let corners = jumps || plan.run.accuracy < policy.corners_below;
    match (corners, is_fast(plan, i)) {
        (true, true) => policy.left_of_fast_corners,
        (false, true) => policy.left_of_fast,
        (true, false) => policy.left_of_corners,
        (false, false) => policy.left_of_steps,
    }
}

/// Share of the difference between two numbers of steps that remains in the finer run's error, the coarser run having
/// `coarser` steps in a period. Above the accuracy `corners_below` oscillators that a run cannot follow are too small a part.
pub(super) fn remaining_step_error(plan: &Plan, i: u32, coarser: u32) -> f64 {
    let (driven, policy) = (plan.driven(i), &plan.policy);
    let turn = TAU * driven.kept.fastest() / (driven.free.omega * f64::from(coarser));
    let aliased = turn > PI && plan.run.accuracy < policy.corners_below;
    if aliased { policy.left_of_aliased } else { policy.left_of_steps }
}

/// Whether the rate of the contact determines the instance's oscillators.
pub(super) fn is_fast(plan: &Plan, i: u32) -> bool {
    matches!(plan.basis_rule(i), BasisRule::Contact { .. })
}

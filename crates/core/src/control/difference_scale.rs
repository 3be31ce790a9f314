//! How far two runs of an instance are apart, and what of it is left in the better one's error.

use crate::compare::{Scales, worst};
use crate::engine::Finished;
use crate::plan::{BasisRule, Plan};
use rayon::prelude::*;

/// How far two results of an instance are apart: the worst observable on its scale.
pub(super) fn scaled_difference(plan: &Plan, i: u32, a: &Finished, b: &Finished) -> f64 {
    let scales = Scales::of(plan, i as usize, &b.measured);
    worst(&plan.observables, &a.measured, &b.measured, &scales)
}

/// How far the results of these instances in another run, which was of them alone, are from those in a run of all.
pub(super) fn scaled_differences(
    plan: &Plan,
    instances: &[u32],
    other: &[Finished],
    all: &[Finished],
) -> Vec<f64> {
    let apart = |(i, other): (&u32, &Finished)| scaled_difference(plan, *i, other, &all[*i as usize]);
    instances.par_iter().zip(other).map(apart).collect()
}

/// What is left of the difference between two bases in the richer one's error, for the contacts of this instance.
pub(super) fn remaining_error_factor(plan: &Plan, i: u32) -> f64 {
    let policy = &plan.policy;
    let jumps = plan.law(i).has_memory();
    let corners = jumps || plan.run.accuracy < policy.corners_below;
    match (corners, is_fast(plan, i)) {
        (true, true) => policy.left_of_fast_corners,
        (false, true) => policy.left_of_fast,
        (true, false) => policy.left_of_corners,
        (false, false) => policy.left_of_steps,
    }
}

/// Whether the instance's oscillators are chosen by the rate of its contact.
pub(super) fn is_fast(plan: &Plan, i: u32) -> bool {
    matches!(plan.basis_rule(i), BasisRule::Contact { .. })
}

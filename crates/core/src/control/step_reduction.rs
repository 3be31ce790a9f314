//! Plans with fewer steps, for first estimates.

use crate::plan::Plan;

/// Halves the plan's steps, which are on the safe side.
pub(super) fn half_steps(plan: Plan) -> Plan {
    let fewest = 2 * plan.policy.fewest_steps;
    plan.with_steps(|steps| (steps / 2).max(fewest))
}

/// Quarters the plan's steps, for the first estimate.
pub(super) fn quarter_steps(plan: Plan) -> Plan {
    half_steps(plan).with_steps(|steps| steps / 2)
}

//! How far a set-point is missed.

use crate::engine::Finished;
use crate::plan::Plan;
use crate::scene::Held;

/// How far what an instance holds is from what it is to hold, as a share of the free amplitude or of the force: above zero
/// where the sample is to come nearer.
pub(super) fn miss(plan: &Plan, instance: u32, result: &Finished) -> f64 {
    let measured = &result.measured;
    match plan.setpoint(instance).map(|setpoint| setpoint.held) {
        Some(Held::Amplitude(share)) => {
            measured.harmonics[0] / plan.driven(instance).free_amplitude() - share
        }
        Some(Held::Force(force)) => 1.0 - measured.force_max / force,
        None => 0.0,
    }
}

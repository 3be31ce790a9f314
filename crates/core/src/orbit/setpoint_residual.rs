//! How far a set-point is missed.

use crate::engine::Finished;
use crate::plan::Plan;
use crate::scene::Held;

/// How far what an instance holds is from what it is to hold, as a share of the free amplitude or of the force, of a phase in
/// radians: above zero where the sample is to come nearer.
pub(super) fn setpoint_residual(plan: &Plan, instance: u32, result: &Finished) -> f64 {
    let measured = &result.measured;
    match plan.setpoint(instance).map(|setpoint| setpoint.held) {
        Some(Held::Amplitude(share)) => {
            measured.harmonics[0] / plan.driven(instance).free_amplitude() - share
        }
        Some(Held::Deflection(share)) => {
            let free = &plan.driven(instance).free;
            measured.deflection_amplitude / free.deflection(free.tip).norm() - share
        }
        // The phase moves from the free one towards it, the short way round.
        Some(Held::Phase(degrees)) => {
            let from = |phase: f64| (phase - degrees + 180.0).rem_euclid(360.0) - 180.0;
            (from(measured.phase) * from(measured.free_phase).signum()).to_radians()
        }
        Some(Held::Force(force)) => 1.0 - measured.force_max / force,
        None => 0.0,
    }
}

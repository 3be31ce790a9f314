//! The residual of a set-point.

use crate::engine::Finished;
use crate::plan::Plan;
use crate::scene::Held;

/// The residual of an instance's set-point: a share of the free amplitude or of the force, for a phase in radians. It is
/// positive where the sample is to come nearer.
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
        // The phase moves from the free one towards the set-point, the short way round.
        Some(Held::Phase(degrees)) => {
            let from = |phase: f64| (phase - degrees + 180.0).rem_euclid(360.0) - 180.0;
            (from(measured.phase) * from(measured.free_phase).signum()).to_radians()
        }
        Some(Held::Force(force)) => 1.0 - measured.force_max / force,
        None => 0.0,
    }
}

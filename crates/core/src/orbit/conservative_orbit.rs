//! Tapping on a sample that takes no energy, in closed form. A search for a branch starts here.

use super::orbit_transfer;
use crate::kernel::MODES_MAX;
use crate::plan::{KeptMode, Plan, SectionState};
use nalgebra::Complex;

/// The motion that keeps `share` of the free amplitude while the sample takes no energy. Its force is then in phase with the
/// travel, `F = kappa z`, and with the compliance C at the drive `z = z0/(1 - C kappa)`. Two real kappa give the share: a
/// negative one, for a force that pushes where the tip is nearest, and a positive one.
pub(super) fn conservative_orbit(plan: &Plan, instance: u32, share: f64, repulsive: bool) -> SectionState {
    let driven = plan.driven(instance);
    let compliance = driven.free.compliance;
    let (size, cosine) = (compliance.norm(), compliance.arg().cos());
    let root = (cosine * cosine - 1.0 + share.powi(-2)).sqrt();
    let kappa = (cosine + if repulsive { -root } else { root }) / size;
    let beyond = driven.free.tip / (1.0 - compliance * kappa) - driven.free.tip;
    let mut station = SectionState::free(plan, instance);
    // The mode that answers the drive most takes the whole motion.
    let far = |mode: &KeptMode| (mode.omega / driven.free.omega).ln().abs();
    let modes = &driven.kept.modes[..driven.kept.modes.len().min(MODES_MAX)];
    let nearest = (0..modes.len()).min_by(|a, b| far(&modes[*a]).total_cmp(&far(&modes[*b])));
    if let Some(k) = nearest {
        let turned =
            beyond * Complex::from_polar(1.0, orbit_transfer::section_angle(driven, plan.steps(instance)));
        (station.x[k], station.u[k]) = (turned.im, turned.re * driven.free.omega / modes[k].omega);
    }
    station
}

//! A sample that relaxes.

use super::reference_law::{DmtPull, ReferenceForm};
use crate::contact::Contact;
use crate::kernel::LENGTH;

/// A standard linear solid: a half-space of springs `kappa` delta^1.5 at once, whose share `arm` relaxes within `tau`, s.
///
/// It remembers how deep its dashpots are at the centre, y, and their sum S in units of delta^1.5 over the root of a
/// kernel's length. While the contact widens beyond them, delta y^2 > S^2, kappa (delta^1.5 - arm S); within, kappa (delta
/// - arm y)^1.5 (1 - arm y^3/S^2)^-0.5. DMT's attraction acts beside it.
#[derive(Clone, Copy, Debug)]
pub(super) struct ReferenceRelaxing {
    kappa: f64,
    arm: f64,
    tau: f64,
    pull: DmtPull,
}

impl ReferenceForm for ReferenceRelaxing {
    fn of(contact: &Contact) -> Self {
        Self {
            kappa: contact.instantaneous * contact.radius.sqrt(),
            arm: 1.0 - contact.modulus / contact.instantaneous,
            tau: contact.retardation * contact.modulus / contact.instantaneous,
            pull: DmtPull::of(contact),
        }
    }

    #[inline]
    fn at(&self, delta: f64, _: impl FnOnce() -> f64, memory: [f64; 2], touching: bool) -> f64 {
        let pressed = if touching { relaxing((self.kappa, self.arm), delta, memory) } else { 0.0 };
        pressed + self.pull.at(delta, touching)
    }

    fn remembered(&self, delta: f64, touching: bool, [depth, sum]: [f64; 2]) -> [f64; 2] {
        let Self { kappa, arm, tau, .. } = *self;
        let force = if touching { relaxing((kappa, arm), delta, [depth, sum]) } else { 0.0 };
        let pressed = force / (kappa * LENGTH.sqrt());
        [(delta.max(arm * depth) - depth) / tau, (pressed - (1.0 - arm) * sum) / tau]
    }

    fn pressing(&self, delta: f64, _: f64, memory: [f64; 2]) -> f64 {
        delta - self.arm * memory[0]
    }
}

/// A sample that relaxes: `kappa` at once, of which the share `arm` relaxes.
fn relaxing((kappa, arm): (f64, f64), delta: f64, [depth, sum]: [f64; 2]) -> f64 {
    let sum = sum * LENGTH.sqrt();
    let above = delta - arm * depth;
    if above <= 0.0 {
        0.0
    } else if delta * depth * depth >= sum * sum {
        kappa * (delta * delta.sqrt() - arm * sum).max(0.0)
    } else {
        // However hollow: the kernel's bound.
        let least = (0.5 * (1.0 - arm)).min(0.1);
        let hollow = (1.0 - arm * depth * depth * depth / (sum * sum)).max(least);
        kappa * above * above.sqrt() / hollow.sqrt()
    }
}

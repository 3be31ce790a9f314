//! A viscous sample (Ting 1966, or the ad hoc form).

use super::reference_law::{DmtPull, ReferenceForm, hertz};
use crate::contact::Contact;

/// Of retardation time `tau`, s: kappa (delta^1.5 + 1.5 tau sqrt(delta) v) inward, kappa (delta + tau v)^1.5 outward, with DMT's
/// attraction. The ad hoc form has the first on both ways.
#[derive(Clone, Copy, Debug)]
pub(super) struct ReferenceViscous {
    kappa: f64,
    tau: f64,
    ad_hoc: bool,
    pull: DmtPull,
}

impl ReferenceForm for ReferenceViscous {
    fn of(contact: &Contact) -> Self {
        Self {
            kappa: contact.modulus * contact.radius.sqrt(),
            tau: contact.retardation,
            ad_hoc: contact.ad_hoc,
            pull: DmtPull::of(contact),
        }
    }

    #[inline]
    fn at(&self, delta: f64, rate: impl FnOnce() -> f64, _: [f64; 2], touching: bool) -> f64 {
        let Self { kappa, tau, ad_hoc, pull } = *self;
        let pull = pull.at(delta, touching);
        if !touching {
            return pull;
        }
        let along = tau * rate();
        let pressed = match along < 0.0 && !ad_hoc {
            true => hertz(kappa, delta + along, true),
            false => hertz(kappa, delta, true) + 1.5 * kappa * delta.max(0.0).sqrt() * along,
        };
        pressed + pull
    }

    fn pressing(&self, delta: f64, rate: f64, _: [f64; 2]) -> f64 {
        if rate < 0.0 && !self.ad_hoc { (delta + self.tau * rate).min(delta) } else { delta }
    }
}

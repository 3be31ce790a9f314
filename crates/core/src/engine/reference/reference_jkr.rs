//! JKR's contact, by its radius.

use super::reference_law::ReferenceForm;
use crate::contact::Contact;
use std::f64::consts::PI;

/// In the contact radius: delta = a^2/R - (2/3) sqrt(6 pi w a/K), f = K a^3/R - sqrt(6 pi w K a^3): Ha, Fung & Chen 2005,
/// equation (16). `radius` is a at the fold, `unit` a^2/R there.
#[derive(Clone, Copy, Debug)]
pub(super) struct ReferenceJkr {
    elastic: f64,
    adhesive: f64,
    radius: f64,
    unit: f64,
}

impl ReferenceForm for ReferenceJkr {
    fn of(contact: &Contact) -> Self {
        let (k, r, w) = (contact.modulus, contact.radius, contact.work);
        // d delta/da = 0: 2a/R = sqrt(6 pi w/(K a))/3
        let radius = (PI * w * r * r / (6.0 * k)).cbrt();
        Self { elastic: k / r, adhesive: (6.0 * PI * w * k).sqrt(), radius, unit: radius * radius / r }
    }

    #[inline]
    fn at(&self, delta: f64, _: impl FnOnce() -> f64, _: [f64; 2], touching: bool) -> f64 {
        if !touching {
            return 0.0;
        }
        let a = self.radius * (1.0 + growth(delta / self.unit + 3.0));
        let cube = a * a * a;
        self.elastic * cube - self.adhesive * cube.sqrt()
    }

    fn level(&self, touching: bool) -> Option<f64> {
        Some(if touching { -3.0 * self.unit } else { 0.0 })
    }

    fn touches(&self, delta: f64) -> bool {
        delta >= 0.0
    }

    /// df/da = 0 at a^3 = 9 a_s^3.
    fn deepest_pull(&self) -> Option<f64> {
        let ratio = 9f64.cbrt();
        Some(self.unit * (ratio * ratio - 4.0 * ratio.sqrt()))
    }
}

/// The contact radius beyond that at the fold, in units of it, `rise` above the fold in units of a_s^2/R: e of e^2 (1 + 2/(s +
/// 1)^2) = rise, s = sqrt(1 + e), by Newton's method kept inside its bracket.
fn growth(rise: f64) -> f64 {
    if rise <= 0.0 {
        return 0.0;
    }
    // The factor lies between 1 (far) and 3/2 (at the fold).
    let (mut low, mut high) = ((rise / 1.5).sqrt(), rise.sqrt());
    let s = (1.0 + low).sqrt();
    let mut e = (rise / (1.0 + 2.0 / ((s + 1.0) * (s + 1.0)))).sqrt();
    for _ in 0..60 {
        let s = (1.0 + e).sqrt();
        let value = e * e * (1.0 + 2.0 / ((s + 1.0) * (s + 1.0))) - rise;
        if value < 0.0 {
            low = e;
        } else {
            high = e;
        }
        let slope = 2.0 * e * (s * s + s + 1.0) / ((s + 1.0) * s);
        let mut next = e - value / slope;
        if !(low..=high).contains(&next) {
            next = 0.5 * (low + high);
        }
        let moved = (next - e).abs();
        e = next;
        if moved <= 2.0 * f64::EPSILON * e || moved.is_nan() {
            break;
        }
    }
    e
}

//! DMT: Hertz's profile under an attraction that acts from outside the contact.

use super::static_law::Shares;
use super::{Compact, Hertz, KernelUnits, Passed, StaticLaw};
use crate::kernel::LENGTH;
use std::f64::consts::PI;

/// `f = K sqrt(R) delta^1.5 - 2 pi w R` in contact and `-2 pi w R/(1 + d/D0)^2` at the distance
/// `d = -delta` outside; `a^2 = R delta`.
///
/// Derjaguin, Muller & Toporov 1975; equations (17) and (18) of Ha, Fung & Chen 2005. Two readings
/// of the paper are settled here. Its (17b) prints JKR's indentation against its own text, which
/// keeps Hertz's profile: that is what stands here. Its (18) as printed is singular at `d = D0`
/// unless the distance counts negative: the form above is continuous at `d = 0` and equals van
/// der Waals' `-H R/(6 (D0 + d)^2)` for `w = H/(12 pi D0^2)`.
///
/// ```
/// use afmsweep_model::contact::{Dmt, StaticLaw};
/// let law = Dmt::new(1e9, 1e-8, 0.05, 3e-10);
/// let pull_off = -2.0 * std::f64::consts::PI * 0.05 * 1e-8;
/// assert_eq!(law.force(0.0, false), pull_off);
/// assert!((law.force(-3e-10, false) / (pull_off / 4.0) - 1.0).abs() < 1e-15);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dmt<E = Hertz> {
    pub(super) elastic: E,
    radius: f64,
    work: f64,
    adhesion: f64,
    decay_length: f64,
}

impl Dmt {
    /// Combined modulus (Pa), tip radius (m), work of adhesion (J/m^2), decay length D0 (m).
    pub fn new(modulus: f64, radius: f64, work: f64, decay_length: f64) -> Self {
        Self::beside(Hertz::new(modulus, radius), radius, work, decay_length)
    }
}

impl<E> Dmt<E> {
    /// D0, m.
    pub(super) fn decay(&self) -> f64 {
        self.decay_length
    }

    fn beside(elastic: E, radius: f64, work: f64, decay_length: f64) -> Self {
        Self { elastic, radius, work, adhesion: 2.0 * PI * work * radius, decay_length }
    }
}

impl<E: for<'a> From<&'a Compact>> From<&Compact> for Dmt<E> {
    fn from(of: &Compact) -> Self {
        Self::beside(of.into(), of.radius, of.work, of.decay_length)
    }
}

impl<E: StaticLaw> StaticLaw for Dmt<E> {
    fn force(&self, delta: f64, in_contact: bool) -> f64 {
        if delta < 0.0 {
            let reach = 1.0 - delta / self.decay_length;
            -self.adhesion / (reach * reach)
        } else {
            self.elastic.force(delta, in_contact) - self.adhesion
        }
    }

    fn stiffness(&self, delta: f64, in_contact: bool) -> f64 {
        if delta < 0.0 {
            let reach = 1.0 - delta / self.decay_length;
            -2.0 * self.adhesion / (self.decay_length * reach * reach * reach)
        } else {
            self.elastic.stiffness(delta, in_contact)
        }
    }

    fn energy(&self, delta: f64, in_contact: bool) -> f64 {
        let at_touch = -self.adhesion * self.decay_length;
        if delta < 0.0 {
            at_touch / (1.0 - delta / self.decay_length)
        } else {
            self.elastic.energy(delta, in_contact) - self.adhesion * delta + at_touch
        }
    }

    fn contact_radius(&self, delta: f64, in_contact: bool) -> f64 {
        self.elastic.contact_radius(delta, in_contact)
    }

    fn elastic_force(&self, depth: f64) -> f64 {
        self.elastic.elastic_force(depth)
    }

    fn collision_depth(&self, speed: f64, inverse_mass: f64) -> f64 {
        self.elastic.collision_depth(speed, inverse_mass)
    }

    fn constants(&self, units: KernelUnits) -> Vec<f64> {
        [self.elastic.constants(units), self.tail_constants(units)].concat()
    }

    fn tail_constants(&self, units: KernelUnits) -> Vec<f64> {
        vec![2.0 * PI * self.radius * self.work * units.impulse, LENGTH / self.decay_length]
    }

    /// Falls from outside to first touch and rises from there.
    fn forces(&self, passed: &Passed) -> (f64, f64) {
        let at = |delta: f64| self.force(delta, delta > 0.0);
        let ends = [at(passed.deepest), at(passed.highest)];
        let reached = passed.highest <= 0.0 && passed.deepest >= 0.0;
        let least = if reached { self.force(0.0, true) } else { f64::INFINITY };
        (least.min(ends[0]).min(ends[1]), ends[0].max(ends[1]))
    }

    fn zero_force(&self) -> f64 {
        self.elastic.depth_under(self.adhesion)
    }

    fn pull_off(&self) -> f64 {
        -self.adhesion
    }

    fn attraction_slope(&self) -> f64 {
        4.0 * PI * self.radius * self.work / self.decay_length
    }

    /// Evenly spaced in the logarithm of 1 + d/D0, out to a hundredth of the pull-off force.
    fn outside(&self, _deepest: f64, shares: Shares) -> Vec<f64> {
        shares.iter().map(|share| -self.decay_length * (10f64.powf(*share) - 1.0)).collect()
    }
}

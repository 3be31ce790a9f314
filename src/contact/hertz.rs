//! Hertz: elastic sphere on a flat, no adhesion.

use super::{KernelUnits, Material, StaticLaw};
use crate::kernel::LENGTH;

/// `f = K sqrt(R) delta^1.5` in contact, 0 outside; `a^2 = R delta`.
///
/// Hertz 1882; equation (14) of Ha, Fung & Chen 2005.
///
/// ```
/// use afmsweep::contact::{Hertz, StaticLaw};
/// let law = Hertz::new(1e9, 4e-8);
/// // K sqrt(R) delta^1.5 = 1e9 * 2e-4 * 1e-3^3 * 1e-9 at a depth of 1e-10 m
/// assert!((law.force(1e-10, true) / 2e-10 - 1.0).abs() < 1e-14);
/// assert_eq!(law.force(-1e-10, false), 0.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hertz {
    pub(super) radius: f64,
    /// `K sqrt(R)`, N/m^1.5.
    pub(super) prefactor: f64,
}

impl Hertz {
    /// Combined modulus (Pa), tip radius (m).
    pub fn new(modulus: f64, radius: f64) -> Self {
        Self { radius, prefactor: modulus * radius.sqrt() }
    }
}

impl From<&Material> for Hertz {
    fn from(of: &Material) -> Self {
        Self::new(of.modulus, of.radius)
    }
}

impl StaticLaw for Hertz {
    fn force(&self, delta: f64, _in_contact: bool) -> f64 {
        if delta <= 0.0 { 0.0 } else { self.prefactor * delta * delta.sqrt() }
    }

    fn stiffness(&self, delta: f64, _in_contact: bool) -> f64 {
        if delta <= 0.0 { 0.0 } else { 1.5 * self.prefactor * delta.sqrt() }
    }

    fn energy(&self, delta: f64, _in_contact: bool) -> f64 {
        if delta <= 0.0 { 0.0 } else { 0.4 * self.prefactor * delta * delta * delta.sqrt() }
    }

    fn contact_radius(&self, delta: f64, _in_contact: bool) -> f64 {
        if delta <= 0.0 { 0.0 } else { (self.radius * delta).sqrt() }
    }

    fn constants(&self, units: KernelUnits) -> Vec<f64> {
        vec![self.prefactor * LENGTH.powf(1.5) * units.impulse]
    }
}

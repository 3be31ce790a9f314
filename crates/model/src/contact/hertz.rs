//! Hertz: elastic sphere on a flat, no adhesion.

use super::{Compact, KernelUnits, StaticLaw};
use crate::kernel::LENGTH;

/// `f = K sqrt(R) delta^1.5` in contact, 0 outside; `a^2 = R delta`.
///
/// Hertz 1882; equation (14) of Ha, Fung & Chen 2005.
///
/// ```
/// use afmsweep_model::contact::{Hertz, StaticLaw};
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

    /// The prefactor in the kernel's units.
    pub(super) fn scaled(&self, units: KernelUnits) -> f64 {
        self.prefactor * LENGTH.powf(1.5) * units.impulse
    }
}

impl From<&Compact> for Hertz {
    fn from(of: &Compact) -> Self {
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

    fn elastic_force(&self, depth: f64) -> f64 {
        self.prefactor * depth.powf(1.5)
    }

    fn depth_under(&self, load: f64) -> f64 {
        (load / self.prefactor).cbrt().powi(2)
    }

    /// `(5 v^2/(4 K sqrt(R) inverse mass))^(2/5)`.
    fn collision_depth(&self, speed: f64, inverse_mass: f64) -> f64 {
        (1.25 * speed * speed / (self.prefactor * inverse_mass)).powf(0.4)
    }

    fn constants(&self, units: KernelUnits) -> Vec<f64> {
        vec![self.scaled(units)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A law that says no more than it must: the answers that it has from the trait.
    struct Plain(Hertz);

    impl StaticLaw for Plain {
        fn force(&self, delta: f64, in_contact: bool) -> f64 {
            self.0.force(delta, in_contact)
        }
        fn stiffness(&self, delta: f64, in_contact: bool) -> f64 {
            self.0.stiffness(delta, in_contact)
        }
        fn energy(&self, delta: f64, in_contact: bool) -> f64 {
            self.0.energy(delta, in_contact)
        }
        fn contact_radius(&self, delta: f64, in_contact: bool) -> f64 {
            self.0.contact_radius(delta, in_contact)
        }
        fn constants(&self, units: KernelUnits) -> Vec<f64> {
            self.0.constants(units)
        }
    }

    /// Truth: Hertz's closed form.
    #[test]
    fn exact_collision_depth_is_what_halving_finds() {
        for (modulus, speed, inverse_mass) in [(1e6, 1e-3, 1e12), (1e9, 1e-2, 1e11), (1e11, 1e-1, 1e10)] {
            let law = Hertz::new(modulus, 1e-8);
            let (exact, halved) =
                (law.collision_depth(speed, inverse_mass), Plain(law).collision_depth(speed, inverse_mass));
            assert!((halved / exact - 1.0).abs() < 1e-12, "{exact:e} {halved:e}");
            let energy = law.energy(exact, true) * 2.0 * inverse_mass;
            assert!((energy / (speed * speed) - 1.0).abs() < 1e-12);
        }
        let law = Hertz::new(1e9, 1e-8);
        assert!((Plain(law).depth_under(law.force(2e-9, true)) / 2e-9 - 1.0).abs() < 1e-12);
        assert!((law.depth_under(law.force(2e-9, true)) / 2e-9 - 1.0).abs() < 1e-14);
        assert!((Plain(law).elastic_force(1e-9) / law.elastic_force(1e-9) - 1.0).abs() < 1e-14);
    }
}

//! A standard linear solid under Hertz's law.

use super::{Compact, Hertz, KernelUnits, Passed, StaticLaw, modulus_of};
use crate::scene::Params;

/// A sample of two springs, one of which yields by a dashpot: at once it has one modulus, after a while another.
///
/// The static force is that of the relaxed modulus. Slopes, and whatever else is asked for a collision, are those of the
/// modulus at once. docs/method.md derives the two numbers that the sample remembers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RelaxingHertz {
    relaxed: Hertz,
    instantaneous: Hertz,
    /// s
    retardation: f64,
}

impl From<&Compact> for RelaxingHertz {
    fn from(of: &Compact) -> Self {
        Self {
            relaxed: of.into(),
            instantaneous: Hertz::new(of.instantaneous, of.radius),
            retardation: of.retardation,
        }
    }
}

impl Compact {
    /// The same of a sample with this modulus at once (Pa) and relaxation time (s). Under a tip that yields, too, the pair has
    /// other moduli, but the sample's retardation time.
    pub(super) fn relaxing(self, params: &Params, modulus: f64, time: f64) -> Self {
        let instantaneous = modulus_of(params, modulus);
        match self.law.relaxing() {
            Some(law) if instantaneous != self.modulus => {
                let retardation = time * modulus / params.sample.youngs_modulus;
                Self { law, instantaneous, retardation, ..self }
            }
            _ => self,
        }
    }
}

/// What a memory that decays by exp(-q) in a step keeps of itself: at the step's end, and on its mean over the step; and that
/// end's mean over both ends less the mean. No difference of almost equal numbers is left where q is small.
fn kept(q: f64) -> [f64; 3] {
    let (left, mean) = ((-q).exp(), -(-q).exp_m1() / q);
    let bent = match q < 0.01 {
        true => q * q * (1.0 / 12.0 - q / 24.0 + q * q / 80.0 - q * q * q / 360.0),
        false => 0.5 * (1.0 + left) - mean,
    };
    [left, mean, bent]
}

impl StaticLaw for RelaxingHertz {
    fn force(&self, delta: f64, in_contact: bool) -> f64 {
        self.relaxed.force(delta, in_contact)
    }

    fn stiffness(&self, delta: f64, in_contact: bool) -> f64 {
        self.instantaneous.stiffness(delta, in_contact)
    }

    fn energy(&self, delta: f64, in_contact: bool) -> f64 {
        self.relaxed.energy(delta, in_contact)
    }

    fn contact_radius(&self, delta: f64, in_contact: bool) -> f64 {
        self.relaxed.contact_radius(delta, in_contact)
    }

    fn elastic_force(&self, depth: f64) -> f64 {
        self.instantaneous.elastic_force(depth)
    }

    fn collision_depth(&self, speed: f64, inverse_mass: f64) -> f64 {
        self.instantaneous.collision_depth(speed, inverse_mass)
    }

    fn constants(&self, units: KernelUnits) -> Vec<f64> {
        let q = units.step / self.retardation;
        let rest = self.relaxed.prefactor / self.instantaneous.prefactor;
        let [left, mean, bent] = kept(q);
        // A source gives what the memory loses, over the share of the modulus that does not relax.
        let gain = -(-q).exp_m1() / rest;
        let mean_gain = (0.5 * -(-q).exp_m1() + bent) / rest;
        let stiffness = self.instantaneous.scaled(units);
        vec![stiffness, 1.0 - rest, left, mean, gain, mean_gain, bent / rest, -bent / (rest * q)]
    }

    fn recovery(&self) -> f64 {
        1.0 / self.retardation
    }

    fn forces(&self, passed: &Passed) -> (f64, f64) {
        passed.forces
    }
}

//! A standard linear solid under Hertz's law.

use super::static_law::Shares;
use super::{Compact, ForceSum, Hertz, KernelUnits, Passed, StaticLaw, modulus_of};
use crate::scene::Params;

/// A sample of two springs, one of which yields by a dashpot: at once it has one modulus, after a while another.
///
/// The static force is that of the relaxed modulus. Slopes, and whatever else is asked for a collision, are those of the
/// modulus at once. docs/method.md derives the two numbers that the sample remembers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Relaxing<B> {
    /// The whole force of the relaxed sample, and its contact.
    base: B,
    relaxed: Hertz,
    instantaneous: Hertz,
    /// s
    retardation: f64,
}

pub(super) type RelaxingHertz = Relaxing<Hertz>;
pub(super) type RelaxingSum = Relaxing<ForceSum>;

impl<B: for<'a> From<&'a Compact>> From<&Compact> for Relaxing<B> {
    fn from(of: &Compact) -> Self {
        Self {
            base: of.into(),
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
                Self { law, instantaneous, retardation, terms: self.with_attraction(), ..self }
            }
            _ => self,
        }
    }
}

/// What a memory that decays by exp(-q) in a step keeps of itself: at the step's end, and on its mean over the step; and that
/// end's mean over both ends less the mean. No difference of almost equal numbers is left where q is small.
pub(super) fn kept(q: f64) -> [f64; 3] {
    let (left, mean) = ((-q).exp(), -(-q).exp_m1() / q);
    let bent = match q < 0.01 {
        true => q * q * (1.0 / 12.0 - q / 24.0 + q * q / 80.0 - q * q * q / 360.0),
        false => 0.5 * (1.0 + left) - mean,
    };
    [left, mean, bent]
}

impl<B: StaticLaw> StaticLaw for Relaxing<B> {
    fn force(&self, delta: f64, in_contact: bool) -> f64 {
        self.base.force(delta, in_contact)
    }

    fn stiffness(&self, delta: f64, in_contact: bool) -> f64 {
        let beside = self.base.stiffness(delta, in_contact) - self.relaxed.stiffness(delta, in_contact);
        self.instantaneous.stiffness(delta, in_contact) + beside
    }

    fn energy(&self, delta: f64, in_contact: bool) -> f64 {
        self.base.energy(delta, in_contact)
    }

    fn contact_radius(&self, delta: f64, in_contact: bool) -> f64 {
        self.base.contact_radius(delta, in_contact)
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
        let own = [stiffness, 1.0 - rest, left, mean, gain, mean_gain, bent / rest, -bent / (rest * q)];
        [&own, &self.base.term_constants(units)[..]].concat()
    }

    fn recovery(&self) -> f64 {
        1.0 / self.retardation
    }

    /// What was followed, and outside contact what acts there.
    fn forces(&self, passed: &Passed) -> (f64, f64) {
        let (least, most) = passed.forces;
        let outside = Passed { deepest: passed.deepest.min(0.0), ..*passed };
        match passed.highest < 0.0 {
            true => {
                let beside = self.base.forces(&outside);
                (least.min(beside.0), most.max(beside.1))
            }
            false => (least, most),
        }
    }

    fn zero_force(&self) -> f64 {
        self.base.zero_force()
    }

    fn pull_off(&self) -> f64 {
        self.base.pull_off()
    }

    fn attraction_slope(&self) -> f64 {
        self.base.attraction_slope()
    }

    fn outside(&self, deepest: f64, shares: Shares) -> Vec<f64> {
        self.base.outside(deepest, shares)
    }
}

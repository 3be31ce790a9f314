//! A Kelvin-Voigt sample under Hertz's and DMT's laws.

use super::static_law::Shares;
use super::{Compact, Contact, Dmt, ForceSum, Hertz, KernelUnits, Passed, StaticLaw};

/// The law `B` of a sample that also resists the rate of indentation `v`, with retardation time `tau` = viscosity / modulus.
///
/// Ting (1966) follows a linear viscoelastic half-space: `K sqrt(R) (delta^1.5 + 1.5 tau sqrt(delta) v)` while the tip moves
/// in, and `K sqrt(R) (delta + tau v)^1.5` while it moves out, until `delta + tau v` is 0: the sample lets go before it has
/// recovered. The *ad hoc* form of the literature keeps the first expression both ways, and so pulls at the end. DMT's
/// attraction acts beside either as if there were no viscosity. At rest both are the elastic law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Viscous<B> {
    base: B,
    hertz: Hertz,
    /// s
    retardation: f64,
    ad_hoc: bool,
}

pub(super) type ViscousHertz = Viscous<Hertz>;
pub(super) type ViscousDmt = Viscous<Dmt>;
pub(super) type ViscousSum = Viscous<ForceSum>;

impl Contact {
    /// Time by which a viscous sample's force runs ahead of its elastic part, s. A sample that relaxes has its stiffness at
    /// once, so it is 0 there.
    pub fn viscous_time(&self) -> f64 {
        if self.law.has_memory() { 0.0 } else { self.retardation }
    }

    /// Modulus of the stiffness in contact (N/m) of a motion that changes at `rate` (1/s).
    pub fn stiffness_at(&self, delta: f64, rate: f64) -> f64 {
        self.stiffness(delta, true).abs() * (1.0 + rate * self.viscous_time())
    }
}

impl<B: for<'a> From<&'a Compact>> From<&Compact> for Viscous<B> {
    fn from(of: &Compact) -> Self {
        Self { base: of.into(), hertz: of.into(), retardation: of.retardation, ad_hoc: of.ad_hoc }
    }
}

impl<B: StaticLaw> StaticLaw for Viscous<B> {
    fn force(&self, delta: f64, in_contact: bool) -> f64 {
        self.base.force(delta, in_contact)
    }

    fn force_moving(&self, delta: f64, rate: f64, in_contact: bool) -> f64 {
        let along = self.retardation * rate;
        let elastic = self.hertz.force(delta, true);
        let moving = match rate < 0.0 && !self.ad_hoc {
            true => self.hertz.force(delta + along, true),
            false => elastic + self.hertz.stiffness(delta, true) * along,
        };
        self.base.force(delta, in_contact) + (moving - elastic)
    }

    fn stiffness(&self, delta: f64, in_contact: bool) -> f64 {
        self.base.stiffness(delta, in_contact)
    }

    fn energy(&self, delta: f64, in_contact: bool) -> f64 {
        self.base.energy(delta, in_contact)
    }

    fn contact_radius(&self, delta: f64, in_contact: bool) -> f64 {
        self.base.contact_radius(delta, in_contact)
    }

    fn elastic_force(&self, depth: f64) -> f64 {
        self.base.elastic_force(depth)
    }

    fn collision_depth(&self, speed: f64, inverse_mass: f64) -> f64 {
        self.base.collision_depth(speed, inverse_mass)
    }

    fn constants(&self, units: KernelUnits) -> Vec<f64> {
        let own = [self.retardation / units.step, f64::from(u8::from(self.ad_hoc))];
        let stiffness = self.hertz.scaled(units);
        [&[stiffness][..], &own, &self.base.tail_constants(units), &self.base.term_constants(units)].concat()
    }

    fn forces(&self, passed: &Passed) -> (f64, f64) {
        // Where the tip turns its force is the elastic one.
        let (least, most) = self.base.forces(passed);
        // Ting's contact does not pull: a tip that leaves it meets the least force of the adhesion.
        let pulls = self.ad_hoc || passed.highest > 0.0;
        (if pulls { least.min(passed.forces.0) } else { least }, most.max(passed.forces.1))
    }

    fn release(&self) -> f64 {
        self.base.release()
    }

    fn zero_force(&self) -> f64 {
        self.base.zero_force()
    }

    fn pull_off(&self) -> f64 {
        self.base.pull_off()
    }

    fn next_contact(&self, delta: f64, was_in_contact: bool) -> bool {
        self.base.next_contact(delta, was_in_contact)
    }

    fn attraction_slope(&self) -> f64 {
        self.base.attraction_slope()
    }

    fn depth_by_adhesion(&self) -> f64 {
        self.base.depth_by_adhesion()
    }

    fn outside(&self, deepest: f64, shares: Shares) -> Vec<f64> {
        self.base.outside(deepest, shares)
    }

    fn crowding(&self) -> i32 {
        self.base.crowding()
    }
}

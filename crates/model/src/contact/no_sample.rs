//! No sample.

use super::{Compact, Hertz, KernelUnits, StaticLaw};

/// No force at all. It knows the contact that is left out, so that errors have a scale.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Nothing {
    left_out: Hertz,
}

impl From<&Compact> for Nothing {
    fn from(of: &Compact) -> Self {
        Self { left_out: of.into() }
    }
}

impl StaticLaw for Nothing {
    fn force(&self, _: f64, _: bool) -> f64 {
        0.0
    }
    fn stiffness(&self, _: f64, _: bool) -> f64 {
        0.0
    }
    fn energy(&self, _: f64, _: bool) -> f64 {
        0.0
    }
    fn contact_radius(&self, _: f64, _: bool) -> f64 {
        0.0
    }
    fn elastic_force(&self, depth: f64) -> f64 {
        self.left_out.elastic_force(depth)
    }
    fn collision_depth(&self, speed: f64, inverse_mass: f64) -> f64 {
        self.left_out.collision_depth(speed, inverse_mass)
    }
    fn constants(&self, _: KernelUnits) -> Vec<f64> {
        Vec::new()
    }
}

//! No sample.

use super::{KernelUnits, Material, StaticLaw};

/// No force at all.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Nothing;

impl From<&Material> for Nothing {
    fn from(_: &Material) -> Self {
        Self
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
    fn constants(&self, _: KernelUnits) -> Vec<f64> {
        Vec::new()
    }
}

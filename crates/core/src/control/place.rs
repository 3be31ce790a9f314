//! A periodic state as plain numbers.

use crate::periodic::Spectrum;
use crate::plan::{BasisRule, Plan, Station};
use crate::steady::{Linear, PeriodicState};

/// A periodic state without the slope of its map.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    pub station: Station,
    pub spectrum: Spectrum,
    pub steps: u32,
    pub rule: BasisRule,
}

impl Place {
    pub(super) fn of(state: &PeriodicState) -> Self {
        let PeriodicState { station, spectrum, steps, ref kept, .. } = *state;
        Self { station, spectrum, steps, rule: kept.rule }
    }

    /// As the state of an instance.
    pub(super) fn state(self, plan: &Plan, instance: u32) -> Box<PeriodicState> {
        let Self { station, spectrum, steps, rule } = self;
        let kept = plan.basis_by(instance, rule);
        Box::new(PeriodicState { station, spectrum, steps, kept, linear: Linear::Unknown })
    }
}

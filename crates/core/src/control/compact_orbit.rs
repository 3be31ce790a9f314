//! A periodic state as plain numbers.

use crate::kernel::MODES_MAX;
use crate::orbit::{Jacobian, PeriodicState};
use crate::periodic::Floquet;
use crate::plan::{BasisRule, Plan, SectionState};

/// A periodic state without the Jacobian of its period map. As there are very many, only moving modes are stored.
#[derive(Clone, Debug)]
pub struct CompactOrbit {
    /// Travels up to the last moving mode, then rates; see [`SectionState`].
    numbers: Box<[f64]>,
    touching: bool,
    finite: bool,
    pub floquet: Floquet,
    pub steps: u32,
    pub rule: BasisRule,
}

impl CompactOrbit {
    /// Packs a state with this section state.
    pub fn new(station: &SectionState, spectrum: Floquet, steps: u32, rule: BasisRule) -> Self {
        let SectionState { x, u, touching, finite } = station;
        let moves = |mode: &usize| x[*mode].to_bits() | u[*mode].to_bits() != 0;
        let modes = (0..MODES_MAX).rev().find(moves).map_or(0, |last| last + 1);
        let numbers = x[..modes].iter().chain(&u[..modes]).copied().collect();
        Self { numbers, touching: *touching, finite: *finite, floquet: spectrum, steps, rule }
    }

    pub(super) fn of(state: &PeriodicState) -> Self {
        Self::new(&state.section, state.floquet, state.steps, state.basis.rule)
    }

    /// The section state.
    pub fn station(&self) -> SectionState {
        let (x, u) = self.numbers();
        let mut station = SectionState { touching: self.touching, finite: self.finite, ..SectionState::FREE };
        station.x[..x.len()].copy_from_slice(x);
        station.u[..u.len()].copy_from_slice(u);
        station
    }

    /// Travels and rates. Modes beyond them are at rest.
    pub fn numbers(&self) -> (&[f64], &[f64]) {
        self.numbers.split_at(self.numbers.len() / 2)
    }

    /// Whether the tip touches, and whether all numbers are finite.
    pub fn marks(&self) -> [bool; 2] {
        [self.touching, self.finite]
    }

    /// The state as that of an instance of the plan.
    pub(super) fn state(&self, plan: &Plan, instance: u32) -> Box<PeriodicState> {
        let kept = plan.basis_by(instance, self.rule);
        let (spectrum, steps) = (self.floquet, self.steps);
        Box::new(PeriodicState {
            section: self.station(),
            floquet: spectrum,
            steps,
            basis: kept,
            jacobian: Jacobian::Unknown,
            gap_slope: None,
        })
    }
}

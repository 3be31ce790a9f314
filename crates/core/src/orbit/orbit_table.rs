//! Compact periodic states of very many instances: each holds only its own modes and no Jacobian.

use super::{Jacobian, PeriodicState};
use crate::kernel::MODES_MAX;
use crate::periodic::Floquet;
use crate::plan::{ReducedBasis, SectionState};
use std::collections::HashMap;
use std::sync::Arc;

/// States by instance. See [`PeriodicState`].
#[derive(Clone, Debug, Default)]
pub struct OrbitTable {
    /// By instance: 1 + its index in `kept`, or 0 if no state was found. Empty if none was searched for.
    of: Vec<u32>,
    kept: Vec<OrbitRow>,
    /// For each state: travels of its modes, then rates.
    numbers: Vec<f64>,
    bases: Vec<Arc<ReducedBasis>>,
    /// Index of each basis, by its address.
    known: HashMap<usize, u32>,
}

#[derive(Clone, Copy, Debug)]
struct OrbitRow {
    spectrum: Floquet,
    numbers: RowLayout,
    steps: u32,
    basis: u32,
}

/// A state's first index in `numbers`, its number of modes, and whether it touches and is finite, in one word.
#[derive(Clone, Copy, Debug)]
struct RowLayout(u64);

impl RowLayout {
    fn new(from: usize, modes: usize, touching: bool, finite: bool) -> Self {
        Self((from as u64) << 8 | (modes as u64) << 2 | u64::from(touching) << 1 | u64::from(finite))
    }

    fn from(self) -> usize {
        (self.0 >> 8) as usize
    }

    fn modes(self) -> usize {
        (self.0 >> 2 & 0x3f) as usize
    }

    fn touching(self) -> bool {
        self.0 & 2 != 0
    }

    fn finite(self) -> bool {
        self.0 & 1 != 0
    }
}

// The word has six bits for the number of modes.
const _: () = assert!(MODES_MAX < 64);

impl OrbitTable {
    /// A table of `count` instances without states.
    pub fn none_of(count: usize) -> Self {
        Self { of: vec![0; count], ..Self::default() }
    }

    /// Whether nothing was searched for.
    pub fn is_empty(&self) -> bool {
        self.of.is_empty()
    }

    fn kept(&self, instance: usize) -> Option<&OrbitRow> {
        self.kept.get(self.of.get(instance)?.checked_sub(1)? as usize)
    }

    /// Whether the instance has a state.
    pub fn has(&self, instance: usize) -> bool {
        self.kept(instance).is_some()
    }

    /// The state of an instance.
    pub fn get(&self, instance: usize) -> Option<PeriodicState> {
        let OrbitRow { spectrum, numbers, steps, basis } = *self.kept(instance)?;
        let (from, modes) = (numbers.from(), numbers.modes());
        let mut station =
            SectionState { touching: numbers.touching(), finite: numbers.finite(), ..SectionState::FREE };
        station.x[..modes].copy_from_slice(&self.numbers[from..][..modes]);
        station.u[..modes].copy_from_slice(&self.numbers[from + modes..][..modes]);
        let kept = Arc::clone(&self.bases[basis as usize]);
        Some(PeriodicState {
            section: station,
            floquet: spectrum,
            steps,
            basis: kept,
            jacobian: Jacobian::Unknown,
            gap_slope: None,
        })
    }

    /// The states of these instances; empty if nothing was searched for.
    pub fn of(&self, instances: &[u32]) -> Vec<Option<PeriodicState>> {
        match self.is_empty() {
            true => Vec::new(),
            false => instances.iter().map(|instance| self.get(*instance as usize)).collect(),
        }
    }

    /// Stores the state of an instance that has none yet.
    pub fn put(&mut self, instance: usize, state: Option<&PeriodicState>) {
        let Some(PeriodicState { section: station, floquet: spectrum, steps, basis: kept, .. }) = state
        else {
            return;
        };
        let basis = *self.known.entry(Arc::as_ptr(kept) as usize).or_insert_with(|| {
            self.bases.push(Arc::clone(kept));
            self.bases.len() as u32 - 1
        });
        let SectionState { x, u, touching, finite } = station;
        let is_any = |mode: &usize| x[*mode].to_bits() | u[*mode].to_bits() != 0;
        let modes = (0..MODES_MAX).rev().find(is_any).map_or(0, |last| last + 1);
        self.kept.push(OrbitRow {
            spectrum: *spectrum,
            numbers: RowLayout::new(self.numbers.len(), modes, *touching, *finite),
            steps: *steps,
            basis,
        });
        self.of[instance] = self.kept.len() as u32;
        self.numbers.extend(x[..modes].iter().chain(&u[..modes]));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_word_holds_what_is_put_in() {
        for (from, modes) in [(0, 0), (1, MODES_MAX), (1 << 50, 7)] {
            for (touching, finite) in [(true, false), (false, true), (true, true)] {
                let word = RowLayout::new(from, modes, touching, finite);
                assert_eq!((word.from(), word.modes()), (from, modes));
                assert_eq!((word.touching(), word.finite()), (touching, finite));
            }
        }
    }
}

//! Periodic states of very many instances: of each only the modes that it has, and not its map's slope.

use super::PeriodicState;
use crate::kernel::MODES_MAX;
use crate::periodic::Spectrum;
use crate::plan::{ReducedBasis, Station};
use std::collections::HashMap;
use std::sync::Arc;

/// States that were found, by instance. See [`PeriodicState`].
#[derive(Clone, Debug, Default)]
pub struct States {
    /// Of each instance one more than its place in `kept`; 0 where no state was found. Empty where none was searched for.
    of: Vec<u32>,
    kept: Vec<Kept>,
    /// Of each state its travels by the modes, then the rates.
    numbers: Vec<f64>,
    bases: Vec<Arc<ReducedBasis>>,
    /// Of each basis, by where it lies in memory, its place among them.
    known: HashMap<usize, u32>,
}

#[derive(Clone, Copy, Debug)]
struct Kept {
    spectrum: Spectrum,
    /// Where its numbers begin.
    from: usize,
    steps: u32,
    basis: u32,
    modes: u8,
    touching: bool,
    finite: bool,
}

impl States {
    /// Of so many instances, none of which was found yet.
    pub fn none_of(count: usize) -> Self {
        Self { of: vec![0; count], ..Self::default() }
    }

    /// Whether nothing was searched for.
    pub fn is_empty(&self) -> bool {
        self.of.is_empty()
    }

    /// How many were found.
    pub fn count(&self) -> usize {
        self.of.iter().filter(|place| **place > 0).count()
    }

    fn kept(&self, instance: usize) -> Option<&Kept> {
        self.kept.get(self.of.get(instance)?.checked_sub(1)? as usize)
    }

    /// Whether an instance's was found.
    pub fn has(&self, instance: usize) -> bool {
        self.kept(instance).is_some()
    }

    /// The modulus of its map's largest multiplier; NaN where none was found, or waiting found it.
    pub fn multiplier(&self, instance: usize) -> f64 {
        self.kept(instance).map_or(f64::NAN, |one| one.spectrum.multiplier)
    }

    /// The state of an instance.
    pub fn get(&self, instance: usize) -> Option<PeriodicState> {
        let Kept { spectrum, from, steps, basis, modes, touching, finite } = *self.kept(instance)?;
        let modes = usize::from(modes);
        let mut station = Station { touching, finite, ..Station::FREE };
        station.x[..modes].copy_from_slice(&self.numbers[from..][..modes]);
        station.u[..modes].copy_from_slice(&self.numbers[from + modes..][..modes]);
        let kept = Arc::clone(&self.bases[basis as usize]);
        Some(PeriodicState { station, spectrum, steps, kept, slope: Box::default() })
    }

    /// The states of these instances; nothing where nothing was searched for.
    pub fn of(&self, instances: &[u32]) -> Vec<Option<PeriodicState>> {
        match self.is_empty() {
            true => Vec::new(),
            false => instances.iter().map(|instance| self.get(*instance as usize)).collect(),
        }
    }

    /// Says what was found of an instance, of which nothing has been said before.
    pub fn put(&mut self, instance: usize, state: Option<&PeriodicState>) {
        let Some(PeriodicState { station, spectrum, steps, kept, .. }) = state else { return };
        let basis = *self.known.entry(Arc::as_ptr(kept) as usize).or_insert_with(|| {
            self.bases.push(Arc::clone(kept));
            self.bases.len() as u32 - 1
        });
        let Station { x, u, touching, finite } = station;
        let is_any = |mode: &usize| x[*mode].to_bits() | u[*mode].to_bits() != 0;
        let modes = (0..MODES_MAX).rev().find(is_any).map_or(0, |last| last + 1);
        self.kept.push(Kept {
            spectrum: *spectrum,
            from: self.numbers.len(),
            steps: *steps,
            basis,
            modes: modes as u8,
            touching: *touching,
            finite: *finite,
        });
        self.of[instance] = self.kept.len() as u32;
        self.numbers.extend(x[..modes].iter().chain(&u[..modes]));
    }

    /// All of them, each with all that it may have.
    pub fn to_vec(&self) -> Vec<Option<Box<PeriodicState>>> {
        (0..self.of.len()).map(|instance| self.get(instance).map(Box::new)).collect()
    }
}

//! A chunk as it is shown to readers of the whole run.

use super::codec::ChunkReader;
use super::instance_flags::InstanceFlags;
use crate::contact::{Compact, Contact};
use crate::observe::{Measured, Observable, Status};
use crate::plan::{Plan, Precision};
use std::sync::OnceLock;

/// The run that a chunk belongs to: the whole plan, the flags of each instance, and the rounding error to add to the
/// estimates, if any.
#[derive(Clone, Copy)]
pub(super) struct RunContext<'a> {
    pub plan: &'a Plan,
    pub marks: &'a [InstanceFlags],
    pub added: &'a [f64],
}

/// A finished chunk of a run, or what is known of an unfinished one.
pub struct ChunkView<'a> {
    run: RunContext<'a>,
    /// Its instances, by their numbers in the run.
    pub instances: &'a [u32],
    pub(super) view: Option<ChunkReader<'a>>,
    /// Contacts of the instances, computed at first use.
    contacts: OnceLock<Vec<Compact>>,
}

impl<'a> ChunkView<'a> {
    pub(super) fn new(run: RunContext<'a>, instances: &'a [u32], view: Option<ChunkReader<'a>>) -> Self {
        Self { run, instances, view, contacts: OnceLock::new() }
    }
}

impl ChunkView<'_> {
    /// The plan of the chunk's instances as they ran.
    pub fn plan(&self) -> Plan {
        let part = self.run.plan.part(self.instances);
        match self.view.as_ref().and_then(ChunkReader::fineness) {
            Some(fineness) => part.with_resolutions(&fineness),
            None => part,
        }
    }

    /// Measurements of an instance, by its number in the chunk.
    pub fn measured(&self, n: usize) -> Measured {
        self.view.as_ref().map_or(Measured::NONE, |view| view.measured(n))
    }

    /// Numbers of an observable: the first component of all instances, then the next.
    pub fn observed(&self, observable: Observable) -> Vec<f64> {
        let all = || observable.places();
        match &self.view {
            Some(view) => all().flat_map(|place| view.floats(place)).collect(),
            None => vec![f64::NAN; all().len() * self.instances.len()],
        }
    }

    /// Status of an instance.
    pub fn status(&self, n: usize) -> Status {
        self.run.marks[self.instances[n] as usize].status()
    }

    /// An instance's contact.
    pub fn contact(&self, n: usize) -> Contact {
        self.compact(n).contact()
    }

    /// An instance's contact without the constants of its law.
    pub fn compact(&self, n: usize) -> Compact {
        self.contacts.get_or_init(|| self.run.plan.contacts_of(self.instances))[n]
    }

    /// The arithmetic of its last run.
    pub fn precision(&self, n: usize) -> Precision {
        self.run.marks[self.instances[n] as usize].precision()
    }

    /// Estimated errors: see [`RunResult::estimates`](super::RunResult::estimates).
    pub fn estimates(&self) -> Vec<f64> {
        let none = || vec![f64::NAN; self.instances.len()];
        let mut all = self.view.as_ref().map_or_else(none, ChunkReader::estimates);
        all.iter_mut().zip(self.instances).for_each(|(estimate, i)| *estimate += self.added(*i));
        all
    }

    /// Estimated error of one instance.
    pub fn estimate(&self, n: usize) -> f64 {
        self.view.as_ref().map_or(f64::NAN, |view| view.estimate(n)) + self.added(self.instances[n])
    }

    /// Rounding error to add to an instance's estimate.
    fn added(&self, instance: u32) -> f64 {
        self.run.added.get(instance as usize).copied().unwrap_or(0.0)
    }

    /// Periods of an instance's last run.
    pub fn periods(&self, n: usize) -> u32 {
        self.view.as_ref().map_or(0, |view| view.periods(n))
    }

    /// Whether the curve jumped to this instance's state from the point before.
    pub fn jump(&self, n: usize) -> bool {
        self.view.as_ref().is_some_and(|view| view.jump(n))
    }

    /// Steps per period of an instance.
    pub fn steps(&self, n: usize) -> u32 {
        let planned = || self.run.plan.steps(self.instances[n]);
        self.view.as_ref().map_or_else(planned, |view| view.steps(n))
    }

    /// Moduli of the largest multipliers of the period maps. NaN if no state was found, or time integration found it.
    pub fn multipliers(&self) -> Vec<f64> {
        self.view.as_ref().map_or_else(|| vec![f64::NAN; self.instances.len()], ChunkReader::multipliers)
    }
}

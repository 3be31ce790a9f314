//! The instances of a scene: what they are, not how they run.

use crate::contact::{Compact, Contact};
use crate::instrument::{FreeMotion, Instrument};
use crate::scene::{Branch, Held};
use std::f64::consts::TAU;
use std::ops::Index;
use std::sync::Arc;

/// Number of an instance in its ensemble: its place in the scene's order, and in the results file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct InstanceId(pub u32);

/// All instances of a scene. It never changes, and every plan of the scene shares it.
#[derive(Clone, Debug)]
pub struct Ensemble {
    /// Distinct instruments under their drive.
    pub drives: Vec<Arc<Drive>>,
    /// Distinct contacts, or nearly so.
    pub contacts: Vec<Compact>,
    /// In the scene's order.
    pub instances: Vec<Instance>,
    /// Of each instance what it is held at by moving its sample; empty where gaps are given.
    pub setpoints: Vec<SetPoint>,
    /// Where the instances are points of curves, how these lie in their order.
    pub curves: Option<Curves>,
    /// Where the instances are every combination of the values of some axes, how these lie in their order.
    pub grid: Option<Grid>,
}

/// Every combination of the places along some axes; the last one runs fastest.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Grid {
    pub axes: Vec<GridAxis>,
}

impl Grid {
    /// How many instances it has.
    #[expect(clippy::len_without_is_empty, reason = "a grid has an instance at least")]
    pub fn len(&self) -> usize {
        self.axes.iter().map(|axis| axis.length as usize).product()
    }
}

/// An axis of a grid.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct GridAxis {
    /// How far apart instances stand that are next to one another along it.
    pub stride: u32,
    pub length: u32,
    /// Its places by their values, least first; empty where they are no values of one quantity: laws, labels, samples.
    pub order: Vec<u32>,
}

/// Curves of equal length, one after the other; where they are followed both ways, the points of the way back come after
/// those of the way there, in the same order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Curves {
    /// On one way.
    pub points: u32,
    /// 1 or 2.
    pub ways: u32,
}

impl Curves {
    /// Number of the instance's curve, and its place along it in the order in which it is followed.
    pub fn place(&self, id: InstanceId) -> (u32, u32) {
        let long = self.points * self.ways;
        let (curve, within) = (id.0 / long, id.0 % long);
        let back = within >= self.points;
        (curve, if back { long - 1 - (within - self.points) } else { within })
    }
}

/// One instrument at one drive.
#[derive(Clone, Debug)]
pub struct Drive {
    pub instrument: Arc<Instrument>,
    /// Motion without a sample.
    pub free: FreeMotion,
}

/// One instrument over one sample.
#[derive(Clone, Copy, Debug)]
pub struct Instance {
    /// Index into [`Ensemble::drives`].
    pub drive: u32,
    /// Index into [`Ensemble::contacts`].
    pub contact: u32,
    /// m: where it is not given, about where a hard sample would stand.
    pub gap: f64,
}

/// What an instance is held at by moving its sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SetPoint {
    pub held: Held,
    /// The branch that is asked for where both hold it.
    pub branch: Option<Branch>,
}

impl Drive {
    /// Drive frequency, Hz.
    pub fn frequency(&self) -> f64 {
        self.free.omega / TAU
    }

    /// Amplitude of the tip without a sample, m.
    pub fn free_amplitude(&self) -> f64 {
        self.free.tip.norm()
    }
}

impl Ensemble {
    /// The contact of an instance.
    pub fn contact(&self, id: InstanceId) -> Contact {
        self.contacts[self[id].contact as usize].contact()
    }
}

impl Index<InstanceId> for Ensemble {
    type Output = Instance;

    fn index(&self, id: InstanceId) -> &Instance {
        &self.instances[id.0 as usize]
    }
}

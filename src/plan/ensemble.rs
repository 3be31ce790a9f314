//! The instances of a scene: what they are, not how they run.

use crate::contact::Contact;
use crate::instrument::{FreeMotion, Instrument};
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
    /// In the scene's order.
    pub instances: Vec<Instance>,
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
    pub contact: Contact,
    /// m
    pub gap: f64,
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

impl Index<InstanceId> for Ensemble {
    type Output = Instance;

    fn index(&self, id: InstanceId) -> &Instance {
        &self.instances[id.0 as usize]
    }
}

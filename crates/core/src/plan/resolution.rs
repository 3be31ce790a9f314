//! The instances of a plan, and the resolution of each.

use super::InstanceId;
use super::interning::Interned;

/// Instances of an ensemble.
#[derive(Clone, Debug)]
pub(super) enum Ids {
    /// All, up to this count.
    All(u32),
    Some(Vec<InstanceId>),
}

impl Ids {
    pub fn len(&self) -> usize {
        match self {
            Self::All(count) => *count as usize,
            Self::Some(ids) => ids.len(),
        }
    }

    pub fn get(&self, instance: u32) -> InstanceId {
        match self {
            Self::All(_) => InstanceId(instance),
            Self::Some(ids) => ids[instance as usize],
        }
    }
}

/// Resolution of an instance, and its gap.
#[derive(Clone, Copy, Debug)]
pub(super) struct InstanceResolution {
    /// m: the instance's own, or that of its set-point; NaN if no gap holds it.
    pub gap: f64,
    /// Index into [`Plan::drives`](super::Plan::drives).
    pub drive: u32,
    /// Steps per drive period; 0 if the free motion is the answer and nothing needs stepping.
    pub steps: u32,
}

/// The resolutions of a plan's instances.
#[derive(Clone, Debug)]
pub(super) struct InstanceResolutions {
    /// Drives and steps of very many instances with the ensemble's gaps.
    coded: Option<Interned<(u32, u32)>>,
    each: Vec<InstanceResolution>,
}

impl InstanceResolutions {
    /// Those of all instances of an ensemble.
    pub fn coded(all: Interned<(u32, u32)>) -> Self {
        Self { coded: Some(all), each: Vec::new() }
    }

    pub fn of(each: Vec<InstanceResolution>) -> Self {
        Self { coded: None, each }
    }

    #[inline]
    pub fn get(&self, at: usize, gap: impl FnOnce() -> f64) -> InstanceResolution {
        match &self.coded {
            Some(all) => {
                let (drive, steps) = all.get(at);
                InstanceResolution { gap: gap(), drive, steps }
            }
            None => self.each[at],
        }
    }

    #[inline]
    pub fn steps(&self, at: usize) -> u32 {
        self.coded.as_ref().map_or_else(|| self.each[at].steps, |all| all.get(at).1)
    }

    #[inline]
    pub fn drive(&self, at: usize) -> u32 {
        self.coded.as_ref().map_or_else(|| self.each[at].drive, |all| all.get(at).0)
    }

    /// Replaces an instance's drive and steps.
    pub fn set(&mut self, at: usize, (drive, steps): (u32, u32)) {
        match &mut self.coded {
            Some(all) => all.set(at, (drive, steps)),
            None => (self.each[at].drive, self.each[at].steps) = (drive, steps),
        }
    }

    /// All of them, for changes; `gap` gives the ensemble's gaps.
    pub fn each(&mut self, gap: impl Fn(usize) -> f64) -> &mut Vec<InstanceResolution> {
        if let Some(coded) = self.coded.take() {
            let one = |at: usize| {
                let (drive, steps) = coded.get(at);
                InstanceResolution { gap: gap(at), drive, steps }
            };
            self.each = (0..coded.len()).map(one).collect();
        }
        &mut self.each
    }
}

//! Instances of one shape, which run in lockstep.

use super::Plan;
use crate::contact::Law;
use rayon::prelude::*;

/// Instances of a plan that run in lockstep.
#[derive(Clone, Debug, PartialEq)]
pub struct Class {
    pub law: Law,
    pub modes: usize,
    pub steps: u32,
    /// Instances of the plan, ordered so that neighbours touch the sample at about the same time.
    pub instances: Vec<u32>,
}

impl Plan {
    /// The plan's instances by shape: law, number of modes, number of steps; within a class by drive, then gap, then
    /// stiffness.
    pub fn classes(&self) -> Vec<Class> {
        let mut all: Vec<Placed> = self.instances().map(|index| Placed::new(index, self)).collect();
        // In place: a stable sort would hold them twice.
        all.par_sort_unstable_by(|a, b| {
            let order = a.shape().cmp(&b.shape()).then(a.drive.cmp(&b.drive));
            let order = order.then(a.gap.total_cmp(&b.gap)).then(a.stiffness.total_cmp(&b.stiffness));
            order.then(a.index.cmp(&b.index))
        });
        all.chunk_by(|a, b| a.shape() == b.shape())
            .map(|class| {
                let (steps, law, modes) = class[0].shape();
                Class { law, modes, steps, instances: class.iter().map(|one| one.index).collect() }
            })
            .collect()
    }

    /// All instances in the order of their classes: neighbours are alike.
    pub fn by_class(&self) -> Vec<u32> {
        self.classes().into_iter().flat_map(|class| class.instances).collect()
    }
}

/// At this depth (m) contacts are ordered by their stiffness.
const NANOMETRE: f64 = 1e-9;

/// What decides an instance's place in the classes.
struct Placed {
    index: u32,
    steps: u32,
    law: Law,
    modes: usize,
    drive: u32,
    gap: f64,
    stiffness: f64,
}

impl Placed {
    fn new(index: u32, plan: &Plan) -> Self {
        let case = plan.case(index);
        Self {
            index,
            steps: case.steps,
            law: case.contact.law,
            modes: plan.driven(index).kept.modes.len(),
            drive: case.drive,
            gap: case.gap,
            stiffness: case.contact.law().elastic_force(NANOMETRE),
        }
    }

    fn shape(&self) -> (u32, Law, usize) {
        (self.steps, self.law, self.modes)
    }
}

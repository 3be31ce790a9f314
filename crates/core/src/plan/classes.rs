//! Classes: instances of one shape, which run in lockstep.

use super::{Plan, Precision};
use crate::contact::Law;
use crate::kernel::{Entry, ShaderSpec};
use crate::observe::Wants;
use crate::scene::Start;
use rayon::prelude::*;
use std::collections::{BTreeMap, HashMap};

/// Instances of a plan that run in lockstep.
#[derive(Clone, Debug, PartialEq)]
pub struct Class {
    pub law: Law,
    /// Modes of the kernel: [`Plan::pairs`].
    pub modes: usize,
    pub steps: u32,
    /// Instances of the plan, ordered so that neighbours touch the sample at about the same time.
    pub instances: Vec<u32>,
}

/// What the instances of a class share: steps, law and number of modes.
pub type Shape = (u32, Law, usize);

impl Plan {
    /// An instance's shape.
    pub fn shape(&self, instance: u32) -> Shape {
        (self.steps(instance), self.law(instance), self.pairs(instance))
    }

    /// The shader of a class for this entry point; for a run, that of its measured part.
    pub fn shader(&self, class: &Class, entry: Entry) -> ShaderSpec {
        let runs = matches!(entry, Entry::Sweep | Entry::Stride);
        ShaderSpec {
            entry,
            law: class.law,
            modes: class.modes,
            wants: if runs { self.wants } else { Wants::FUNDAMENTAL },
            measured: runs,
            decay: entry == Entry::Sweep && self.run.start == Start::Rest,
            double: self.precision == Precision::F64,
            one_drive: false,
        }
    }

    /// The plan's instances by shape (steps, law, number of modes); within a class by drive, then gap, then stiffness.
    pub fn classes(&self) -> Vec<Class> {
        let (shapes, order) = self.ordered();
        let shape = |key: &Key| shapes[key.shape()].0;
        let all = order.chunk_by(|a, b| shape(a) == shape(b));
        all.map(|class| {
            let (steps, law, modes) = shape(&class[0]);
            Class { law, modes, steps, instances: class.iter().map(|key| key.instance()).collect() }
        })
        .collect()
    }

    /// All instances in the order of their classes, so that neighbours are similar.
    pub fn by_class(&self) -> Vec<u32> {
        self.ordered().1.iter().map(|key| key.instance()).collect()
    }

    /// Number of instances of each shape.
    pub(super) fn shapes(&self) -> BTreeMap<Shape, usize> {
        let mut counts = BTreeMap::new();
        self.each_shape(&mut |_, (shape, _)| *counts.entry(shape).or_default() += 1);
        counts
    }

    /// Calls `tell` with the shape and drive of each instance.
    fn each_shape(&self, tell: &mut dyn FnMut(u32, (Shape, u32))) {
        let mut of = |from: u32, part: &Self| {
            for i in part.instances() {
                tell(from + i, (part.shape(i), self.resolution.drive((from + i) as usize)));
            }
        };
        match self.at_hand() {
            true => of(0, self),
            false => self.stretches().for_each(|(from, part)| of(from, &part)),
        }
    }

    /// The distinct shapes and drives, and the instances in their order.
    fn ordered(&self) -> (Vec<(Shape, u32)>, Vec<Key>) {
        let (mut numbers, mut shapes) = (HashMap::new(), Vec::new());
        let mut order: Vec<Key> = Vec::with_capacity(self.len());
        self.each_shape(&mut |i, one| {
            let number = *numbers.entry(one).or_insert_with(|| {
                shapes.push(one);
                shapes.len() as u32 - 1
            });
            order.push(Key::new(number, self.resolution(i).gap, i));
        });
        let mut ranks: Vec<u32> = (0..shapes.len() as u32).collect();
        ranks.sort_unstable_by_key(|number| shapes[*number as usize]);
        let mut rank_of = vec![0; shapes.len()];
        ranks.iter().enumerate().for_each(|(rank, number)| rank_of[*number as usize] = rank as u32);
        order.par_iter_mut().for_each(|key| key.rename(rank_of[key.shape()]));
        shapes.sort_unstable();
        // In place: a stable sort would hold the keys twice.
        order.par_sort_unstable();
        order.par_chunk_by_mut(|a, b| a.same_place(b)).filter(|same| same.len() > 1).for_each(|same| {
            let mut all: Vec<(f64, Key)> =
                same.iter().map(|key| (self.stiffness(key.instance()), *key)).collect();
            all.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            same.iter_mut().zip(all).for_each(|(place, (_, key))| *place = key);
        });
        (shapes, order)
    }

    fn stiffness(&self, instance: u32) -> f64 {
        self.contact(instance).law().elastic_force(NANOMETRE)
    }
}

/// Indentation (m) at which the stiffness of contacts is compared.
const NANOMETRE: f64 = 1e-9;

/// The sort key of an instance: number of its shape and drive, gap, and own number, in one integer.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Key(u128);

impl Key {
    fn new(shape: u32, gap: f64, instance: u32) -> Self {
        // These bits sort as the numbers do.
        let bits = gap.to_bits();
        let ordered = if bits >> 63 == 1 { !bits } else { bits | 1 << 63 };
        Self(u128::from(shape) << 96 | u128::from(ordered) << 32 | u128::from(instance))
    }

    fn shape(&self) -> usize {
        (self.0 >> 96) as usize
    }

    fn rename(&mut self, shape: u32) {
        self.0 = self.0 << 32 >> 32 | u128::from(shape) << 96;
    }

    fn instance(&self) -> u32 {
        self.0 as u32
    }

    /// Whether two have the same shape, drive and gap.
    fn same_place(&self, other: &Self) -> bool {
        self.0 >> 32 == other.0 >> 32
    }
}

//! Solved instances of a sweep, and what they say of the ones between them.

use super::order::Order;
use super::solved::{Solved, Weighted};
use crate::steady::{Hint, Lead, Neighbour, Node, PeriodicState};
use rayon::prelude::*;

/// Of some instances what others rest on.
pub(super) struct Around<'a> {
    /// By instance of the whole plan.
    solved: &'a [Solved],
    /// By instance of the portion.
    lines: Vec<Vec<Weighted>>,
    /// Whether they lie around it, not along a line.
    scattered: bool,
}

impl<'a> Around<'a> {
    /// For these instances of a level of the block.
    pub fn new((order, level): (&Order, usize), instances: &[u32], solved: &'a [Solved]) -> Self {
        let lines = instances.par_iter().map(|i| order.ground(level, *i, solved)).collect();
        Self { solved, lines, scattered: order.scattered() }
    }

    /// For the first run of each of these instances of the portion: where its neighbours' first runs lead to.
    pub fn first(&self, instances: &[u32]) -> Vec<Lead<'a>> {
        let of = |i: &u32| {
            let hint = |weighted: &Weighted, [first, _]: &'a [Node; 2]| neighbour(weighted, first, None);
            match self.line(*i, hint) {
                Some(neighbours) => Lead::Hint(Hint { neighbours, own: None, scattered: self.scattered }),
                None if self.in_vain(*i) => Lead::Vain,
                None => Lead::None,
            }
        };
        instances.iter().map(of).collect()
    }

    /// For the second run: from the instance's own state in the first, by how far the two are apart at its neighbours.
    pub fn second(&self, found: &[Option<&'a PeriodicState>]) -> Vec<Lead<'a>> {
        let of = |(i, own): (usize, &Option<&'a PeriodicState>)| {
            let Some(own) = *own else {
                return if self.in_vain(i as u32) { Lead::Vain } else { Lead::None };
            };
            let hint = |weighted: &Weighted, [first, second]: &'a [Node; 2]| {
                neighbour(weighted, second, Some(first))
            };
            match self.line(i as u32, hint) {
                Some(neighbours) => {
                    Lead::Hint(Hint { own: Some(own), neighbours, scattered: self.scattered })
                }
                None => Lead::None,
            }
        };
        found.iter().enumerate().map(of).collect()
    }

    /// Whether both of the nearest two were searched for in vain.
    fn in_vain(&self, i: u32) -> bool {
        let mut nearest = self.lines[i as usize].iter().filter(|one| one.2 != 0.0);
        nearest.all(|one| matches!(self.solved[one.0 as usize], Solved::Vain))
    }

    /// The neighbours of an instance; where one of the farther ones is not known, the nearest two. None where one of these
    /// is not.
    fn line<T>(&self, i: u32, hint: impl Fn(&Weighted, &'a [Node; 2]) -> T) -> Option<Vec<T>> {
        let line = &self.lines[i as usize];
        let node = |weighted: &Weighted| match &self.solved[weighted.0 as usize] {
            Solved::States(both) => Some(&**both),
            Solved::Unknown | Solved::Vain => None,
        };
        let all = |line: &[Weighted]| -> Option<Vec<T>> {
            line.iter().map(|one| Some(hint(one, node(one)?))).collect()
        };
        let nearest = || -> Vec<Weighted> {
            line.iter().filter(|one| one.2 != 0.0).map(|(i, _, nearest)| (*i, *nearest, *nearest)).collect()
        };
        all(line).or_else(|| all(&nearest()))
    }
}

fn neighbour<'a>((_, weight, nearest): &Weighted, node: &'a Node, before: Option<&'a Node>) -> Neighbour<'a> {
    Neighbour { node, before, weight: *weight, nearest: *nearest }
}

//! Solved instances of a sweep, and what they say of the ones between them.

use super::order::Order;
use super::solved::{Solved, Weighted};
use crate::steady::{Hint, Lead, Neighbour, Node, Patience, PeriodicState};
use rayon::prelude::*;

/// Of some instances of a block what their searches may begin at.
pub(super) struct Around<'a> {
    /// By instance of the whole block.
    solved: &'a [Solved],
    ground: Ground,
}

/// What instances rest on, by their number in the portion.
enum Ground {
    /// Nothing: these are searched for.
    Scouts,
    /// Solved ones on a line, or around them.
    Lines { lines: Vec<Vec<Weighted>>, scattered: bool },
    /// Any of those next to them.
    Each(Vec<Vec<u32>>),
    /// Nothing else has led to them: they are waited for.
    Wait,
}

impl<'a> Around<'a> {
    /// For instances that are searched for.
    pub fn scouts(solved: &'a [Solved]) -> Self {
        Self { solved, ground: Ground::Scouts }
    }

    /// For these instances of a level of the block.
    pub fn level((order, level): (&Order, usize), instances: &[u32], solved: &'a [Solved]) -> Self {
        let lines = instances.par_iter().map(|i| order.ground(level, *i, solved)).collect();
        Self { solved, ground: Ground::Lines { lines, scattered: order.scattered() } }
    }

    /// For instances that no search has found.
    pub fn each(order: &Order, instances: &[u32], solved: &'a [Solved]) -> Self {
        let beside = instances.par_iter().map(|i| order.beside(*i)).collect();
        Self { solved, ground: Ground::Each(beside) }
    }

    /// For instances that nothing else has led to.
    pub fn waited_for(solved: &'a [Solved]) -> Self {
        Self { solved, ground: Ground::Wait }
    }

    /// What becomes of those that are not found, in the first run and in the second. Much begins at scouts: for these searches are
    /// repeated. Nothing is waited for before all else is known.
    pub fn patience(&self) -> [Patience; 2] {
        match self.ground {
            Ground::Scouts => [Patience::Later; 2],
            Ground::Lines { .. } | Ground::Each(_) => [Patience::One; 2],
            Ground::Wait => [Patience::One, Patience::Waits],
        }
    }

    /// Whether all that is found begins at neighbours.
    pub fn leads_all(&self) -> bool {
        matches!(self.ground, Ground::Each(_))
    }

    /// For the first run of each of these instances of the portion: where its neighbours' first runs lead to.
    pub fn first(&self, instances: &[u32]) -> Vec<Lead<'a>> {
        let hint = |weighted: &Weighted, [first, _]: &'a [Node; 2]| neighbour(weighted, first, None);
        let of = |i: &u32| match &self.ground {
            Ground::Scouts => Lead::None,
            Ground::Lines { lines, scattered } => self.lead(&lines[*i as usize], None, *scattered, hint),
            Ground::Each(beside) => Lead::each(self.known(&beside[*i as usize]).map(|[first, _]| first)),
            Ground::Wait => Lead::Vain,
        };
        instances.iter().map(of).collect()
    }

    /// For the second run: from the instance's own state in the first, by how far the two are apart at its neighbours.
    pub fn second(&self, found: &[Option<&'a PeriodicState>]) -> Vec<Lead<'a>> {
        let hint =
            |weighted: &Weighted, [first, second]: &'a [Node; 2]| neighbour(weighted, second, Some(first));
        let of = |(i, own): (usize, &Option<&'a PeriodicState>)| match (&self.ground, *own) {
            (_, None) => Lead::Vain,
            (Ground::Lines { lines, scattered }, own) => self.lead(&lines[i], own, *scattered, hint),
            // Next to its own state.
            (Ground::Scouts | Ground::Each(_) | Ground::Wait, Some(_)) => Lead::None,
        };
        found.iter().enumerate().map(of).collect()
    }

    /// Where a line leads to.
    fn lead(
        &self,
        line: &[Weighted],
        own: Option<&'a PeriodicState>,
        scattered: bool,
        hint: impl Fn(&Weighted, &'a [Node; 2]) -> Neighbour<'a>,
    ) -> Lead<'a> {
        match self.line(line, hint) {
            Some(neighbours) => Hint { neighbours, own, scattered }.into(),
            None if self.in_vain(line) => Lead::Vain,
            None => Lead::None,
        }
    }

    /// Whether all of the nearest on a line were searched for in vain: then its own search would be, too, before all else
    /// that may lead to it is known.
    fn in_vain(&self, line: &[Weighted]) -> bool {
        let mut nearest = line.iter().filter(|one| one.2 != 0.0);
        nearest.all(|one| matches!(self.solved[one.0 as usize], Solved::Vain))
    }

    /// The solved ones of these.
    fn known(&self, some: &[u32]) -> impl Iterator<Item = &'a [Node; 2]> {
        let solved = self.solved;
        some.iter().filter_map(move |i| solved[*i as usize].nodes())
    }

    /// The neighbours of a line; where one of the farther ones is not known, the nearest two. None where one of these
    /// is not.
    fn line<T>(&self, line: &[Weighted], hint: impl Fn(&Weighted, &'a [Node; 2]) -> T) -> Option<Vec<T>> {
        let node = |weighted: &Weighted| self.solved[weighted.0 as usize].nodes();
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

//! Solved instances of a sweep, and what they say of the ones between them.

use super::hierarchy::Hierarchy;
use super::orbit_pair::{OrbitPair, WeightedPoint};
use crate::orbit::{OnFailure, PeriodicState, SolvedNeighbour, Stencil, StencilPoint, StencilStart};
use rayon::prelude::*;

/// Of some instances of a block what their searches may begin at.
pub(super) struct Stencils<'a> {
    /// By instance of the whole block.
    solved: &'a [OrbitPair],
    support: Support,
}

/// What instances rest on, by their number in the chunk.
enum Support {
    /// Nothing: these are searched for.
    Coarse,
    /// Solved ones on a line, or around them.
    Lines { lines: Vec<Vec<WeightedPoint>>, scattered: bool },
    /// Any of those next to them.
    Neighbours(Vec<Vec<u32>>),
    /// Nothing else has led to them: they are integrated to steady state.
    Integrate,
}

impl<'a> Stencils<'a> {
    /// For instances that are searched for.
    pub fn coarse(solved: &'a [OrbitPair]) -> Self {
        Self { solved, support: Support::Coarse }
    }

    /// For these instances of a level of the block.
    pub fn level((order, level): (&Hierarchy, usize), instances: &[u32], solved: &'a [OrbitPair]) -> Self {
        let lines = instances.par_iter().map(|i| order.support(level, *i, solved)).collect();
        Self { solved, support: Support::Lines { lines, scattered: order.scattered() } }
    }

    /// For instances that no search has found.
    pub fn each(order: &Hierarchy, instances: &[u32], solved: &'a [OrbitPair]) -> Self {
        let beside = instances.par_iter().map(|i| order.adjacent(*i)).collect();
        Self { solved, support: Support::Neighbours(beside) }
    }

    /// For instances that nothing else has led to.
    pub fn integrated(solved: &'a [OrbitPair]) -> Self {
        Self { solved, support: Support::Integrate }
    }

    /// What becomes of those that are not found, in the first run and in the second. Much begins at coarse points: for these searches are
    /// repeated. Nothing is integrated to steady state before all else is known.
    pub fn on_failure(&self) -> [OnFailure; 2] {
        match self.support {
            Support::Coarse => [OnFailure::RetryLater; 2],
            Support::Lines { .. } | Support::Neighbours(_) => [OnFailure::Skip; 2],
            Support::Integrate => [OnFailure::Skip, OnFailure::Integrate],
        }
    }

    /// Whether all that is found begins at neighbours.
    pub fn all_start_from_neighbours(&self) -> bool {
        matches!(self.support, Support::Neighbours(_))
    }

    /// For the first run of each of these instances of the chunk: where its neighbours' first runs lead to.
    pub fn first_run(&self, instances: &[u32]) -> Vec<StencilStart<'a>> {
        let hint = |weighted: &WeightedPoint, [first, _]: &'a [SolvedNeighbour; 2]| {
            stencil_point(weighted, first, None)
        };
        let of = |i: &u32| match &self.support {
            Support::Coarse => StencilStart::None,
            Support::Lines { lines, scattered } => self.start(&lines[*i as usize], None, *scattered, hint),
            Support::Neighbours(beside) => {
                StencilStart::each(self.solved_points(&beside[*i as usize]).map(|[first, _]| first))
            }
            Support::Integrate => StencilStart::Skip,
        };
        instances.iter().map(of).collect()
    }

    /// For the second run: from the instance's own state in the first, by how far the two are apart at its neighbours.
    pub fn second_run(&self, found: &[Option<&'a PeriodicState>]) -> Vec<StencilStart<'a>> {
        let hint = |weighted: &WeightedPoint, [first, second]: &'a [SolvedNeighbour; 2]| {
            stencil_point(weighted, second, Some(first))
        };
        let of = |(i, own): (usize, &Option<&'a PeriodicState>)| match (&self.support, *own) {
            (_, None) => StencilStart::Skip,
            (Support::Lines { lines, scattered }, own) => self.start(&lines[i], own, *scattered, hint),
            // Next to its own state.
            (Support::Coarse | Support::Neighbours(_) | Support::Integrate, Some(_)) => StencilStart::None,
        };
        found.iter().enumerate().map(of).collect()
    }

    /// Where a line leads to.
    fn start(
        &self,
        stencil: &[WeightedPoint],
        own: Option<&'a PeriodicState>,
        scattered: bool,
        hint: impl Fn(&WeightedPoint, &'a [SolvedNeighbour; 2]) -> StencilPoint<'a>,
    ) -> StencilStart<'a> {
        match self.line(stencil, hint) {
            Some(neighbours) => Stencil { neighbours, own_state: own, scattered }.into(),
            None if self.all_failed(stencil) => StencilStart::Skip,
            None => StencilStart::None,
        }
    }

    /// Whether all of the nearest on a line were searched for in vain: then its own search would be, too, before all else
    /// that may lead to it is known.
    fn all_failed(&self, line: &[WeightedPoint]) -> bool {
        let mut nearest = line.iter().filter(|one| one.2 != 0.0);
        nearest.all(|one| matches!(self.solved[one.0 as usize], OrbitPair::Vain))
    }

    /// The solved ones of these.
    fn solved_points(&self, some: &[u32]) -> impl Iterator<Item = &'a [SolvedNeighbour; 2]> {
        let solved = self.solved;
        some.iter().filter_map(move |i| solved[*i as usize].neighbours())
    }

    /// The neighbours of a line; where one of the farther ones is not known, the nearest two. None where one of these
    /// is not.
    fn line<T>(
        &self,
        line: &[WeightedPoint],
        hint: impl Fn(&WeightedPoint, &'a [SolvedNeighbour; 2]) -> T,
    ) -> Option<Vec<T>> {
        let node = |weighted: &WeightedPoint| self.solved[weighted.0 as usize].neighbours();
        let all = |line: &[WeightedPoint]| -> Option<Vec<T>> {
            line.iter().map(|one| Some(hint(one, node(one)?))).collect()
        };
        let nearest = || -> Vec<WeightedPoint> {
            line.iter().filter(|one| one.2 != 0.0).map(|(i, _, nearest)| (*i, *nearest, *nearest)).collect()
        };
        all(line).or_else(|| all(&nearest()))
    }
}

fn stencil_point<'a>(
    (_, weight, nearest): &WeightedPoint,
    node: &'a SolvedNeighbour,
    before: Option<&'a SolvedNeighbour>,
) -> StencilPoint<'a> {
    StencilPoint { node, before, weight: *weight, nearest: *nearest }
}

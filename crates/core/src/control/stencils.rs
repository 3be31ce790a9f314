//! Starts of searches from solved instances of a sweep.

use super::hierarchy::Hierarchy;
use super::orbit_pair::{OrbitPair, WeightedPoint};
use crate::orbit::{OnFailure, PeriodicState, SolvedNeighbour, Stencil, StencilPoint, StencilStart};
use rayon::prelude::*;

/// Starts for some instances of a block.
pub(super) struct Stencils<'a> {
    /// The solved instances of the whole block.
    solved: &'a [OrbitPair],
    support: Support,
}

/// The support of each instance, by its number in the piece.
enum Support {
    /// None: these instances are searched for.
    Coarse,
    /// Solved instances on a line or around the instance.
    Lines { lines: Vec<Vec<WeightedPoint>>, scattered: bool },
    /// Any solved neighbour.
    Neighbours(Vec<Vec<u32>>),
    /// None: nothing has led to these instances, so they are integrated to steady state.
    Integrate,
}

impl<'a> Stencils<'a> {
    /// Starts for coarse points.
    pub fn coarse(solved: &'a [OrbitPair]) -> Self {
        Self { solved, support: Support::Coarse }
    }

    /// Starts for these instances of a level of the block.
    pub fn level((order, level): (&Hierarchy, usize), instances: &[u32], solved: &'a [OrbitPair]) -> Self {
        let lines = instances.par_iter().map(|i| order.support(level, *i, solved)).collect();
        Self { solved, support: Support::Lines { lines, scattered: order.scattered() } }
    }

    /// Starts for instances that no search has found.
    pub fn each(order: &Hierarchy, instances: &[u32], solved: &'a [OrbitPair]) -> Self {
        let beside = instances.par_iter().map(|i| order.adjacent(*i)).collect();
        Self { solved, support: Support::Neighbours(beside) }
    }

    /// Starts for instances that need time integration.
    pub fn integrated(solved: &'a [OrbitPair]) -> Self {
        Self { solved, support: Support::Integrate }
    }

    /// What happens after a failed search, in the first run and in the second. Searches for coarse points are repeated,
    /// because many others depend on them. Time integration waits until all else is known.
    pub fn on_failure(&self) -> [OnFailure; 2] {
        match self.support {
            Support::Coarse => [OnFailure::RetryLater; 2],
            Support::Lines { .. } | Support::Neighbours(_) => [OnFailure::LeaveUnsolved; 2],
            Support::Integrate => [OnFailure::LeaveUnsolved, OnFailure::SettleThenIntegrate],
        }
    }

    /// Whether every state that is found starts from neighbours.
    pub fn all_start_from_neighbours(&self) -> bool {
        matches!(self.support, Support::Neighbours(_))
    }

    /// Starts of the first run of these instances of the piece, from the first runs of their neighbours.
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
            Support::Integrate => StencilStart::Postponed,
        };
        instances.iter().map(of).collect()
    }

    /// Starts of the second run: the instance's own state of the first run, shifted by the difference at its neighbours.
    pub fn second_run(&self, found: &[Option<&'a PeriodicState>]) -> Vec<StencilStart<'a>> {
        let hint = |weighted: &WeightedPoint, [first, second]: &'a [SolvedNeighbour; 2]| {
            stencil_point(weighted, second, Some(first))
        };
        let of = |(i, own): (usize, &Option<&'a PeriodicState>)| match (&self.support, *own) {
            (_, None) => StencilStart::Postponed,
            (Support::Lines { lines, scattered }, own) => self.start(&lines[i], own, *scattered, hint),
            // The search starts at its own state.
            (Support::Coarse | Support::Neighbours(_) | Support::Integrate, Some(_)) => StencilStart::None,
        };
        found.iter().enumerate().map(of).collect()
    }

    /// The start that a stencil gives.
    fn start(
        &self,
        stencil: &[WeightedPoint],
        own: Option<&'a PeriodicState>,
        scattered: bool,
        hint: impl Fn(&WeightedPoint, &'a [SolvedNeighbour; 2]) -> StencilPoint<'a>,
    ) -> StencilStart<'a> {
        match self.line(stencil, hint) {
            Some(neighbours) => Stencil { neighbours, own_state: own, scattered }.into(),
            None if self.all_failed(stencil) => StencilStart::Postponed,
            None => StencilStart::None,
        }
    }

    /// Whether no search found the nearest points of a line. The instance's own search would fail as well, so it waits.
    fn all_failed(&self, line: &[WeightedPoint]) -> bool {
        let mut nearest = line.iter().filter(|one| one.2 != 0.0);
        nearest.all(|one| matches!(self.solved[one.0 as usize], OrbitPair::Vain))
    }

    /// Those of these instances that are solved.
    fn solved_points(&self, some: &[u32]) -> impl Iterator<Item = &'a [SolvedNeighbour; 2]> {
        let solved = self.solved;
        some.iter().filter_map(move |i| solved[*i as usize].neighbours())
    }

    /// The neighbours on a line, or the nearest two if a farther one is unknown. None if one of these is unknown.
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

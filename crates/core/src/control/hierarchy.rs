//! The order in which the instances of a large sweep start from one another's states.
//!
//! The sweep is divided into independent blocks, so a run of some blocks does with them what a run of all does. Grids are
//! filled along their axes; lists and designs, which have no axes, by distance.

use super::grid_hierarchy::{GridHierarchy, GridSlabs};
use super::orbit_pair::{OrbitPair, WeightedPoint};
use super::scattered_hierarchy::ScatteredHierarchy;
use crate::plan::{Grid, Plan};
use crate::scene::{Start, Steady};

/// A smaller sweep is searched for one by one.
const MIN_HIERARCHY_INSTANCES: usize = 1000;
/// Largest block. More: fewer coarse points, and predictions from more of the sweep. Less: a killed run loses less, and more
/// shares have work.
const MAX_BLOCK_INSTANCES: usize = 1 << 14;

/// The blocks of a plan.
pub(super) struct SweepBlocks {
    kind: BlockKind,
    /// The instances of the plan, block after block, in each block's own order.
    pub order: Vec<u32>,
}

enum BlockKind {
    Grids(Vec<Grid>),
    /// Sizes of the blocks, filled by the instances' numbers.
    Scattered(Vec<usize>),
}

impl SweepBlocks {
    /// None for a part of a scene, a small plan, time integration, prescribed steps, curves and set-points.
    pub fn of(plan: &Plan) -> Option<Self> {
        let ensemble = &plan.ensemble;
        let whole = plan.len() == ensemble.len() && plan.len() >= MIN_HIERARCHY_INSTANCES;
        let searched = plan.run.steady == Steady::Search && plan.run.start == Start::Steady;
        let led = ensemble.curves.is_some() || plan.has_setpoints() || plan.run.steps_per_period.is_some();
        if !whole || !searched || led {
            return None;
        }
        if let Some(GridSlabs { grids, order }) =
            ensemble.grid.as_ref().and_then(|grid| GridSlabs::worth(grid, MAX_BLOCK_INSTANCES))
        {
            return Some(Self { kind: BlockKind::Grids(grids), order });
        }
        let (count, blocks) = (plan.len(), plan.len().div_ceil(MAX_BLOCK_INSTANCES));
        let sizes = (0..blocks).map(|n| (n + 1) * count / blocks - n * count / blocks).collect();
        Some(Self { kind: BlockKind::Scattered(sizes), order: plan.instances().collect() })
    }

    /// Number of instances in each block.
    pub fn sizes(&self) -> Vec<usize> {
        match &self.kind {
            BlockKind::Grids(grids) => grids.iter().map(Grid::len).collect(),
            BlockKind::Scattered(sizes) => sizes.clone(),
        }
    }

    /// The order within a block. `plan` is that of the block.
    pub fn within(&self, block: usize, plan: &Plan) -> Hierarchy<'_> {
        match &self.kind {
            BlockKind::Grids(grids) => Hierarchy::Grid(GridHierarchy::over(&grids[block])),
            BlockKind::Scattered(_) => Hierarchy::Scattered(ScatteredHierarchy::new(plan)),
        }
    }
}

/// The order within a block: coarse points are searched for, then each level starts from the points before it.
pub(super) enum Hierarchy<'a> {
    Grid(GridHierarchy<'a>),
    Scattered(ScatteredHierarchy),
}

impl Hierarchy<'_> {
    /// The coarse points, which are searched for.
    pub fn coarse(&self) -> Vec<u32> {
        match self {
            Self::Grid(levels) => levels.coarse.clone(),
            Self::Scattered(all) => all.coarse(),
        }
    }

    /// Number of levels after the coarse points.
    pub fn levels(&self) -> usize {
        match self {
            Self::Grid(levels) => levels.later.len(),
            Self::Scattered(all) => all.levels(),
        }
    }

    /// The instances of a level.
    pub fn level(&self, number: usize) -> Vec<u32> {
        match self {
            Self::Grid(levels) => levels.later[number].points.clone(),
            Self::Scattered(all) => all.level(number),
        }
    }

    /// The stencil of an instance of a level, given what is solved so far. Scattered points come nearest first.
    pub fn support(&self, level: usize, instance: u32, solved: &[OrbitPair]) -> Vec<WeightedPoint> {
        match self {
            Self::Grid(levels) => levels.later[level].stencil(instance),
            Self::Scattered(all) => all.support(level, instance, solved),
        }
    }

    /// The neighbours of an instance.
    pub fn adjacent(&self, instance: u32) -> Vec<u32> {
        match self {
            Self::Grid(levels) => levels.adjacent(instance),
            Self::Scattered(all) => all.adjacent(instance),
        }
    }

    /// A number that orders instances independently of the direction of an axis.
    pub fn number(&self, instance: u32) -> u32 {
        match self {
            Self::Grid(levels) => levels.number(instance),
            Self::Scattered(_) => instance,
        }
    }

    /// Whether stencils surround an instance instead of lying on a line.
    pub fn scattered(&self) -> bool {
        matches!(self, Self::Scattered(_))
    }
}

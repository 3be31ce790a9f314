//! The order in which the instances of a large sweep begin at one another's states.
//!
//! The sweep is divided into blocks, each filled by itself: a run that has some of the blocks does with them what a run of
//! all does. Grids are filled along their axes; lists, designs and what else has no axes to go along, by distance.

use super::grid_hierarchy::{GridHierarchy, GridSlabs};
use super::orbit_pair::{OrbitPair, WeightedPoint};
use super::scattered_hierarchy::ScatteredHierarchy;
use crate::plan::{Grid, Plan};
use crate::scene::{Start, Steady};

/// Fewer instances than these are searched for one by one.
const MIN_HIERARCHY_INSTANCES: usize = 1000;
/// Most instances of a block. More: fewer coarse points, and guesses that rest on more of the sweep. Less: less is lost where a run
/// is killed, and more shares have work.
const MAX_BLOCK_INSTANCES: usize = 1 << 14;

/// The blocks of a plan.
pub(super) struct SweepBlocks {
    kind: BlockKind,
    /// The instances of the plan, block after block, in each in its own order.
    pub order: Vec<u32>,
}

enum BlockKind {
    Grids(Vec<Grid>),
    /// So many instances each, by their numbers.
    Scattered(Vec<usize>),
}

impl SweepBlocks {
    /// None where the plan is not the scene's own, too small, integrated to steady state, or started otherwise: along curves, to set-points.
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

    /// How many instances each has.
    pub fn sizes(&self) -> Vec<usize> {
        match &self.kind {
            BlockKind::Grids(grids) => grids.iter().map(Grid::len).collect(),
            BlockKind::Scattered(sizes) => sizes.clone(),
        }
    }

    /// The order within one of them, whose plan it is.
    pub fn within(&self, block: usize, plan: &Plan) -> Hierarchy<'_> {
        match &self.kind {
            BlockKind::Grids(grids) => Hierarchy::Grid(GridHierarchy::over(&grids[block])),
            BlockKind::Scattered(_) => Hierarchy::Scattered(ScatteredHierarchy::new(plan)),
        }
    }
}

/// The order within a block: some instances are searched for, then level after level the others begin at those before.
pub(super) enum Hierarchy<'a> {
    Grid(GridHierarchy<'a>),
    Scattered(ScatteredHierarchy),
}

impl Hierarchy<'_> {
    /// Those that are searched for.
    pub fn coarse(&self) -> Vec<u32> {
        match self {
            Self::Grid(levels) => levels.coarse.clone(),
            Self::Scattered(all) => all.coarse(),
        }
    }

    /// How many levels come after them.
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

    /// What the guess for an instance of a level rests on, by what is solved so far; of scattered ones the nearest comes first.
    pub fn support(&self, level: usize, instance: u32, solved: &[OrbitPair]) -> Vec<WeightedPoint> {
        match self {
            Self::Grid(levels) => levels.later[level].stencil(instance),
            Self::Scattered(all) => all.support(level, instance, solved),
        }
    }

    /// The instances next to one.
    pub fn adjacent(&self, instance: u32) -> Vec<u32> {
        match self {
            Self::Grid(levels) => levels.adjacent(instance),
            Self::Scattered(all) => all.adjacent(instance),
        }
    }

    /// By these numbers instances come in an order that does not hang on the direction of an axis.
    pub fn number(&self, instance: u32) -> u32 {
        match self {
            Self::Grid(levels) => levels.number(instance),
            Self::Scattered(_) => instance,
        }
    }

    /// Whether instances rest on others around them, not along a line.
    pub fn scattered(&self) -> bool {
        matches!(self, Self::Scattered(_))
    }
}

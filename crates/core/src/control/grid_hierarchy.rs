//! The order in which the instances of a grid start from one another's states. Coarse points are searched for, then the
//! points between them along one axis after the other, until the grid is full.
//!
//! The order depends on the grid alone, not on threads, the engine or the direction in which an axis is written.

use super::orbit_pair::WeightedPoint;
use crate::plan::{Grid, GridAxis, Ranks};

/// Spacing of coarse points along an axis, in places. The second holds while the first gives fewer than `MIN_COARSE_SPANS`.
const COARSE_SPACING: (u32, u32) = (16, 8);
const MIN_COARSE_SPANS: u32 = 7;
/// With more than one coarse point in this many instances there is too little to gain.
const MIN_INSTANCES_PER_COARSE: usize = 4;
/// Points of a stencil along an axis: a cubic.
const STENCIL_POINTS: usize = 4;
/// A grid cut into slabs that are filled independently.
pub(super) struct GridSlabs {
    /// Each slab as a grid of the axes along which it extends.
    pub grids: Vec<Grid>,
    /// The instances of the plan, slab after slab, in the order of each slab's grid.
    pub order: Vec<u32>,
}

impl GridSlabs {
    /// None if too many instances would be coarse points.
    pub fn worth(grid: &Grid, most: usize) -> Option<Self> {
        let slabs = Self::over(grid, most);
        let worth =
            |grid: &Grid| GridHierarchy::over(grid).coarse.len() * MIN_INSTANCES_PER_COARSE <= grid.len();
        slabs.grids.iter().all(worth).then_some(slabs)
    }

    /// Cuts one axis into ranges as even as possible, with at most `most` instances in each slab; the axes before it are
    /// fixed. The ranges follow the axis's values, so it may be written in any order.
    fn over(grid: &Grid, most: usize) -> Self {
        let slab = |n: usize| grid.axes[n + 1..].iter().map(|axis| axis.length as usize).product::<usize>();
        let (mut grids, mut order) = (Vec::new(), Vec::new());
        let Some(along) = (0..grid.axes.len()).find(|n| slab(*n) <= most) else {
            return Self { grids, order };
        };
        let axis = &grid.axes[along];
        let count = (axis.length as usize).div_ceil((most / slab(along)).max(1)) as u32;
        let outer = (grid.len() / (slab(along) * axis.length as usize)) as u32;
        for (before, n) in (0..outer).flat_map(|before| (0..count).map(move |n| (before, n))) {
            let ranks = n * axis.length / count..(n + 1) * axis.length / count;
            let length = ranks.len() as u32;
            let own = if axis.order.is_empty() { Vec::new() } else { (0..length).collect() };
            let mut axes = vec![GridAxis { stride: axis.stride, length, order: own }];
            axes.extend_from_slice(&grid.axes[along + 1..]);
            grids.push(Grid { axes });
            let place = |rank: u32| axis.order.get(rank as usize).copied().unwrap_or(rank);
            let first = |rank: u32| (before * axis.length + place(rank)) * axis.stride;
            order.extend(ranks.flat_map(|rank| first(rank)..first(rank) + axis.stride));
        }
        Self { grids, order }
    }
}

/// Coarse points of a grid, then the points between them, axis after axis.
pub(super) struct GridHierarchy<'a> {
    pub coarse: Vec<u32>,
    pub later: Vec<GridLevel<'a>>,
    ranks: Ranks<'a>,
}

/// Points between known ones along one axis.
pub(super) struct GridLevel<'a> {
    axis: &'a GridAxis,
    /// For each place of the axis, its rank among the values.
    rank: Vec<u32>,
    /// Ranks that are known, in ascending order.
    known: Vec<u32>,
    pub points: Vec<u32>,
}

impl<'a> GridHierarchy<'a> {
    pub fn over(grid: &'a Grid) -> Self {
        let mut spans: Vec<u32> = grid.axes.iter().map(coarse_spans).collect();
        let mut known: Vec<Vec<u32>> =
            grid.axes.iter().zip(&spans).map(|(axis, spans)| places(axis, *spans)).collect();
        let scouts = points(grid, &known);
        let mut later = Vec::new();
        let full = |axis: &GridAxis, spans: u32| axis.order.is_empty() || spans + 1 >= axis.length;
        while grid.axes.iter().zip(&spans).any(|(axis, spans)| !full(axis, *spans)) {
            for (n, axis) in grid.axes.iter().enumerate() {
                if full(axis, spans[n]) {
                    continue;
                }
                spans[n] *= 2;
                let all = places(axis, spans[n]);
                let before = std::mem::replace(&mut known[n], all);
                let fresh = known[n].iter().copied().filter(|place| before.binary_search(place).is_err());
                let mut between = known.clone();
                between[n] = fresh.collect();
                let points = points(grid, &between);
                later.push(GridLevel { axis, rank: axis.ranks(), known: before, points });
            }
        }
        Self { coarse: scouts, later, ranks: Ranks::of(grid) }
    }

    /// A number that orders points independently of the direction of an axis.
    pub fn number(&self, point: u32) -> u32 {
        self.ranks.number(point)
    }

    /// The points one step away along one axis.
    pub fn adjacent(&self, point: u32) -> Vec<u32> {
        let along = |(axis, ranks): &(&GridAxis, Vec<u32>)| {
            let place = point / axis.stride % axis.length;
            let (base, rank) = (point - place * axis.stride, ranks[place as usize]);
            let next = [rank.checked_sub(1), (rank + 1 < axis.length).then_some(rank + 1)];
            let there = next.into_iter().flatten();
            there.map(|rank| base + axis.order[rank as usize] * axis.stride).collect::<Vec<u32>>()
        };
        self.ranks.0.iter().flat_map(along).collect()
    }
}

impl GridLevel<'_> {
    /// The stencil of one of its points: four known points on its line, or all if there are fewer.
    pub fn stencil(&self, point: u32) -> Vec<WeightedPoint> {
        let Self { axis, known, .. } = self;
        let place = point / axis.stride % axis.length;
        let rank = self.rank[place as usize];
        let above = known.partition_point(|other| *other < rank);
        let many = STENCIL_POINTS.min(known.len());
        let first = above.saturating_sub(many / 2).min(known.len() - many);
        let (low, high) = (known[above - 1], known[above]);
        let share = f64::from(rank - low) / f64::from(high - low);
        let some = &known[first..first + many];
        let weight = |a: u32| -> f64 {
            let others = some.iter().filter(|b| **b != a);
            others.map(|b| (f64::from(rank) - f64::from(*b)) / (f64::from(a) - f64::from(*b))).product()
        };
        let nearest = |a: u32| match a {
            a if a == low => 1.0 - share,
            a if a == high => share,
            _ => 0.0,
        };
        let base = point - place * axis.stride;
        let instance = |rank: u32| base + axis.order[rank as usize] * axis.stride;
        some.iter().map(|rank| (instance(*rank), weight(*rank), nearest(*rank))).collect()
    }
}

/// Number of spans between coarse points along an axis. An axis without an order takes every place.
fn coarse_spans(axis: &GridAxis) -> u32 {
    let steps = axis.length - 1;
    match axis.order.is_empty() {
        true => steps,
        false => steps.div_ceil(COARSE_SPACING.0).max(steps.div_ceil(COARSE_SPACING.1).min(MIN_COARSE_SPANS)),
    }
}

/// The ranks at the ends of this many spans, as even as possible.
fn places(axis: &GridAxis, spans: u32) -> Vec<u32> {
    let steps = axis.length - 1;
    match spans >= steps {
        true => (0..axis.length).collect(),
        false => (0..=spans).map(|n| (2 * n * steps + spans) / (2 * spans)).collect(),
    }
}

/// The instances at these ranks of the axes.
fn points(grid: &Grid, ranks: &[Vec<u32>]) -> Vec<u32> {
    let mut all = vec![0];
    for (axis, ranks) in grid.axes.iter().zip(ranks) {
        let place = |rank: &u32| axis.order.get(*rank as usize).copied().unwrap_or(*rank);
        all = all
            .iter()
            .flat_map(|base| ranks.iter().map(move |rank| base + place(rank) * axis.stride))
            .collect();
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid(lengths: &[(u32, bool)]) -> Grid {
        let mut stride = lengths.iter().map(|one| one.0).product();
        let axis = |&(length, ordered): &(u32, bool)| {
            stride /= length;
            let order = if ordered { (0..length).rev().collect() } else { Vec::new() };
            GridAxis { stride, length, order }
        };
        Grid { axes: lengths.iter().map(axis).collect() }
    }

    #[test]
    fn every_instance_comes_once_and_rests_on_those_before() {
        let grid = grid(&[(40, true), (3, false), (50, true)]);
        let levels = GridHierarchy::over(&grid);
        let mut seen = vec![false; 6000];
        levels.coarse.iter().for_each(|i| seen[*i as usize] = true);
        // An axis of 40 places has 5 spans, one of 50 has 7.
        assert_eq!(levels.coarse.len(), 6 * 3 * 8);
        for level in &levels.later {
            for point in &level.points {
                assert!(!seen[*point as usize]);
                let line = level.stencil(*point);
                assert!(line.len() == 4 && line.iter().all(|one| seen[one.0 as usize]), "{line:?}");
            }
            level.points.iter().for_each(|i| seen[*i as usize] = true);
        }
        assert!(seen.iter().all(|seen| *seen));
    }

    #[test]
    fn every_instance_is_in_one_slab_and_every_slab_is_filled() {
        for (lengths, most, sizes) in [
            (vec![(40, true), (50, true), (50, true)], 32_768, vec![25_000; 4]),
            (vec![(5, true), (50, true), (50, true)], 5_000, vec![2_500, 5_000, 5_000]),
            (vec![(3, false), (100, true)], 50, vec![50; 6]),
            (vec![(7, true)], 100, vec![7]),
        ] {
            let whole = grid(&lengths);
            let slabs = GridSlabs::over(&whole, most);
            assert_eq!(slabs.grids.iter().map(Grid::len).collect::<Vec<_>>(), sizes);
            for (n, size) in sizes.iter().enumerate() {
                let GridHierarchy { coarse: scouts, later, .. } = GridHierarchy::over(&slabs.grids[n]);
                let mut all: Vec<u32> = scouts;
                all.extend(later.iter().flat_map(|level| level.points.iter().copied()));
                all.sort_unstable();
                assert!(all.iter().copied().eq(0..*size as u32), "{lengths:?}, slab {n}");
            }
            let mut all = slabs.order.clone();
            all.sort_unstable();
            assert!(all.into_iter().eq(0..whole.len() as u32), "{lengths:?}");
        }
    }

    #[test]
    fn instances_beside_one_are_a_step_away_by_the_values() {
        let mut grid = grid(&[(5, true), (3, false), (4, true)]);
        // Values ascend in the order of places 2, 0, 3, 1, 4.
        grid.axes[0].order = vec![2, 0, 3, 1, 4];
        let levels = GridHierarchy::over(&grid);
        // Place 0 of the first axis lies between 2 and 3. Place 3 of the last axis, which is reversed, is its lower end.
        assert_eq!(levels.adjacent(4 + 3), [2 * 12 + 7, 3 * 12 + 7, 4 + 2]);
        let mutual = |i: u32| levels.adjacent(i).iter().all(|j| levels.adjacent(*j).contains(&i));
        assert!((0..60).all(mutual));
    }

    /// Lagrange's weights reproduce cubics and those of the nearest points lines, in the rank as in the place.
    #[test]
    fn weights_hold_cubics() {
        let grid = grid(&[(50, true)]);
        let levels = GridHierarchy::over(&grid);
        let cubic = |i: u32| (f64::from(i) / 10.0 - 2.0).powi(3) + f64::from(i);
        for level in &levels.later {
            for point in &level.points {
                let line = level.stencil(*point);
                let told: f64 = line.iter().map(|(i, weight, _)| weight * cubic(*i)).sum();
                let even: f64 = line.iter().map(|(i, _, nearest)| nearest * f64::from(*i)).sum();
                assert!((told - cubic(*point)).abs() < 1e-10 && (even - f64::from(*point)).abs() < 1e-12);
            }
        }
    }
}

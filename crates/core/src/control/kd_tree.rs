//! A k-d tree of medians (Bentley 1975, <https://doi.org/10.1145/361002.361007>). It orders scattered instances and finds the
//! nearest solved ones. Points at its top spread over all instances, and those of each depth lie between the ones above, so
//! the solved points always form a whole tree.

/// Points and the tree over them. The tree depends on the coordinates and the order of the points alone.
pub(super) struct KdTree {
    dimensions: usize,
    /// The points in the order of the tree: the middle point of a stretch divides it.
    points: Vec<u32>,
    /// Coordinates, point after point in that order.
    coordinates: Vec<f64>,
    /// For each place, the dimension along which its point divides the stretch.
    along: Vec<u8>,
}

/// A point and the square of its distance.
pub(super) type NearPoint = (u32, f64);

impl KdTree {
    /// Builds the tree over points with this many coordinates each.
    pub fn new(dimensions: usize, coordinates: &[f64]) -> Self {
        let count = coordinates.len() / dimensions.max(1);
        let mut points: Vec<u32> = (0..count as u32).collect();
        let mut along = vec![0; count];
        let coordinates = |point: u32| &coordinates[point as usize * dimensions..][..dimensions];
        divide(&mut points, &mut along, &coordinates);
        let coordinates = points.iter().flat_map(|point| coordinates(*point)).copied().collect();
        Self { dimensions, points, coordinates, along }
    }

    /// The points at these depths, those that lie together one after the other. The root has depth 0.
    pub fn at(&self, depths: std::ops::Range<u32>) -> Vec<u32> {
        let mut all = Vec::new();
        self.walk((0, self.points.len(), 0), &depths, &mut all);
        all
    }

    /// Adds the points of a stretch at these depths from left to right.
    fn walk(
        &self,
        (from, to, depth): (usize, usize, u32),
        depths: &std::ops::Range<u32>,
        all: &mut Vec<u32>,
    ) {
        if from >= to || depth >= depths.end {
            return;
        }
        let middle = from.midpoint(to);
        self.walk((from, middle, depth + 1), depths, all);
        if depths.contains(&depth) {
            all.push(self.points[middle]);
        }
        self.walk((middle + 1, to, depth + 1), depths, all);
    }

    /// Number of depths.
    pub fn depth(&self) -> u32 {
        usize::BITS - self.points.len().leading_zeros()
    }

    /// The `count` points above a depth that are nearest to these coordinates, nearest first. Of equal distances the lower
    /// number comes first. With a `ratio` above 1 they may be so many times as far as the nearest ones, and the search looks at
    /// fewer points (Arya et al. 1998, <https://doi.org/10.1145/293347.293348>).
    pub fn nearest(&self, to: &[f64], above: u32, count: usize, ratio: f64) -> Vec<NearPoint> {
        let (best, off) = (Vec::with_capacity(count + 1), vec![0.0; to.len()]);
        let mut search = KdSearch { to, above, count, slack: ratio * ratio, best, off };
        search.through(self, (0, self.points.len(), 0), 0.0);
        search.best
    }

    fn place(&self, at: usize) -> &[f64] {
        &self.coordinates[at * self.dimensions..][..self.dimensions]
    }
}

/// Moves the median along the widest dimension to the middle, then does the same in both halves.
fn divide<'a>(points: &mut [u32], along: &mut [u8], place: &impl Fn(u32) -> &'a [f64]) {
    let Some(first) = points.first() else { return };
    let middle = points.len() / 2;
    let width = |n: usize| {
        let all = points.iter().map(|point| place(*point)[n]);
        let (low, high) =
            all.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
        high - low
    };
    let widths: Vec<f64> = (0..place(*first).len()).map(width).collect();
    let widest = (1..widths.len()).fold(0, |best, n| if widths[n] > widths[best] { n } else { best });
    points.select_nth_unstable_by(middle, |a, b| {
        place(*a)[widest].total_cmp(&place(*b)[widest]).then(a.cmp(b))
    });
    along[middle] = widest as u8;
    let (low, high) = points.split_at_mut(middle);
    let (along_low, along_high) = along.split_at_mut(middle);
    divide(low, along_low, place);
    divide(&mut high[1..], &mut along_high[1..], place);
}

/// A search for the nearest points.
struct KdSearch<'a> {
    to: &'a [f64],
    above: u32,
    count: usize,
    /// Square of the ratio by which a point may be farther than one that is left out.
    slack: f64,
    best: Vec<NearPoint>,
    /// Distance from the stretch to the target along each dimension.
    off: Vec<f64>,
}

impl KdSearch<'_> {
    /// Searches a stretch of the tree. `far` is the square of its distance.
    fn through(&mut self, tree: &KdTree, (from, to, depth): (usize, usize, u32), far: f64) {
        let full = self.best.len() == self.count;
        if from >= to
            || depth >= self.above
            || full && self.best.last().is_some_and(|last| far * self.slack > last.1)
        {
            return;
        }
        let middle = from.midpoint(to);
        let place = tree.place(middle);
        let square = self.to.iter().zip(place).map(|(a, b)| (a - b).powi(2)).sum();
        self.offer((tree.points[middle], square));
        let n = usize::from(tree.along[middle]);
        let beyond = self.to[n] - place[n];
        let [low, high] = [(from, middle, depth + 1), (middle + 1, to, depth + 1)];
        let (near, other) = if beyond < 0.0 { (low, high) } else { (high, low) };
        self.through(tree, near, far);
        let before = std::mem::replace(&mut self.off[n], beyond);
        self.through(tree, other, far + beyond * beyond - before * before);
        self.off[n] = before;
    }

    fn offer(&mut self, one: NearPoint) {
        let nearer = |other: &NearPoint| other.1 < one.1 || other.1 == one.1 && other.0 < one.0;
        if self.best.len() == self.count {
            if self.best.last().is_none_or(nearer) {
                return;
            }
            self.best.pop();
        }
        let at = self.best.iter().rposition(nearer).map_or(0, |before| before + 1);
        self.best.insert(at, one);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points on a lattice with a very long period, so that some distances are equal.
    fn points(count: usize, dimensions: usize) -> Vec<f64> {
        (0..count * dimensions).map(|n| ((n * n * 7919 + n * 104_729) % 1009) as f64 / 50.0).collect()
    }

    #[test]
    fn every_point_is_at_one_depth_and_the_top_is_spread() {
        let tree = KdTree::new(3, &points(1000, 3));
        assert_eq!(tree.depth(), 10);
        let mut all: Vec<u32> = (0..tree.depth()).flat_map(|depth| tree.at(depth..depth + 1)).collect();
        assert_eq!(tree.at(0..5).len(), 31);
        all.sort_unstable();
        assert!(all.into_iter().eq(0..1000));
    }

    /// Truth: all distances, sorted.
    #[test]
    fn nearest_are_those_of_a_look_at_all() {
        for dimensions in [1, 3, 6] {
            let all = points(800, dimensions);
            let tree = KdTree::new(dimensions, &all);
            for above in [4, 7, tree.depth()] {
                let there = tree.at(0..above);
                let to = vec![7.3; dimensions];
                let square = |point: u32| -> f64 {
                    let place = &all[point as usize * dimensions..][..dimensions];
                    to.iter().zip(place).map(|(a, b)| (a - b).powi(2)).sum()
                };
                let mut sorted: Vec<NearPoint> = there.iter().map(|point| (*point, square(*point))).collect();
                sorted.sort_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)));
                sorted.truncate(12);
                assert_eq!(tree.nearest(&to, above, 12, 1.0), sorted, "{dimensions}, above {above}");
                let near = tree.nearest(&to, above, 12, 2.0);
                assert_eq!(near.len(), sorted.len());
                let within = |(one, exact): (&NearPoint, &NearPoint)| one.1 <= 4.0 * exact.1;
                assert!(near.iter().zip(&sorted).all(within), "{near:?} {sorted:?}");
            }
        }
    }
}

//! Neighbours in a grid.

/// Most axes that are searched for neighbours. Further axes are ignored.
const MAX_ADJACENCY_AXES: usize = 16;

/// A grid: the last axis runs fastest.
pub(super) struct GridAdjacency {
    /// For each axis its length, and the distance between the numbers of neighbours along it.
    axes: Vec<(u32, u32)>,
}

impl GridAdjacency {
    /// None if these lengths do not multiply to `count`, as for a list, or nothing is swept.
    pub fn of(shape: &[usize], count: usize) -> Option<Self> {
        if shape.is_empty() || shape.iter().product::<usize>() != count {
            return None;
        }
        let mut stride = 1;
        let mut axes: Vec<(u32, u32)> = Vec::with_capacity(shape.len());
        for &length in shape.iter().rev() {
            axes.push((length as u32, stride));
            stride *= length as u32;
        }
        // The last axis of the file, mostly the finest, comes first.
        axes.truncate(MAX_ADJACENCY_AXES);
        Some(Self { axes })
    }

    /// The instances one step away along one axis, each with the number of its side: twice the axis, plus one if it is above.
    pub fn adjacent(&self, instance: u32) -> impl Iterator<Item = (u32, u32)> {
        self.axes.iter().enumerate().flat_map(move |(axis, &(length, stride))| {
            let place = instance / stride % length;
            let below = (place > 0).then(|| (2 * axis as u32, instance - stride));
            let above = (place + 1 < length).then(|| (2 * axis as u32 + 1, instance + stride));
            below.into_iter().chain(above)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_differ_by_one_along_one_axis() {
        let shape = [3usize, 1, 4];
        let grid = GridAdjacency::of(&shape, 12).expect("a grid");
        let place = |i: u32| [i / 4, 0, i % 4];
        for i in 0..12 {
            let around: Vec<u32> = grid.adjacent(i).map(|(_, j)| j).collect();
            let apart = |j: &u32| place(i).iter().zip(place(*j)).map(|(a, b)| a.abs_diff(b)).sum::<u32>();
            let expected: Vec<u32> = (0..12).filter(|j| apart(j) == 1).collect();
            let mut sorted = around.clone();
            sorted.sort_unstable();
            assert_eq!(sorted, expected, "{i}");
            let mut sides: Vec<u32> = grid.adjacent(i).map(|(side, _)| side).collect();
            sides.dedup();
            assert_eq!(sides.len(), around.len());
        }
        assert!(GridAdjacency::of(&shape, 13).is_none() && GridAdjacency::of(&[], 1).is_none());
    }
}

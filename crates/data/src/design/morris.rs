//! Trajectories of M. D. Morris, Technometrics 33, 161 (1991): from a point of a grid one group of parameters after the
//! other moves by half of the grid.

use super::mix::Mix;

/// What a point of a trajectory needs to know of its design.
#[derive(Clone, Copy, Debug)]
pub(super) struct Trajectories<'a> {
    /// An even number.
    pub levels: u64,
    /// Of each parameter, its group.
    pub group_of: &'a [usize],
    pub groups: usize,
}

impl Trajectories<'_> {
    /// Level of each parameter, from 0 up to one less than there are.
    pub fn levels(&self, trajectory: u64, point: usize, mix: Mix) -> Vec<u64> {
        let (half, mix) = (self.levels / 2, mix.of(trajectory));
        let level = |(parameter, group): (usize, &usize)| {
            let own = mix.of(1 + parameter as u64);
            let low = own.of(0).below(half);
            let rises = own.of(1).below(2) == 1;
            let moved = (self.place(*group, mix) as usize) < point;
            if rises == moved { low + half } else { low }
        };
        self.group_of.iter().enumerate().map(level).collect()
    }

    /// As the how manieth a group moves, from 0.
    fn place(&self, group: usize, mix: Mix) -> u64 {
        mix.of(0).permuted(group as u64, self.groups as u64)
    }

    /// The group that moves between this point and the next, and whether its first parameter rises.
    #[cfg(test)]
    fn moves(&self, trajectory: u64, point: usize, mix: Mix) -> usize {
        (0..self.groups).find(|g| self.place(*g, mix.of(trajectory)) == point as u64).unwrap_or(usize::MAX)
    }
}

#[cfg(test)]
mod tests {
    use super::{Mix, Trajectories};

    #[test]
    fn one_group_moves_at_a_time_by_half_of_the_levels() {
        let all = Trajectories { levels: 6, group_of: &[0, 1, 1, 2], groups: 3 };
        let mix = Mix::new(3);
        for trajectory in 0..200 {
            for point in 0..3 {
                let (a, b) = (all.levels(trajectory, point, mix), all.levels(trajectory, point + 1, mix));
                let moving = all.moves(trajectory, point, mix);
                for (parameter, (a, b)) in a.iter().zip(&b).enumerate() {
                    let step = if all.group_of[parameter] == moving { 3 } else { 0 };
                    assert_eq!(a.abs_diff(*b), step);
                    assert!(*a < 6);
                }
            }
        }
    }
}

//! Numbers that look random and follow from a seed and a place alone.

/// A place in the stream of a seed: purpose, dimension, index, in any order that the caller keeps to.
#[derive(Clone, Copy, Debug)]
pub struct Mix(u64);

impl Mix {
    pub fn new(seed: u64) -> Self {
        Self(finish(seed ^ 0x6a09_e667_f3bc_c908))
    }

    /// The stream of a part of this one.
    pub fn of(self, part: u64) -> Self {
        Self(finish(self.0.wrapping_add(part.wrapping_mul(0x9e37_79b9_7f4a_7c15)).rotate_left(23) ^ part))
    }

    pub fn bits(self) -> u64 {
        finish(self.0)
    }

    /// Above 0 and below 1, on a grid of 2^-53.
    pub fn share(self) -> f64 {
        ((self.bits() >> 12) as f64 + 0.5) * 2f64.powi(-52)
    }

    /// One of so many, each as likely.
    pub fn below(self, count: u64) -> u64 {
        ((u128::from(self.bits()) * u128::from(count)) >> 64) as u64
    }

    /// Where `place` (below `count`) goes in a permutation of so many places.
    ///
    /// Four Feistel rounds over the next even number of bits, walked until the place is inside: J. Black and P. Rogaway,
    /// Ciphers with arbitrary finite domains, CT-RSA 2002, section 3.
    pub fn permuted(self, place: u64, count: u64) -> u64 {
        if count < 2 {
            return place;
        }
        let half = (64 - (count - 1).leading_zeros()).div_ceil(2);
        let mask = (1u64 << half) - 1;
        let mut at = place;
        loop {
            let (mut left, mut right) = (at >> half, at & mask);
            for round in 0..4 {
                (left, right) = (right, left ^ (self.of(round).of(right).bits() & mask));
            }
            at = (left << half) | right;
            if at < count {
                return at;
            }
        }
    }
}

/// The finisher of MurmurHash3 with the constants of D. Stafford's variant 13.
fn finish(mut x: u64) -> u64 {
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

#[cfg(test)]
mod tests {
    use super::Mix;

    #[test]
    fn places_are_permuted_one_to_one() {
        for count in [1, 2, 3, 5, 16, 17, 100, 1023, 1024, 4097] {
            let mut seen = vec![false; count as usize];
            for place in 0..count {
                let to = Mix::new(7).permuted(place, count) as usize;
                assert!(!std::mem::replace(&mut seen[to], true), "{count}: {to} twice");
            }
        }
    }

    /// Chi-squared of 100 cells: 99 +- 14 for fair ones.
    #[test]
    fn shares_are_spread_evenly() {
        let mut cells = [0f64; 100];
        (0..100_000u64).for_each(|i| cells[(Mix::new(1).of(3).of(i).share() * 100.0) as usize] += 1.0);
        let chi: f64 = cells.iter().map(|n| (n - 1000.0).powi(2) / 1000.0).sum();
        assert!((50.0..160.0).contains(&chi), "{chi}");
    }
}

//! Sobol' points, by their index, scrambled after Owen.

use super::mix::Mix;
use sobol::Sobol;
use sobol::params::JoeKuoD6;

/// Bits of a coordinate.
const BITS: usize = 32;

/// The sequence with the direction numbers of S. Joe and F. Y. Kuo, SIAM J. Sci. Comput. 30, 2635 (2008), table D6, in the
/// order of the Gray code: the same points as SciPy's.
#[derive(Clone, Debug)]
pub(super) struct Sequence {
    /// Of each dimension, the number that each bit of the index stands for.
    directions: Vec<Vec<u32>>,
}

impl Sequence {
    /// Most dimensions there are.
    pub const DIMENSIONS: usize = 1000;

    pub fn new(dimensions: usize) -> Self {
        let directions = Sobol::<u32>::init_direction_vals(dimensions, BITS, &JoeKuoD6::standard());
        Self { directions }
    }

    /// A coordinate of the point, in units of 2^-32.
    fn coordinate(&self, dimension: usize, index: u64) -> u32 {
        let mut gray = index ^ (index >> 1);
        let mut sum = 0;
        let directions = &self.directions[dimension];
        while gray != 0 {
            sum ^= directions[gray.trailing_zeros() as usize];
            gray &= gray - 1;
        }
        sum
    }

    /// A coordinate as it is, 0 among them.
    pub fn plain(&self, dimension: usize, index: u64) -> f64 {
        f64::from(self.coordinate(dimension, index)) * 2f64.powi(-(BITS as i32))
    }

    /// A coordinate under the nested uniform scrambling of A. B. Owen (Monte Carlo and Quasi-Monte Carlo Methods 1995,
    /// 299): each bit is flipped or not by what the bits before it say. In the middle of its cell, so never 0.
    pub fn scrambled(&self, dimension: usize, index: u64, mix: Mix) -> f64 {
        let plain = self.coordinate(dimension, index);
        let mut flips = 0;
        for bit in 0..BITS {
            // The bits before this one, with a leading 1 that tells how many they are.
            let before = (1u64 << bit) | (u64::from(plain) >> (BITS - bit));
            flips |= ((mix.of(before).bits() >> 63) as u32) << (BITS - 1 - bit);
        }
        (f64::from(plain ^ flips) + 0.5) * 2f64.powi(-(BITS as i32))
    }
}

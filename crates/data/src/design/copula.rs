//! Correlated parameters: a Gaussian copula with given rank correlations.

use super::distribution::{normal_below, normal_quantile};
use nalgebra::DMatrix;

/// Turns independent shares into correlated ones.
#[derive(Clone, Debug, PartialEq)]
pub struct Copula {
    /// Lower triangle whose product with its transpose is the correlation of the normal numbers.
    root: DMatrix<f64>,
}

impl Copula {
    /// Of so many parameters, with these rank correlations of pairs. None where no such parameters exist: the correlations
    /// contradict each other.
    pub fn new(parameters: usize, pairs: &[(usize, usize, f64)]) -> Option<Self> {
        let mut matrix = DMatrix::identity(parameters, parameters);
        for &(a, b, rank) in pairs {
            // Spearman's correlation of normal numbers of correlation r is 6/pi asin(r/2).
            let normal = 2.0 * (std::f64::consts::PI / 6.0 * rank).sin();
            matrix[(a, b)] = normal;
            matrix[(b, a)] = normal;
        }
        matrix.cholesky().map(|found| Self { root: found.l() })
    }

    /// In place.
    pub fn correlate(&self, shares: &mut [f64]) {
        let free: Vec<f64> = shares.iter().map(|share| normal_quantile(*share)).collect();
        for (row, share) in shares.iter_mut().enumerate() {
            // What stands alone keeps its bits, and its strata.
            if (0..row).any(|column| self.root[(row, column)] != 0.0) {
                let sum: f64 = (0..=row).map(|column| self.root[(row, column)] * free[column]).sum();
                *share = normal_below(sum);
            }
        }
    }
}

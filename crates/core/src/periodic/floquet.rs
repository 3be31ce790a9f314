//! Stability of a fixed point, from the map's Jacobian.

use super::size::{Memory, Size};
use nalgebra::{DMatrix, DefaultAllocator, Dyn, LU, OMatrix, Schur};

/// Properties of a map's Jacobian at a fixed point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Floquet {
    /// Modulus of the largest Floquet multiplier; the state is stable below 1.
    pub multiplier: f64,
    /// Lower bound on the residual of a state over its distance to the fixed point.
    pub sigma_min: f64,
}

impl Floquet {
    /// From a Jacobian J and the factors of 1 - J.
    pub(super) fn new<D: Size>(slope: &OMatrix<f64, D, D>, factors: &LU<f64, D, D>) -> Self
    where
        DefaultAllocator: Memory<D>,
    {
        Self { multiplier: largest_multiplier(slope), sigma_min: smallest_singular_value(factors) }
    }
}

/// LU factors of `shift` minus the Jacobian.
pub(super) fn factors<D: Size>(slope: &OMatrix<f64, D, D>, shift: f64) -> LU<f64, D, D>
where
    DefaultAllocator: Memory<D>,
{
    let mut matrix = -slope;
    (0..slope.nrows()).for_each(|k| matrix[(k, k)] += shift);
    matrix.lu()
}

/// Largest modulus of the eigenvalues: the factor by which the slowest deviation shrinks in a period. Infinity if the
/// eigenvalues do not converge.
fn largest_multiplier<D: Size>(slope: &OMatrix<f64, D, D>) -> f64
where
    DefaultAllocator: Memory<D>,
{
    // Compiled once for all sizes.
    let slope = DMatrix::from_column_slice(slope.nrows(), slope.ncols(), slope.as_slice());
    let found = Schur::<f64, Dyn>::try_new(slope, f64::EPSILON, 10_000);
    let Some(schur) = found else { return f64::INFINITY };
    schur.complex_eigenvalues().iter().map(|value| value.norm()).fold(0.0, f64::max)
}

/// A lower bound on the smallest singular value of 1 - Jacobian from its factors, good to the root of its size. The residual
/// of a state is at least this share of its distance to the fixed point.
fn smallest_singular_value<D: Size>(factors: &LU<f64, D, D>) -> f64
where
    DefaultAllocator: Memory<D>,
{
    factors.try_inverse().map_or(0.0, |inverse| 1.0 / inverse.norm())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_turning_and_shrinking_plane_has_its_factor() {
        let (shrink, angle) = (0.97f64, 0.4f64);
        let (sine, cosine) = angle.sin_cos();
        let slope = DMatrix::from_row_slice(2, 2, &[cosine, -sine, sine, cosine]) * shrink;
        // |1 - 0.97 exp(0.4 i)|, in both directions.
        let least = (1.0 - 2.0 * shrink * cosine + shrink * shrink).sqrt();
        assert!((smallest_singular_value(&factors(&slope, 1.0)) - least / 2f64.sqrt()).abs() < 1e-14);
        assert!((largest_multiplier(&slope) - shrink).abs() < 1e-14);
    }
}

//! The inverse of a small matrix, by Gauss and Jordan with partial pivoting (Golub & Van Loan, Matrix Computations, 2013,
//! section 3.4). In place, without heap memory.

use super::{Memory, Size};
use nalgebra::{DefaultAllocator, DimName, OMatrix};

/// The inverse of this matrix; `None` if it is singular or not finite.
pub fn inverse<D: Size + DimName>(mut matrix: OMatrix<f64, D, D>) -> Option<OMatrix<f64, D, D>>
where
    DefaultAllocator: Memory<D>,
{
    let size = D::DIM;
    // The columns are the rows of the transpose, whose inverse is the transpose of the inverse.
    let rows = matrix.as_mut_slice();
    let mut swapped = [0; 2 * crate::kernel::MODES_MAX];
    for k in 0..size {
        let larger =
            |a: usize, b: usize| if rows[b * size + k].abs() > rows[a * size + k].abs() { b } else { a };
        let pivot = (k + 1..size).fold(k, larger);
        let largest = rows[pivot * size + k];
        if largest == 0.0 || !largest.is_finite() {
            return None;
        }
        swapped[k] = pivot;
        if pivot != k {
            let (above, below) = rows.split_at_mut(pivot * size);
            above[k * size..][..size].swap_with_slice(&mut below[..size]);
        }
        let (before, rest) = rows.split_at_mut(k * size);
        let (own, after) = rest.split_at_mut(size);
        own[k] = 1.0;
        own.iter_mut().for_each(|value| *value /= largest);
        for row in before.chunks_exact_mut(size).chain(after.chunks_exact_mut(size)) {
            let factor = std::mem::replace(&mut row[k], 0.0);
            row.iter_mut().zip(&*own).for_each(|(value, own)| *value -= factor * own);
        }
    }
    for k in (0..size).rev().filter(|k| swapped[*k] != *k) {
        rows.chunks_exact_mut(size).for_each(|row| row.swap(k, swapped[k]));
    }
    Some(matrix)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Const;

    fn holds<const N: usize>()
    where
        Const<N>: Size + DimName,
        DefaultAllocator: Memory<Const<N>>,
    {
        // Its largest entries lie off the diagonal.
        let entry = |i: usize, j: usize| {
            ((7 * i + 3 * j * j) % 11) as f64 / 11.0 + f64::from(u8::from((i + 2) % N == j))
        };
        let matrix = OMatrix::<f64, Const<N>, Const<N>>::from_fn(entry);
        let other = inverse(matrix.clone()).expect("it has one");
        let apart = (matrix * other - OMatrix::<f64, Const<N>, Const<N>>::identity()).norm();
        assert!(apart < 1e-11, "{N}: {apart:e}");
    }

    /// Truth: their product is the identity.
    #[test]
    fn the_product_with_its_inverse_is_the_identity() {
        holds::<2>();
        holds::<6>();
        holds::<16>();
        holds::<48>();
    }

    #[test]
    fn a_matrix_without_an_inverse_has_none() {
        let flat =
            OMatrix::<f64, Const<4>, Const<4>>::from_fn(|i, j| (i + j) as f64 * f64::from(u8::from(i != 2)));
        assert!(inverse(flat).is_none());
        assert!(inverse(OMatrix::<f64, Const<2>, Const<2>>::from_element(f64::NAN)).is_none());
    }
}

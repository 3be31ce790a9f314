//! Weights by which the values at scattered points give the value between them: radial functions r^3 with a linear part,
//! through the nearest points alone (Wendland, Scattered Data Approximation, 2005, section 8.5).

use nalgebra::{DMatrix, DVector};

/// Weights beyond this in sum of their sizes: the points are no ground for a guess between them.
const WILD: f64 = 8.0;

/// Weights of points, given by their coordinates, for the value at `at`; they sum to one. None where the points lie so that
/// they do not tell.
pub(super) fn weights(at: &[f64], points: &[&[f64]]) -> Option<Vec<f64>> {
    let (count, dimensions) = (points.len(), at.len());
    let square = |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum() };
    let far = points.iter().map(|point| square(point, at)).fold(0.0, f64::max).sqrt();
    if far.is_nan() || far == 0.0 || count <= dimensions {
        return None;
    }
    let radial = |a: &[f64], b: &[f64]| (square(a, b).sqrt() / far).powi(3);
    let size = count + dimensions + 1;
    let mut matrix = DMatrix::<f64>::zeros(size, size);
    let mut right = DVector::<f64>::zeros(size);
    for i in 0..count {
        for j in 0..i {
            let value = radial(points[i], points[j]);
            (matrix[(i, j)], matrix[(j, i)]) = (value, value);
        }
        (matrix[(i, count)], matrix[(count, i)]) = (1.0, 1.0);
        for n in 0..dimensions {
            let value = (points[i][n] - at[n]) / far;
            (matrix[(i, count + 1 + n)], matrix[(count + 1 + n, i)]) = (value, value);
        }
        right[i] = radial(points[i], at);
    }
    right[count] = 1.0;
    if !matrix.lu().solve_mut(&mut right) {
        return None;
    }
    let all: Vec<f64> = right.iter().take(count).copied().collect();
    let size: f64 = all.iter().map(|weight| weight.abs()).sum();
    let sum: f64 = all.iter().sum();
    (size < WILD && (sum - 1.0).abs() < 1e-6).then_some(all)
}

/// The nearest points' weights by the inverse square of their distance.
pub(super) fn by_distance(squares: &[f64]) -> Vec<f64> {
    let weight = |square: &f64| 1.0 / square.max(1e-24);
    let all: f64 = squares.iter().map(weight).sum();
    squares.iter().map(|square| weight(square) / all).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points() -> Vec<[f64; 3]> {
        (0..20).map(|n| [n * n % 7, n * n * n % 11, n * 5 % 13].map(|x| f64::from(x) / 10.0)).collect()
    }

    /// Truth: what is linear is met exactly, and at a point its own value is.
    #[test]
    fn lines_are_held_and_points_met() {
        let all = points();
        let some: Vec<&[f64]> = all.iter().map(|point| &point[..]).collect();
        let value = |point: &[f64]| 2.0 + point[0] - 3.0 * point[1] + 0.5 * point[2];
        let at = [0.33, 0.41, 0.72];
        let told = weights(&at, &some).expect("they tell");
        let sum: f64 = told.iter().zip(&some).map(|(weight, point)| weight * value(point)).sum();
        assert!((sum - value(&at)).abs() < 1e-12, "{sum}");
        let own = weights(&all[4], &some).expect("they tell");
        assert!((own[4] - 1.0).abs() < 1e-9, "{own:?}");
    }

    #[test]
    fn points_in_a_plane_do_not_tell() {
        let flat: Vec<[f64; 3]> = points().into_iter().map(|[x, y, _]| [x, y, 0.5]).collect();
        let some: Vec<&[f64]> = flat.iter().map(|point| &point[..]).collect();
        assert!(weights(&[0.3, 0.4, 0.5], &some).is_none_or(|all| all.iter().all(|one| one.is_finite())));
        assert!(weights(&[0.3, 0.4, 0.5], &some[..3]).is_none());
    }
}

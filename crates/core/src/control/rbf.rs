//! Interpolation weights of scattered points: radial functions r^3 with a linear part, through the nearest points alone
//! (Wendland, Scattered Data Approximation, 2005, section 8.5).

/// Largest sum of absolute weights. With more, the points do not support a prediction.
const MAX_WEIGHT_SUM: f64 = 8.0;

/// Weights of points, given by their coordinates, for the value at `at`; they sum to one. None if the points do not determine
/// it.
pub(super) fn weights(at: &[f64], points: &[&[f64]]) -> Option<Vec<f64>> {
    let (count, dimensions) = (points.len(), at.len());
    let square = |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum() };
    let far = points.iter().map(|point| square(point, at)).fold(0.0, f64::max).sqrt();
    if far.is_nan() || far == 0.0 || count <= dimensions {
        return None;
    }
    let radial = |a: &[f64], b: &[f64]| {
        let square = square(a, b) / (far * far);
        square * square.sqrt()
    };
    let size = count + dimensions + 1;
    // The matrix by rows, with the right side at the end of each row.
    let wide = size + 1;
    let mut rows = vec![0.0; size * wide];
    for i in 0..count {
        for j in 0..i {
            let value = radial(points[i], points[j]);
            (rows[i * wide + j], rows[j * wide + i]) = (value, value);
        }
        (rows[i * wide + count], rows[count * wide + i]) = (1.0, 1.0);
        for n in 0..dimensions {
            let value = (points[i][n] - at[n]) / far;
            let m = count + 1 + n;
            (rows[i * wide + m], rows[m * wide + i]) = (value, value);
        }
        rows[i * wide + size] = radial(points[i], at);
    }
    rows[count * wide + size] = 1.0;
    let mut all = solve_dense(rows, size)?;
    all.truncate(count);
    let size: f64 = all.iter().map(|weight| weight.abs()).sum();
    let sum: f64 = all.iter().sum();
    (size < MAX_WEIGHT_SUM && (sum - 1.0).abs() < 1e-6).then_some(all)
}

/// Solves `size` linear equations, given by rows with the right side last, by elimination in place with partial pivoting.
/// None if the matrix is singular.
fn solve_dense(mut rows: Vec<f64>, size: usize) -> Option<Vec<f64>> {
    let wide = size + 1;
    for k in 0..size {
        let larger =
            |a: usize, b: usize| if rows[b * wide + k].abs() > rows[a * wide + k].abs() { b } else { a };
        let pivot = (k + 1..size).fold(k, larger);
        let largest = rows[pivot * wide + k];
        if largest == 0.0 || !largest.is_finite() {
            return None;
        }
        let (above, below) = rows.split_at_mut((k + 1) * wide);
        let own = &mut above[k * wide..];
        if pivot != k {
            own.swap_with_slice(&mut below[(pivot - k - 1) * wide..][..wide]);
        }
        for row in below.chunks_exact_mut(wide) {
            let factor = row[k] / largest;
            row[k..].iter_mut().zip(&own[k..]).for_each(|(value, own)| *value -= factor * own);
        }
    }
    let mut all = vec![0.0; size];
    for k in (0..size).rev() {
        let row = &rows[k * wide..][..wide];
        let known: f64 = row[k + 1..size].iter().zip(&all[k + 1..]).map(|(a, b)| a * b).sum();
        all[k] = (row[size] - known) / row[k];
    }
    Some(all)
}

/// Weights by the inverse square of the distance, from squared distances; they sum to one.
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

    /// Truth: linear functions are exact, and at a point its own value is.
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

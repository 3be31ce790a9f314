//! Legendre polynomials and Gauss-Legendre points: the raw material of the hierarchical elements.

/// `P_0(x) ..= P_degree(x)` by the three-term recurrence, stable on [-1, 1].
pub(crate) fn legendre(degree: usize, x: f64) -> Vec<f64> {
    let mut values = Vec::with_capacity(degree + 1);
    values.push(1.0);
    if degree >= 1 {
        values.push(x);
    }
    for n in 2..=degree {
        let nf = n as f64;
        values.push(((2.0 * nf - 1.0) * x * values[n - 1] - (nf - 1.0) * values[n - 2]) / nf);
    }
    values
}

/// The `count` Gauss-Legendre points of [-1, 1] with their weights: exact up to degree `2 count - 1`.
pub(crate) fn gauss(count: usize) -> Vec<(f64, f64)> {
    let n = count as f64;
    (0..count)
        .map(|i| {
            // Tricomi's estimate lies so close that Newton ends in three or four steps.
            let theta = std::f64::consts::PI * (i as f64 + 0.75) / (n + 0.5);
            let mut x = theta.cos() * (1.0 - (n - 1.0) / (8.0 * n.powi(3)));
            for _ in 0..8 {
                let (value, slope) = value_and_slope(count, x);
                let step = value / slope;
                x -= step;
                if step.abs() < 1e-16 {
                    break;
                }
            }
            let (_, slope) = value_and_slope(count, x);
            (x, 2.0 / ((1.0 - x * x) * slope * slope))
        })
        .collect()
}

fn value_and_slope(n: usize, x: f64) -> (f64, f64) {
    let p = legendre(n, x);
    let below = if n == 0 { 0.0 } else { p[n - 1] };
    (p[n], n as f64 * (x * p[n] - below) / (x * x - 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn closed_form_gauss_points_integrate_powers_up_to_their_degree() {
        for count in [1, 2, 5, 12, 31] {
            let points = gauss(count);
            for power in 0..2 * count {
                let sum: f64 = points.iter().map(|(x, w)| w * x.powi(power as i32)).sum();
                let exact = if power % 2 == 0 { 2.0 / (power as f64 + 1.0) } else { 0.0 };
                assert!((sum - exact).abs() < 5e-15, "{count} points, x^{power}: {sum} is not {exact}");
            }
        }
    }
}

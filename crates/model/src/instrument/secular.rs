//! Eigenpairs of a diagonal matrix that one more row, or a sum of rank one, couples.
//!
//! Of an arrowhead, the diagonal `d` with the row `a` beside and `h` in its corner, the eigenvalues are the roots of
//! `x - h = sum of a_k^2/(x - d_k)`; of `diag(d) + t a a^T` those of `1/t = sum of a_k^2/(x - d_k)`. Between two
//! neighbours among the `d_k` lies exactly one. Each is sought as its distance from the nearest of them, so that it keeps
//! its digits however near it lies, and so do the differences of which the eigenvectors are made
//! (Gu & Eisenstat, SIAM J. Matrix Anal. Appl. 16 (1995) 172).

use nalgebra::DVectorView;

/// `slope x - constant`, which the sum of the `a_k^2/(x - d_k)` has to equal.
#[derive(Clone, Copy, Debug)]
pub(super) struct Line {
    slope: f64,
    constant: f64,
}

impl Line {
    /// Of an arrowhead with `corner` in its corner.
    pub fn arrowhead(corner: f64) -> Self {
        Self { slope: 1.0, constant: corner }
    }

    /// Of `factor` times `a a^T`, positive, added.
    pub fn rank_one(factor: f64) -> Self {
        Self { slope: 0.0, constant: -1.0 / factor }
    }
}

/// An eigenvalue and its vector of unit length.
#[derive(Clone, Debug)]
pub(super) struct SecularPair {
    pub value: f64,
    /// The component beside the corner; 0 where there is none.
    pub corner: f64,
    /// In the order of the `d_k`.
    pub rest: Vec<f64>,
    /// By how much the pair misses its equation, beside the eigenvalue.
    pub residual: f64,
    /// What the components are `a_k/(x - d_k)` times, 0 where nothing couples them, and the function's value times that.
    scale: f64,
    missed: f64,
}

/// Poles nearer to each other than so many units in the last place are one: the error is no larger than theirs.
const SAME: f64 = 4.0 * f64::EPSILON;
/// More than enough: each interval is met by a quadratic first, and halved where Newton's step leaves it.
const ROUNDS: usize = 200;
/// A step of Newton's that is shorter, relative, is the last: what it leaves goes with its square.
const LAST: f64 = 1e-9;

/// All eigenpairs, largest eigenvalue first.
pub(super) fn pairs(line: Line, d: &[f64], a: &[f64]) -> Vec<SecularPair> {
    let mut order: Vec<usize> = (0..d.len()).collect();
    order.sort_by(|&i, &j| d[i].total_cmp(&d[j]));
    let mut found = Vec::with_capacity(d.len() + 1);
    let mut snapped = d.to_vec();
    let (mut poles, mut weights) = (Vec::with_capacity(d.len()), Vec::with_capacity(d.len()));
    let mut from = 0;
    while from < order.len() {
        let pole = d[order[from]];
        // At least itself, whatever number it is.
        let same = order[from..].iter().take_while(|&&k| d[k] - pole <= SAME * d[k].abs()).count().max(1);
        let group = &order[from..from + same];
        group.iter().for_each(|&k| snapped[k] = pole);
        let weight: f64 = group.iter().map(|&k| a[k] * a[k]).sum();
        if weight > 0.0 {
            poles.push(pole);
            weights.push(weight);
        }
        uncoupled(group, pole, a, &mut found);
        from += same;
    }
    let sum = Sum::new(line, poles, weights);
    found.extend(sum.roots().into_iter().map(|root| sum.pair(root, &snapped, a)));
    found.sort_by(|one, other| other.value.total_cmp(&one.value));
    found
}

/// Of each pair, largest eigenvalue first, the largest |p_i.M p_j - delta_ij| against those before it and itself, each `p` being
/// of unit length in the diagonal's metric `M`.
///
/// Of vectors whose components are `a_k c/(x - d_k)` the product is `c_i c_j (F(x_i) - F(x_j))/(x_i - x_j)`, F being the
/// function whose roots are sought: so it follows from what the roots miss, and of vectors of unit length nothing else does.
pub(super) fn orthonormality(pairs: &[SecularPair]) -> Vec<f64> {
    let with = |one: &SecularPair, other: &SecularPair| {
        // Those that nothing couples are at right angles to all others.
        let apart = if one.scale * other.scale == 0.0 { f64::INFINITY } else { one.value - other.value };
        (one.missed * other.scale - other.missed * one.scale) / apart
    };
    let of = |(k, one): (usize, &SecularPair)| {
        let against =
            pairs[..k].iter().map(|other| ((other.value / one.value).sqrt() * with(one, other)).abs());
        against.fold(pairs.len() as f64 * f64::EPSILON, f64::max)
    };
    pairs.iter().enumerate().map(of).collect()
}

pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    DVectorView::from_slice(a, a.len()).dot(&DVectorView::from_slice(b, b.len()))
}

/// The vectors of a group of equal `d_k` that are at right angles to its `a_k`: nothing couples them.
fn uncoupled(group: &[usize], pole: f64, a: &[f64], found: &mut Vec<SecularPair>) {
    let mut before = 0.0;
    for (n, &k) in group.iter().enumerate() {
        let own = a[k] * a[k];
        let mut rest = vec![0.0; a.len()];
        if own == 0.0 {
            rest[k] = 1.0;
        } else if before > 0.0 {
            let norm = (before * (before + own)).sqrt();
            group[..n].iter().filter(|&&i| a[i] * a[i] > 0.0).for_each(|&i| rest[i] = a[i] * a[k] / norm);
            rest[k] = -before / norm;
        }
        if own == 0.0 || before > 0.0 {
            found.push(SecularPair {
                value: pole,
                corner: 0.0,
                rest,
                residual: 0.0,
                scale: 0.0,
                missed: 0.0,
            });
        }
        before += own;
    }
}

/// A root: so far from that pole.
#[derive(Clone, Copy)]
struct Root {
    pole: f64,
    off: f64,
}

/// `slope x - constant - sum of weight/(x - pole)`, rising between its rising poles.
struct Sum {
    line: Line,
    poles: Vec<f64>,
    weights: Vec<f64>,
    /// Both by fours, which are summed side by side: one after the other, each addition would wait for the last. The
    /// last four are filled up with poles at infinity.
    blocks: Vec<([f64; 4], [f64; 4])>,
}

impl Sum {
    fn new(line: Line, poles: Vec<f64>, weights: Vec<f64>) -> Self {
        let four = |(poles, weights): (&[f64], &[f64])| {
            let mut block = ([f64::INFINITY; 4], [0.0; 4]);
            block.0[..poles.len()].copy_from_slice(poles);
            block.1[..weights.len()].copy_from_slice(weights);
            block
        };
        let blocks = poles.chunks(4).zip(weights.chunks(4)).map(four).collect();
        Self { line, poles, weights, blocks }
    }

    fn roots(&self) -> Vec<Root> {
        let count = self.poles.len();
        let Line { slope, constant } = self.line;
        if count == 0 {
            return if slope > 0.0 { vec![Root { pole: constant, off: 0.0 }] } else { Vec::new() };
        }
        let total: f64 = self.weights.iter().sum();
        let (first, last) = (self.poles[0], self.poles[count - 1]);
        let mut roots = Vec::with_capacity(count + 1);
        if slope > 0.0 {
            roots.push(self.beside(0, -1.0, (first - constant).max(0.0) + total.sqrt(), None));
        }
        for n in 1..count {
            let gap = self.poles[n] - self.poles[n - 1];
            let (value, ..) = self.at(n - 1, 0.5 * gap);
            let (near, side, other) = if value >= 0.0 { (n - 1, 1.0, n) } else { (n, -1.0, n - 1) };
            roots.push(self.beside(near, side, 0.5 * gap, Some((gap, self.weights[other], value))));
        }
        let reach = if slope > 0.0 { (constant - last).max(0.0) + total.sqrt() } else { -total / constant };
        roots.push(self.beside(count - 1, 1.0, reach, None));
        roots
    }

    /// Its value, slope and the size of its terms at the distance `t` from a pole.
    fn at(&self, near: usize, t: f64) -> (f64, f64, f64) {
        let pole = self.poles[near];
        let Line { slope, constant } = self.line;
        let line = (slope * pole - constant) + slope * t;
        let (mut value, mut rise, mut size) = ([0.0; 4], [0.0; 4], [0.0; 4]);
        for (poles, weights) in &self.blocks {
            for n in 0..4 {
                let over = 1.0 / ((pole - poles[n]) + t);
                let term = weights[n] * over;
                value[n] += term;
                rise[n] += term * over;
                size[n] += term.abs();
            }
        }
        let sum = |all: [f64; 4]| (all[0] + all[1]) + (all[2] + all[3]);
        (line - sum(value), slope + sum(rise), sum(size) + (slope * pole).abs() + constant.abs())
    }

    /// The root on that side of a pole, at most `reach` away. `between` is of one between two poles: how far they are
    /// from each other, the other's weight, and the value in the middle.
    fn beside(&self, near: usize, side: f64, reach: f64, between: Option<(f64, f64, f64)>) -> Root {
        let (mut low, mut high) = (0.0, reach);
        let mut s = self.guess(near, side, reach, between);
        for _ in 0..ROUNDS {
            if !(s > low && s < high) {
                // By decades where it may be anywhere, else by halves.
                s = if 4.0 * low < high { (low.max(1e-9 * high) * high).sqrt() } else { 0.5 * (low + high) };
                if !(s > low && s < high) {
                    break;
                }
            }
            let (value, rise, size) = self.at(near, side * s);
            let value = side * value;
            if value < 0.0 {
                low = s
            } else {
                high = s
            }
            if value.abs() <= 0.5 * f64::EPSILON * size {
                break;
            }
            // Newton's step for what is left when both poles are multiplied away.
            let away = 1.0 / s - between.map_or(0.0, |(gap, ..)| 1.0 / (gap - s));
            let step = value / (rise + value * away);
            let next = s - step;
            let ends = (next - s).abs() <= LAST * s;
            s = next;
            if ends && s > low && s < high {
                break;
            }
        }
        Root { pole: self.poles[near], off: side * s }
    }

    /// Where the root would be if all poles but the two that it lies between were far.
    fn guess(&self, near: usize, side: f64, reach: f64, between: Option<(f64, f64, f64)>) -> f64 {
        let own = self.weights[near];
        let (square, linear) = match between {
            // c s (s - gap) - own (s - gap) - other s = 0
            Some((gap, other, value)) => {
                let c = side * value + (own - other) / (0.5 * gap);
                (-c / gap, c + (own + other) / gap)
            }
            None => {
                let (value, ..) = self.at(near, side * reach);
                let slope = self.line.slope;
                (slope, side * value + own / reach - slope * reach)
            }
        };
        // square s^2 + linear s - own = 0, its positive root.
        let root = (linear * linear + 4.0 * square * own).max(0.0).sqrt();
        2.0 * own / (linear + root)
    }

    /// The eigenpair of a root.
    fn pair(&self, root: Root, d: &[f64], a: &[f64]) -> SecularPair {
        let quotient =
            |(a, d): (&f64, &f64)| if a * a == 0.0 { 0.0 } else { a / ((root.pole - d) + root.off) };
        let mut rest: Vec<f64> = a.iter().zip(d).map(quotient).collect();
        let norm = dot(&rest, &rest) + self.line.slope;
        let scale = 1.0 / norm.sqrt();
        rest.iter_mut().for_each(|y| *y *= scale);
        let value = root.pole + root.off;
        let Line { slope, constant } = self.line;
        let missed = ((slope * root.pole - constant) + slope * root.off) * scale - dot(&rest, a);
        // Of a sum of rank one every row misses by the factor times its `a_k`.
        let rows = if slope > 0.0 { 1.0 } else { self.weights.iter().sum::<f64>().sqrt() / -constant };
        SecularPair {
            value,
            corner: slope * scale,
            rest,
            residual: (missed * rows / value).abs(),
            scale,
            missed,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, SymmetricEigen};

    /// A number in [0, 1) that follows from these.
    fn share(number: usize, place: usize) -> f64 {
        let mixed = (number as f64 * 12.9898 + place as f64 * 78.233).sin() * 43758.5453;
        mixed - mixed.floor()
    }

    /// Poles over four decades, equal ones, rows that couple strongly, by a millionth or not at all.
    fn case(number: usize) -> (Vec<f64>, Vec<f64>) {
        let count = 1 + number % 40;
        let mut d: Vec<f64> = (0..count).map(|k| 1e-4f64.powf(share(number, k))).collect();
        if number.is_multiple_of(3) && count > 4 {
            (d[1], d[3], d[4]) = (d[0], d[2], d[2]);
        }
        let size = if number.is_multiple_of(2) { 0.3 } else { 1e-6 };
        let row = |k: usize| {
            if number.is_multiple_of(5) && k % 4 == 1 { 0.0 } else { size * (share(number, 100 + k) - 0.5) }
        };
        (d, (0..count).map(row).collect())
    }

    /// The dense matrix with these eigenpairs: values as nalgebra finds them, vectors of unit length that meet it.
    fn agrees(number: usize, dense: &DMatrix<f64>, found: &[SecularPair], corner: bool) {
        let mut exact = SymmetricEigen::new(dense.clone()).eigenvalues.as_slice().to_vec();
        exact.sort_by(|a, b| b.total_cmp(a));
        assert_eq!(found.len(), exact.len());
        let scale = dense.amax();
        for (pair, exact) in found.iter().zip(exact) {
            assert!((pair.value - exact).abs() < 1e-13 * scale, "{number}: {} is not {exact}", pair.value);
            let vector = pair.rest.iter().copied().chain(corner.then_some(pair.corner));
            let vector = nalgebra::DVector::from_vec(vector.collect());
            let missed = (dense * &vector - pair.value * &vector).norm();
            assert!(missed < 1e-13 * scale, "{number}: a vector misses by {missed:e}");
        }
        let told = orthonormality(found);
        for (k, one) in found.iter().enumerate() {
            let direct = found[..=k].iter().map(|other| {
                let product = dot(&one.rest, &other.rest) + one.corner * other.corner;
                let own = f64::from(u8::from(std::ptr::eq(one, other)));
                ((other.value / one.value).sqrt() * (product - own)).abs()
            });
            let direct = direct.fold(0.0, f64::max);
            let rounding = 1e-14 * (found[0].value / one.value).sqrt();
            assert!(direct < 1e-10, "{number}: vectors at angles off by {direct:e}");
            assert!((direct - told[k]).abs() < rounding, "{number}: {direct:e}, told as {:e}", told[k]);
        }
    }

    #[test]
    fn arrowheads_have_the_pairs_of_a_dense_solver() {
        for number in 0..300 {
            let (d, a) = case(number);
            let n = d.len();
            let corner = 0.7 + share(number, 999);
            let mut dense =
                DMatrix::from_diagonal(&nalgebra::DVector::from_vec(d.clone())).resize(n + 1, n + 1, 0.0);
            dense[(n, n)] = corner;
            for (k, a) in a.iter().enumerate() {
                (dense[(k, n)], dense[(n, k)]) = (*a, *a);
            }
            // Positive, as a mass matrix is: the corner outweighs what pulls on it.
            let load: f64 = a.iter().zip(&d).map(|(a, d)| a * a / d).sum();
            if load < 0.9 * corner {
                agrees(number, &dense, &pairs(Line::arrowhead(corner), &d, &a), true);
            }
        }
    }

    #[test]
    fn sums_of_rank_one_have_the_pairs_of_a_dense_solver() {
        for number in 0..300 {
            let (d, a) = case(number);
            for factor in [1e-12, 0.3, 1e4] {
                let row = nalgebra::DVector::from_vec(a.clone());
                let dense = DMatrix::from_diagonal(&nalgebra::DVector::from_vec(d.clone()))
                    + factor * &row * row.transpose();
                agrees(number, &dense, &pairs(Line::rank_one(factor), &d, &a), false);
            }
        }
    }

    /// Next to a pole the root's distance from it is known to rounding: `a^2/(pole - corner)` of the first order.
    #[test]
    fn closed_form_root_beside_a_pole_keeps_its_digits() {
        for a in [1e-3f64, 1e-9, 1e-40, 1e-120] {
            let found = pairs(Line::arrowhead(2.0), &[1.0], &[a]);
            // x^2 - 3 x + 2 - a^2 = 0
            let below = 2.0 * a * a / (1.0 + (1.0 + 4.0 * a * a).sqrt());
            assert!((found[1].value - (1.0 - below)).abs() <= f64::EPSILON);
            assert!(
                (found[1].corner.abs() / a - 1.0).abs() < 2.0 * a * a + 1e-14,
                "{a}: {}",
                found[1].corner
            );
            assert!(
                (found[0].rest[0].abs() / a - 1.0).abs() < 2.0 * a * a + 1e-14,
                "{a}: {}",
                found[0].rest[0]
            );
        }
    }
}

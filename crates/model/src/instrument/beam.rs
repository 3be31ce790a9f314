//! The lever as an Euler-Bernoulli beam with a rigid tip, relative to its base.
//!
//! Ha, Fung & Chen 2005, equations (2) to (7): the tip of mass `m` has its centre a distance `l`
//! beyond the beam's end, and moves by `W + l W_x` there, which is also where the sample's force
//! acts. Dimensionless: length, `E I / l_b^3` and the beam's mass are 1.

use nalgebra::{DMatrix, DVector};

use super::legendre::{gauss, legendre};

/// A beam in coordinates of unit stiffness, dimensionless.
#[derive(Clone, Debug)]
pub(crate) struct UnitBeam {
    pub mass: DMatrix<f64>,
    /// Inertial coupling to a translation of the base, M r.
    pub base: DVector<f64>,
    /// Travel of the tip, `v + l v_x` at the end.
    pub tip: DVector<f64>,
}

impl UnitBeam {
    /// A beam of `elements` equal elements of degree `order` (at least 3) that carries
    /// `tip_mass` (in beam masses) at `arm` (in beam lengths) beyond its end.
    ///
    /// None if the numbers leave the range in which the stiffness can be factored.
    pub fn new(elements: usize, order: usize, tip_mass: f64, arm: f64) -> Option<Self> {
        let (k, mut m, mut base) = unit_cantilever(elements, order);
        let mut tip = DVector::zeros(k.nrows());
        let end = 2 * (elements - 1);
        tip[end] = 1.0;
        // The slope unknowns are h v_x: of the size of the travel, whatever the mesh.
        tip[end + 1] = arm * elements as f64;
        m.ger(tip_mass, &tip, &tip, 1.0);
        base.axpy(tip_mass, &tip, 1.0);
        let (mass, mut rows) = unit_stiffness(k, &m, &[&base, &tip])?;
        let tip = rows.pop()?;
        let base = rows.pop()?;
        Some(Self { mass, base, tip })
    }
}

/// Turns `(K, M)` into coordinates `y = L^T q`, `K = L L^T`, of unit stiffness: gives
/// `L^-1 M L^-T` and `L^-1 row` for each row. The largest eigenvalues of that mass matrix are
/// the slowest modes, which therefore come out to machine precision. None unless K > 0.
pub(crate) fn unit_stiffness(
    k: DMatrix<f64>,
    m: &DMatrix<f64>,
    rows: &[&DVector<f64>],
) -> Option<(DMatrix<f64>, Vec<DVector<f64>>)> {
    let l = k.cholesky()?.unpack();
    let half = l.solve_lower_triangular(m)?;
    let mut mass = l.solve_lower_triangular(&half.transpose())?;
    let n = mass.nrows();
    for i in 0..n {
        for j in 0..i {
            let mean = 0.5 * (mass[(i, j)] + mass[(j, i)]);
            mass[(i, j)] = mean;
            mass[(j, i)] = mean;
        }
    }
    let rows = rows.iter().map(|r| l.solve_lower_triangular(*r)).collect::<Option<Vec<_>>>()?;
    Some((mass, rows))
}

/// What leaving out unknowns that hold the part `left_out` of a mode's strain energy adds to its frequency, relative, at most:
/// the quotient of Rayleigh of the shape without them. The unknowns of a degree are among those of the next, and what they
/// weigh by themselves is nothing beside a mode that has converged, so it is no more than a little too much.
pub(crate) fn change(left_out: f64) -> f64 {
    if left_out < 0.5 { 0.5 * left_out / (1.0 - left_out) } else { f64::INFINITY }
}

/// The part of `y.y` that the two highest degrees of each element have: the last two of its bubbles, which follow the unknowns
/// of the nodes. The stiffness is diagonal in bubbles, so they are the same unknowns in coordinates of unit stiffness.
pub(crate) fn highest(y: &[f64], of_nodes: usize, elements: usize) -> f64 {
    let bubbles = (y.len() - of_nodes) / elements;
    if bubbles < 2 {
        // Without these no element is left.
        return 1.0;
    }
    let last = y[of_nodes..].chunks(bubbles).flat_map(|all| &all[bubbles - 2..]);
    last.map(|one| one * one).sum()
}

/// Stiffness, mass and base coupling of the clamped beam without a tip.
///
/// Unknowns: travel and h times slope of nodes 1..=elements, then `order - 3` bubbles per
/// element. The bubble of degree k is `P_{k-2}` integrated twice: its value and slope vanish
/// at both ends, and the stiffness is diagonal beyond the nodes.
fn unit_cantilever(elements: usize, order: usize) -> (DMatrix<f64>, DMatrix<f64>, DVector<f64>) {
    let n = elements * (order - 1);
    let h = 1.0 / elements as f64;
    let mut k = DMatrix::zeros(n, n);
    let mut m = DMatrix::zeros(n, n);
    let mut base = DVector::zeros(n);
    let (element_mass, element_base) = element_mass(order);
    let hermite =
        [[12.0, 6.0, -12.0, 6.0], [6.0, 4.0, -6.0, 2.0], [-12.0, -6.0, 12.0, -6.0], [6.0, 2.0, -6.0, 4.0]];
    for e in 0..elements {
        let place = |i: usize| match i {
            0 | 1 => (2 * e + i).checked_sub(2),
            2 | 3 => Some(2 * e + i - 2),
            bubble => Some(2 * elements + e * (order - 3) + bubble - 4),
        };
        for i in 0..=order {
            let Some(row) = place(i) else { continue };
            // Each element's share of M r, where r (a translation of everything) includes the base node.
            base[row] += element_base[i] * h / 2.0;
            for j in 0..=order {
                let Some(column) = place(j) else { continue };
                m[(row, column)] += element_mass[(i, j)] * h / 2.0;
                k[(row, column)] += match (i, j) {
                    (0..=3, 0..=3) => hermite[i][j] / h.powi(3),
                    _ if i == j => 16.0 / (h.powi(3) * (2.0 * i as f64 - 3.0)),
                    _ => 0.0,
                };
            }
        }
    }
    (k, m, base)
}

/// Integrals over [-1, 1] of the products of the element's shapes, and of the shapes themselves.
fn element_mass(order: usize) -> (DMatrix<f64>, DVector<f64>) {
    let mut mass = DMatrix::zeros(order + 1, order + 1);
    let mut base = DVector::zeros(order + 1);
    for (x, weight) in gauss(order + 1) {
        let p = legendre(order, x);
        let s = 0.5 * (1.0 + x);
        let r = 1.0 - s;
        let mut shape = vec![r * r * (1.0 + 2.0 * s), s * r * r, s * s * (1.0 + 2.0 * r), -s * s * r];
        shape.extend((4..=order).map(|k| {
            let kf = 2.0 * k as f64;
            ((p[k] - p[k - 2]) / (kf - 1.0) - (p[k - 2] - p[k - 4]) / (kf - 5.0)) / (kf - 3.0)
        }));
        let shape = DVector::from_vec(shape);
        mass.ger(weight, &shape, &shape, 1.0);
        base.axpy(weight, &shape, 1.0);
    }
    (mass, base)
}

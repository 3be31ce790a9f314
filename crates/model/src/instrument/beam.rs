//! The lever as an Euler-Bernoulli beam with a rigid tip, relative to its base.
//!
//! Ha, Fung & Chen 2005, equations (2) to (7): the tip of mass `m` has its centre a distance `l`
//! beyond the beam's end, and moves by `W + l W_x` there, which is also where the sample's force
//! acts. Dimensionless: length, `E I / l_b^3` and the beam's mass are 1.

use nalgebra::{DMatrix, DVector};
use std::sync::Arc;

use super::instrument_error::InstrumentError;
use super::unit_modes::{MeshCache, UnitModes};
use crate::legendre::{gauss, legendre};

/// The clamped beam without a tip as its own modes of unit stiffness, dimensionless.
#[derive(Clone, Debug)]
pub(crate) struct UnitBeam {
    pub modes: UnitModes,
    /// Inertial coupling to a translation of the base, M r.
    pub base: Vec<f64>,
    /// Travel of the free end, and its slope.
    pub end: Vec<f64>,
    pub slope: Vec<f64>,
}

impl UnitBeam {
    /// Of `elements` equal elements of degree `order` (at least 3); each is solved for once.
    ///
    /// # Errors
    /// A stiffness that cannot be factored.
    pub fn on(elements: usize, order: usize) -> Result<Arc<Self>, InstrumentError> {
        static KNOWN: MeshCache<UnitBeam> = MeshCache::new();
        KNOWN.on(elements, order, || {
            let (k, m, base) = unit_cantilever(elements, order);
            let row = |at: usize, value: f64| {
                let mut row = DVector::zeros(k.nrows());
                row[at] = value;
                row
            };
            let at = 2 * (elements - 1);
            // The slope unknowns are h v_x: of the size of the travel, whatever the mesh.
            let (end, slope) = (row(at, 1.0), row(at + 1, elements as f64));
            let (modes, mut rows) = UnitModes::of(k, &m, &[&base, &end, &slope], (2 * elements, elements))?;
            let mut next = || rows.remove(0);
            Ok(Self { modes, base: next(), end: next(), slope: next() })
        })
    }
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

//! The modes of a part whose elements say everything: a bar, a beam, of length, stiffness and mass 1.
//!
//! Every rod is the same bar and every lever the same beam but for scale, ends and coupling, so the dense eigenproblem of a
//! mesh is solved once in a process; what an instrument is beyond that, `secular.rs` finds from these modes.

use nalgebra::{DMatrix, DVector};
use std::collections::HashMap;
use std::sync::{Arc, LazyLock, PoisonError, RwLock};

use super::eigen::Eigen;
use super::instrument_error::InstrumentError;

/// Modes in coordinates of unit stiffness, slowest first.
#[derive(Clone, Debug)]
pub(crate) struct UnitModes {
    /// 1/omega^2
    pub mu: Vec<f64>,
    /// What each mode has of the two highest degrees of each element, a row for each of these unknowns: the sum of their
    /// squares is the part of a shape's strain energy that is in them.
    pub high: DMatrix<f64>,
    pub quality: Vec<Quality>,
}

/// How well a mode meets its equation.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Quality {
    /// |K p - omega^2 M p| / |K p|
    pub residual: f64,
    /// Largest |p_i.M p_j - delta_ij| against the slower modes and itself.
    pub orthonormality: f64,
}

impl Quality {
    /// Of a mode that nobody looked at.
    pub const UNKNOWN: Self = Self { residual: f64::INFINITY, orthonormality: f64::INFINITY };

    /// By how much a mode with that `mu` misses its equations, not relative to it.
    pub fn absolute(&self, mu: f64) -> [f64; 2] {
        [mu * self.residual, mu.sqrt() * self.orthonormality]
    }

    /// Of a shape `y` of parts' modes that miss theirs by so much ([`Quality::absolute`]), and that misses its own by `own`.
    pub fn of_sum(own: Self, value: f64, y: &[f64], parts: &[[f64; 2]]) -> Self {
        let add = |sum: [f64; 2], (y, part): (&f64, &[f64; 2])| {
            [sum[0] + y.abs() * part[0], sum[1] + y.abs() * part[1]]
        };
        let [residual, orthonormality] = y.iter().zip(parts).fold([0.0; 2], add);
        Self {
            residual: own.residual + residual / value,
            orthonormality: own.orthonormality + orthonormality / value.sqrt(),
        }
    }
}

impl UnitModes {
    /// The modes of `(K, M)`, and of each row what it is of each mode. The first `of_nodes` unknowns are the nodes', then come
    /// the bubbles of each of the `elements`.
    ///
    /// # Errors
    /// A stiffness that cannot be factored.
    pub fn of(
        k: DMatrix<f64>,
        m: &DMatrix<f64>,
        rows: &[&DVector<f64>],
        (of_nodes, elements): (usize, usize),
    ) -> Result<(Self, Vec<Vec<f64>>), InstrumentError> {
        if k.is_empty() {
            let none = Self { mu: Vec::new(), high: DMatrix::zeros(0, 0), quality: Vec::new() };
            return Ok((none, vec![Vec::new(); rows.len()]));
        }
        let size = k.amax();
        let lost = InstrumentError::OutOfRange { what: "stiffness of an element", value: size };
        let (mass, rows) = unit_stiffness(k, m, rows).ok_or(lost)?;
        let eigen = Eigen::of(&mass)?;
        let quality = eigen.quality(&mass).into_iter();
        let quality =
            quality.map(|(residual, orthonormality)| Quality { residual, orthonormality }).collect();
        let bubbles = (mass.nrows() - of_nodes) / elements;
        // Without two of them no element would be left.
        let last = |e: usize| [2, 1].map(|back| of_nodes + (e + 1) * bubbles - back);
        let high = match bubbles {
            0 | 1 => DMatrix::identity(mass.nrows(), mass.nrows()),
            _ => eigen.vectors.select_rows(&(0..elements).flat_map(last).collect::<Vec<_>>()),
        };
        let along = |row: DVector<f64>| eigen.vectors.tr_mul(&row).as_slice().to_vec();
        let rows = rows.into_iter().map(along).collect();
        Ok((Self { mu: eigen.mu, high, quality }, rows))
    }
}

/// The sum of the squares of what a shape has of each row; `y` is of the modes.
pub(crate) fn in_rows(rows: &DMatrix<f64>, y: &[f64]) -> f64 {
    let count = rows.nrows();
    // A column, which lies in one piece, is what a mode has of each row: four rows at once.
    let of = |from: usize| {
        let to = count.min(from + 4);
        let mut sums = [0.0; 4];
        for (k, y) in y.iter().enumerate() {
            let column = &rows.as_slice()[k * count..][from..to];
            sums.iter_mut().zip(column).for_each(|(sum, row)| *sum += row * y);
        }
        sums.iter().map(|sum| sum * sum).sum::<f64>()
    };
    (0..count).step_by(4).map(of).sum()
}

/// What leaving out unknowns that hold the part `left_out` of a mode's strain energy adds to its frequency, relative, at most:
/// the quotient of Rayleigh of the shape without them. The unknowns of a degree are among those of the next, and what they
/// weigh by themselves is nothing beside a mode that has converged, so it is no more than a little too much.
pub(crate) fn change(left_out: f64) -> f64 {
    if left_out < 0.5 { 0.5 * left_out / (1.0 - left_out) } else { f64::INFINITY }
}

/// Turns `(K, M)` into coordinates `y = L^T q`, `K = L L^T`, of unit stiffness: gives
/// `L^-1 M L^-T` and `L^-1 row` for each row. The largest eigenvalues of that mass matrix are
/// the slowest modes, which therefore come out to machine precision. None unless K > 0.
///
/// The stiffness is diagonal in bubbles, so these are the same unknowns in coordinates of unit stiffness.
fn unit_stiffness(
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

/// Number of elements and degree.
type OnMesh = (usize, usize);

/// Parts by their mesh, each made once.
pub(crate) struct MeshCache<T>(LazyLock<RwLock<HashMap<OnMesh, Arc<T>>>>);

impl<T> MeshCache<T> {
    pub const fn new() -> Self {
        Self(LazyLock::new(RwLock::default))
    }

    /// The one on that mesh, made where it is not known.
    pub fn on(
        &self,
        elements: usize,
        order: usize,
        make: impl FnOnce() -> Result<T, InstrumentError>,
    ) -> Result<Arc<T>, InstrumentError> {
        let key = (elements, order);
        let known = self.0.read().unwrap_or_else(PoisonError::into_inner).get(&key).map(Arc::clone);
        if let Some(known) = known {
            return Ok(known);
        }
        let made = Arc::new(make()?);
        let mut all = self.0.write().unwrap_or_else(PoisonError::into_inner);
        Ok(Arc::clone(all.entry(key).or_insert(made)))
    }
}

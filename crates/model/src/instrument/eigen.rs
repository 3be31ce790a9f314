//! Eigenpairs of a mass matrix in coordinates of unit stiffness.

use super::instrument_error::InstrumentError;
use nalgebra::{DMatrix, SymmetricEigen};

/// Eigenpairs of a mass matrix of unit stiffness, slowest first.
#[derive(Clone, Debug)]
pub(crate) struct Eigen {
    /// 1/omega^2, s^2
    pub mu: Vec<f64>,
    /// Columns of unit length.
    pub vectors: DMatrix<f64>,
}

impl Eigen {
    /// # Errors
    /// Entries that are not finite, and a solver that does not end.
    pub fn of(mass: &DMatrix<f64>) -> Result<Self, InstrumentError> {
        check_finite(mass)?;
        let solved = SymmetricEigen::try_new(mass.clone(), f64::EPSILON, 100 * mass.nrows())
            .ok_or(InstrumentError::OutOfRange { what: "largest mass over stiffness", value: mass.amax() })?;
        let mut order: Vec<usize> = (0..mass.nrows()).collect();
        order.sort_by(|&a, &b| solved.eigenvalues[b].total_cmp(&solved.eigenvalues[a]));
        Ok(Self {
            mu: order.iter().map(|&i| solved.eigenvalues[i]).collect(),
            vectors: solved.eigenvectors.select_columns(&order),
        })
    }

    /// Residual and orthonormality of each pair.
    pub(super) fn quality(&self, mass: &DMatrix<f64>) -> Vec<(f64, f64)> {
        let image = mass * &self.vectors;
        let gram = self.vectors.transpose() * &image;
        (0..self.mu.len())
            .map(|k| {
                let residual = (image.column(k) / self.mu[k] - self.vectors.column(k)).norm();
                let orthonormality = (0..=k).fold(0.0, |worst: f64, i| {
                    let target = if i == k { 1.0 } else { 0.0 };
                    worst.max((gram[(i, k)] / (self.mu[i] * self.mu[k]).sqrt() - target).abs())
                });
                (residual, orthonormality)
            })
            .collect()
    }
}

pub(super) fn check_finite(mass: &DMatrix<f64>) -> Result<(), InstrumentError> {
    match mass.iter().find(|v| !v.is_finite()) {
        Some(&value) => Err(InstrumentError::OutOfRange { what: "mass over stiffness", value }),
        None => Ok(()),
    }
}

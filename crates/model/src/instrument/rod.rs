//! The piezoelectric rod: bar elements with the electrodes' softening spring at the top.
//!
//! Ha, Fung & Chen 2005, equations (5) and (9). No free charge lies between the electrodes at the
//! rod's ends, so the electric displacement is the same all along it,
//! `D = (V + h33 u(l_p)) / (beta33 l_p)`. Put back into the rod's energy this leaves a force
//! `h33 A V / (beta33 l_p)` and a stiffness `-h33^2 A / (beta33 l_p)`, both at the top. Their
//! equation (11) takes a uniform field instead, which differs by 1.6 % in the first frequency;
//! the uniform displacement of (9) is the one that Gauss's law supports, so it is used here.

use nalgebra::{DMatrix, DVector};

use super::beam::{highest, unit_stiffness};
use super::error::InstrumentError;
use super::legendre::{gauss, legendre};
use crate::scene::ActuatorParams;

/// How far above the instability the modulus must lie, relative: closer, the difference is rounding.
const STABILITY_MARGIN: f64 = 1e-9;

/// The rod in coordinates `y` of unit stiffness: energy `y.y/2`, kinetic energy `y'.mass.y'/2`.
#[derive(Clone, Debug)]
pub(crate) struct Rod {
    /// s^2
    pub mass: DMatrix<f64>,
    /// Travel of the top per `y`, m per J^1/2.
    pub top: DVector<f64>,
    /// Force on the top per volt, N/V.
    pub force_per_volt: f64,
    pub quality_factor: f64,
    elements: usize,
}

impl Rod {
    /// The rod on `elements` equal elements of polynomial degree `order` (at least 1).
    ///
    /// # Errors
    /// Impossible dimensions, and a modulus not above `h33^2/beta33` (the rod would collapse).
    pub fn new(p: &ActuatorParams, elements: usize, order: usize) -> Result<Self, InstrumentError> {
        let softening = check(p)?;
        let area = p.width * p.thickness;
        let stiffness = p.youngs_modulus * area / p.length;
        let mass_total = p.density * area * p.length;
        // Dimensionless: length, stiffness and mass 1.
        let (mut k, m) = unit_bar(elements, order);
        let top_index = elements - 1;
        k[(top_index, top_index)] -= softening / p.youngs_modulus;
        let mut top = DVector::zeros(k.nrows());
        top[top_index] = 1.0;
        let (mass, rows) = unit_stiffness(k, &m, &[&top])
            .ok_or(InstrumentError::UnstableRod { youngs_modulus: p.youngs_modulus, softening })?;
        Ok(Self {
            mass: mass * (mass_total / stiffness),
            top: &rows[0] / stiffness.sqrt(),
            force_per_volt: p.h33 * area / (p.beta33 * p.length),
            quality_factor: p.quality_factor,
            elements,
        })
    }

    /// The part of a shape's strain energy that is in the two highest degrees of each element.
    pub fn highest(&self, y: &[f64]) -> f64 {
        highest(y, self.elements, self.elements)
    }

    /// Upper estimate of how many modes of the rod lie below `frequency` (Hz); they are
    /// `c / (2 l_p)` apart, and the softening spring only shifts them by less than one spacing.
    pub fn modes_below(p: &ActuatorParams, frequency: f64) -> f64 {
        (2.0 * p.length * frequency / (p.youngs_modulus / p.density).sqrt() + 1.0).ceil()
    }
}

/// Checks the rod's values and gives its softening `h33^2/beta33`, Pa.
fn check(p: &ActuatorParams) -> Result<f64, InstrumentError> {
    let positive = [
        ("the rod's youngs_modulus", p.youngs_modulus),
        ("the rod's density", p.density),
        ("the rod's beta33", p.beta33),
        ("the rod's length", p.length),
        ("the rod's width", p.width),
        ("the rod's thickness", p.thickness),
    ];
    for (what, value) in positive {
        super::check_positive(what, value)?;
    }
    if !p.h33.is_finite() {
        return Err(InstrumentError::BadValue { what: "the rod's h33", value: p.h33, expected: "finite" });
    }
    super::check_quality("the rod's quality_factor", p.quality_factor)?;
    let softening = p.h33 * p.h33 / p.beta33;
    // The static stiffness of the top is (E - h33^2/beta33) A/l, and the bar alone is stiffer in every
    // other shape: this one comparison decides stability.
    if p.youngs_modulus - softening > STABILITY_MARGIN * p.youngs_modulus {
        Ok(softening)
    } else {
        Err(InstrumentError::UnstableRod { youngs_modulus: p.youngs_modulus, softening })
    }
}

/// Stiffness and mass of a bar of length, stiffness `E A / l` and mass 1, fixed at its start.
///
/// Unknowns: the travel of nodes 1..=elements, then `order - 1` bubbles per element. The bubble
/// of degree k is the integral of `P_{k-1}`, so that stiffness is diagonal beyond the nodes.
fn unit_bar(elements: usize, order: usize) -> (DMatrix<f64>, DMatrix<f64>) {
    let n = elements * order;
    let h = 1.0 / elements as f64;
    let mut k = DMatrix::zeros(n, n);
    let mut m = DMatrix::zeros(n, n);
    let element_mass = element_mass(order);
    for e in 0..elements {
        // Where each of the element's unknowns stands; the fixed end stands nowhere.
        let place = |i: usize| match i {
            0 => e.checked_sub(1),
            1 => Some(e),
            bubble => Some(elements + e * (order - 1) + bubble - 2),
        };
        for i in 0..=order {
            let Some(row) = place(i) else { continue };
            for j in 0..=order {
                let Some(column) = place(j) else { continue };
                m[(row, column)] += element_mass[(i, j)] * h / 2.0;
                k[(row, column)] += match (i, j) {
                    (0, 0) | (1, 1) => 1.0 / h,
                    (0, 1) | (1, 0) => -1.0 / h,
                    _ if i == j => 4.0 / (h * (2.0 * i as f64 - 1.0)),
                    _ => 0.0,
                };
            }
        }
    }
    (k, m)
}

/// Integrals over [-1, 1] of the products of the element's shapes: two linear ones, then bubbles.
fn element_mass(order: usize) -> DMatrix<f64> {
    let mut mass = DMatrix::zeros(order + 1, order + 1);
    for (x, weight) in gauss(order + 1) {
        let p = legendre(order, x);
        let mut shape = vec![0.5 * (1.0 - x), 0.5 * (1.0 + x)];
        shape.extend((2..=order).map(|k| (p[k] - p[k - 2]) / (2.0 * k as f64 - 1.0)));
        let shape = DVector::from_vec(shape);
        mass.ger(weight, &shape, &shape, 1.0);
    }
    mass
}

//! The piezoelectric rod: bar elements with the electrodes' softening spring at the top.
//!
//! Ha, Fung & Chen 2005, equations (5) and (9). No free charge lies between the electrodes at the
//! rod's ends, so the electric displacement is the same all along it,
//! `D = (V + h33 u(l_p)) / (beta33 l_p)`. Put back into the rod's energy this leaves a force
//! `h33 A V / (beta33 l_p)` and a stiffness `-h33^2 A / (beta33 l_p)`, both at the top. Their
//! equation (11) takes a uniform field instead, which differs by 1.6 % in the first frequency;
//! the uniform displacement of (9) is the one that Gauss's law supports, so it is used here.
//!
//! The rod stands as one unknown for its top, in which it is stretched evenly, and the modes that it has with its top held
//! (Craig & Bampton, AIAA J. 6 (1968) 1313, all modes kept): its stiffness has no coupling then, and spring and load at the
//! top change but one number each.

use nalgebra::{DMatrix, DVector};
use std::sync::Arc;

use super::instrument_error::InstrumentError;
use super::secular::{Line, SecularPair, pairs};
use super::unit_modes::{MeshCache, UnitModes, in_rows};
use crate::legendre::{gauss, legendre};
use crate::scene::ActuatorParams;

/// How far above the instability the modulus must lie, relative: closer, the difference is rounding.
const STABILITY_MARGIN: f64 = 1e-9;

/// The rod by the travel of its top and its modes with the top held, these in coordinates of unit stiffness.
#[derive(Clone, Debug)]
pub(crate) struct Rod {
    /// Force on the top per its travel, with the spring of the electrodes, N/m.
    pub stiffness: f64,
    /// What moves with the top, kg.
    pub mass: f64,
    /// 1/omega^2 of the modes with the top held, s^2.
    pub mu: Vec<f64>,
    /// Inertial coupling of the top's travel to each of them, kg^1/2 s.
    pub coupling: Vec<f64>,
    /// Force on the top per volt, N/V.
    pub force_per_volt: f64,
    pub quality_factor: f64,
    unit: Arc<UnitBar>,
}

impl Rod {
    /// The rod on `elements` equal elements of polynomial degree `order` (at least 1).
    ///
    /// # Errors
    /// Impossible dimensions, and a modulus not above `h33^2/beta33` (the rod would collapse).
    pub fn new(p: &ActuatorParams, elements: usize, order: usize) -> Result<Self, InstrumentError> {
        let softening = check(p)?;
        let unit = UnitBar::on(elements, order)?;
        let area = p.width * p.thickness;
        let bar = p.youngs_modulus * area / p.length;
        let mass = p.density * area * p.length;
        let square = mass / bar;
        let scaled = |all: &[f64], scale: f64| -> Vec<f64> { all.iter().map(|one| one * scale).collect() };
        let rod = Self {
            stiffness: bar * (1.0 - softening / p.youngs_modulus),
            mass: mass * unit.mass,
            mu: scaled(&unit.modes.mu, square),
            coupling: scaled(&unit.coupling, mass / bar.sqrt()),
            force_per_volt: p.h33 * area / (p.beta33 * p.length),
            quality_factor: p.quality_factor,
            unit,
        };
        let sizes =
            [("rod's stiffness", rod.stiffness), ("rod's mass", mass), ("rod's mass over stiffness", square)];
        match sizes.into_iter().find(|(_, value)| !(value.is_finite() && *value > 0.0)) {
            Some((what, value)) => Err(InstrumentError::OutOfRange { what, value }),
            None => Ok(rod),
        }
    }

    /// The modes of the rod alone, in coordinates of unit stiffness: the corner is the top.
    pub fn alone(&self) -> Vec<SecularPair> {
        let k = self.stiffness.sqrt();
        let coupling: Vec<f64> = self.coupling.iter().map(|c| c / k).collect();
        pairs(Line::arrowhead(self.mass / self.stiffness), &self.mu, &coupling)
    }

    /// The part of a shape's strain energy that is in the two highest degrees of each element; `y` is of the modes.
    pub fn highest(&self, y: &[f64]) -> f64 {
        in_rows(&self.unit.modes.high, y)
    }

    /// See [`Quality::absolute`], of each of the modes with the top held.
    pub fn misses(&self) -> impl Iterator<Item = [f64; 2]> {
        self.mu.iter().zip(&self.unit.modes.quality).map(|(mu, quality)| quality.absolute(*mu))
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

/// The bar of length, stiffness `E A / l` and mass 1 with its top held, and what couples the top to that.
#[derive(Clone, Debug)]
struct UnitBar {
    modes: UnitModes,
    /// Of the bar stretched evenly by 1.
    mass: f64,
    /// Inertial coupling of that shape to each mode.
    coupling: Vec<f64>,
}

impl UnitBar {
    /// Of `elements` equal elements of degree `order`; each is solved for once.
    fn on(elements: usize, order: usize) -> Result<Arc<Self>, InstrumentError> {
        static KNOWN: MeshCache<UnitBar> = MeshCache::new();
        KNOWN.on(elements, order, || {
            let (k, m) = unit_bar(elements, order);
            let top = elements - 1;
            let stretched = |i: usize, _| if i <= top { (i + 1) as f64 / elements as f64 } else { 0.0 };
            let stretched = DVector::from_fn(k.nrows(), stretched);
            let pulled = &m * &stretched;
            let mass = pulled.dot(&stretched);
            let held = |all: DMatrix<f64>| all.remove_row(top).remove_column(top);
            let (k, m, pulled) = (held(k), held(m), pulled.remove_row(top));
            let (modes, mut rows) = UnitModes::of(k, &m, &[&pulled], (top, elements))?;
            Ok(Self { modes, mass, coupling: rows.remove(0) })
        })
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

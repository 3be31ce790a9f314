//! The lever as a substructure relative to its base, whichever way it was described.
//!
//! All three descriptions of `scene::Lever` end as the same few arrays, so nothing further on
//! knows which was used.

use nalgebra::{DMatrix, DVector};

use super::beam::{UnitBeam, change, highest};
use super::eigen::Eigen;
use super::error::InstrumentError;
use super::{check_not_negative, check_positive, check_quality};
use crate::scene::{InstrumentParams, Lever, LeverMode, QualityFactor, TipMass, TipParams};

/// First root of 1 + cos(x) cosh(x), the clamped-free beam.
const LAMBDA_1: f64 = 1.875_104_068_711_961;

/// Most of the mass that moves in a calibrated lever's first mode that its tip may have.
const TIP_SHARE: f64 = 0.999;
/// Each leaves a tenth of the miss and less.
const HEAVINESS_ROUNDS: usize = 12;

/// The lever in coordinates `y` of unit stiffness: energy `y.y/2`; with the base at `s` its
/// kinetic energy is `y'.mass.y'/2 + s' base.y' + rigid_mass s'^2/2`.
#[derive(Clone, Debug)]
pub(crate) struct LeverPart {
    /// s^2
    pub mass: DMatrix<f64>,
    /// Inertial coupling to the base, M r.
    pub base: DVector<f64>,
    /// What the base carries when everything moves with it, r.M r, kg.
    pub rigid_mass: f64,
    /// Travel of the tip relative to the base, per `y`.
    pub tip: DVector<f64>,
    /// Push of a drive on the tip, per `y`: equal to `tip` but for listed modes with a `drive`.
    pub drive: DVector<f64>,
    /// The modes of the lever alone, on a base at rest.
    pub alone: Eigen,
    /// 1/Q of the modes alone; the last serves those beyond the list.
    inverse_q: Vec<f64>,
    /// Finite elements used: none for a list of modes.
    pub elements: usize,
}

impl LeverPart {
    /// The lever on `elements` equal elements of degree `order` (at least 3).
    ///
    /// # Errors
    /// Impossible values, empty lists, and numbers beyond the range of f64.
    pub fn new(p: &InstrumentParams, elements: usize, order: usize) -> Result<Self, InstrumentError> {
        match &p.cantilever.lever {
            Lever::Dimensions { youngs_modulus, density, length, width, thickness } => {
                for (what, value) in [
                    ("the lever's youngs_modulus", *youngs_modulus),
                    ("the lever's density", *density),
                    ("the lever's length", *length),
                    ("the lever's width", *width),
                    ("the lever's thickness", *thickness),
                ] {
                    check_positive(what, value)?;
                }
                let stiffness = youngs_modulus * width * thickness.powi(3) / 12.0 / length.powi(3);
                let mass = density * width * thickness * length;
                let arm = p.tip.half_length;
                check_not_negative("the tip's half_length", arm)?;
                let tip_mass = tip_mass(&p.tip)?;
                let beam = Beam { stiffness, mass, tip_mass, arm: arm / length, elements, order };
                beam.part(inverse_q(&p.cantilever.quality_factor)?)
            }
            Lever::Calibrated { stiffness, frequency } => {
                check_positive("the lever's stiffness", *stiffness)?;
                check_positive("the lever's frequency", *frequency)?;
                let tip_mass = match p.tip.mass {
                    TipMass::Given(mass) => check_not_negative("the tip's mass", mass).map(|()| mass)?,
                    // The preset's: a calibrated lever has its own.
                    TipMass::Pyramid { .. } => 0.0,
                };
                let beam = calibrated(*stiffness, *frequency, tip_mass, (elements, order))?;
                beam.part(inverse_q(&p.cantilever.quality_factor)?)
            }
            Lever::Modes(modes) => Self::from_modes(modes),
        }
    }

    /// The lever as listed: coordinate i is the travel of the tip in mode i, with `k_i` and
    /// `m_i = k_i / omega_i^2`; a translation of the base looks to it like `drive_i` of its own.
    fn from_modes(modes: &[LeverMode]) -> Result<Self, InstrumentError> {
        if modes.is_empty() {
            return Err(InstrumentError::NoModes);
        }
        for mode in modes {
            check_positive("a lever mode's stiffness", mode.stiffness)?;
            check_positive("a lever mode's frequency", mode.frequency)?;
            check_quality("a lever mode's quality_factor", mode.quality_factor)?;
            if !mode.drive.is_finite() {
                return Err(InstrumentError::BadValue {
                    what: "a lever mode's drive",
                    value: mode.drive,
                    expected: "finite",
                });
            }
        }
        // In rising frequency, as the eigenvectors come, so that quality factors stay with their modes.
        let mut sorted: Vec<&LeverMode> = modes.iter().collect();
        sorted.sort_by(|a, b| a.frequency.total_cmp(&b.frequency));
        let inverse_square: Vec<f64> =
            sorted.iter().map(|m| (std::f64::consts::TAU * m.frequency).powi(-2)).collect();
        let column = |f: &dyn Fn(&LeverMode) -> f64| {
            DVector::from_iterator(sorted.len(), sorted.iter().map(|m| f(m) / m.stiffness.sqrt()))
        };
        let tip = column(&|_| 1.0);
        let drive = column(&|m| m.drive);
        let mass_of = |m: &LeverMode| m.stiffness * (std::f64::consts::TAU * m.frequency).powi(-2);
        let base = column(&|m| mass_of(m) * m.drive);
        let rigid_mass = sorted.iter().map(|m| mass_of(m) * m.drive * m.drive).sum();
        let count = sorted.len();
        let part = Self {
            mass: DMatrix::from_diagonal(&DVector::from_vec(inverse_square.clone())),
            base,
            rigid_mass,
            tip,
            drive,
            alone: Eigen { mu: inverse_square, vectors: DMatrix::identity(count, count) },
            inverse_q: sorted.iter().map(|m| 1.0 / m.quality_factor).collect(),
            elements: 0,
        };
        part.in_range()
    }

    /// 1/Q of the j-th mode of the lever alone.
    pub fn inverse_q(&self, j: usize) -> f64 {
        self.inverse_q[j.min(self.inverse_q.len() - 1)]
    }

    /// The lever's part of 1/Q of a mode whose unit-stiffness shape has `y` on the lever: strain
    /// energy in each mode of the lever alone, `omega_j^2 (psi_j.M v)^2`, times that mode's 1/Q.
    pub fn weighted_inverse_q(&self, y: &[f64]) -> f64 {
        if let [all] = self.inverse_q[..] {
            return all * y.iter().map(|v| v * v).sum::<f64>();
        }
        (0..self.alone.mu.len())
            .map(|j| {
                let share: f64 = self.alone.vectors.column(j).iter().zip(y).map(|(a, b)| a * b).sum();
                self.inverse_q(j) * share * share
            })
            .sum()
    }

    /// The part of a shape's strain energy that is in the two highest degrees of each element; none of a list of modes.
    pub fn highest(&self, y: &[f64]) -> f64 {
        if self.elements == 0 { 0.0 } else { highest(y, 2 * self.elements, self.elements) }
    }

    /// See [`change`], of the j-th mode of the lever alone and its two highest degrees.
    pub fn change(&self, j: usize) -> f64 {
        change(self.highest(self.alone.vectors.column(j).as_slice()))
    }

    /// Angular frequency of the first mode alone, rad/s.
    pub fn first_omega(&self) -> f64 {
        self.alone.mu[0].powf(-0.5)
    }

    fn in_range(self) -> Result<Self, InstrumentError> {
        let all = self.mass.iter().chain(self.base.iter()).chain(self.tip.iter()).chain(self.drive.iter());
        if let Some(&value) = all.chain([&self.rigid_mass]).find(|v| !v.is_finite()) {
            return Err(InstrumentError::OutOfRange { what: "lever's mass", value });
        }
        let omega = self.first_omega();
        if !(omega.is_finite() && omega > 0.0) {
            return Err(InstrumentError::OutOfRange { what: "lever's frequency", value: omega });
        }
        Ok(self)
    }
}

/// The uniform beam with a tip of `tip_mass` (kg) at its end whose first mode, normalised to 1 at the tip, has this
/// stiffness (N/m) and frequency (Hz): what a calibration gives is of the lever as it is. Higher modes follow.
fn calibrated(
    stiffness: f64,
    frequency: f64,
    tip_mass: f64,
    (elements, order): (usize, usize),
) -> Result<Beam, InstrumentError> {
    let omega = std::f64::consts::TAU * frequency;
    let moving = stiffness / (omega * omega);
    if tip_mass == 0.0 {
        // Every such mode of a uniform beam weighs a quarter of it.
        let bending = 4.0 * stiffness / LAMBDA_1.powi(4);
        return Ok(Beam { stiffness: bending, mass: 4.0 * moving, tip_mass, arm: 0.0, elements, order });
    }
    let share = tip_mass / moving;
    if share.is_nan() || share > TIP_SHARE {
        return Err(InstrumentError::BadValue {
            what: "the tip's mass",
            value: tip_mass,
            expected: "less than 0.999 of what moves in the lever's first mode, stiffness/(2 pi frequency)^2",
        });
    }
    // Of the first mode, in beams of bending stiffness and mass 1: its stiffness, and its mass without the tip's. That
    // mass hardly depends on the tip's, so the tip's in beam masses is soon found.
    let first = |heaviness: f64| -> Result<(f64, f64), InstrumentError> {
        let unit = UnitBeam::new(elements, order, heaviness, 0.0)
            .ok_or(InstrumentError::OutOfRange { what: "tip's mass in lever masses", value: heaviness })?;
        let modes = Eigen::of(&unit.mass)?;
        let tip = modes.vectors.column(0).dot(&unit.tip);
        Ok((tip.powi(-2), tip.powi(-2) * modes.mu[0] - heaviness))
    };
    let mut heaviness = 0.25 * share / (1.0 - share);
    for _ in 0..HEAVINESS_ROUNDS {
        heaviness = first(heaviness)?.1 * share / (1.0 - share);
    }
    let bending = stiffness / first(heaviness)?.0;
    Ok(Beam { stiffness: bending, mass: tip_mass / heaviness, tip_mass, arm: 0.0, elements, order })
}

/// A uniform beam with a tip: `stiffness` is E I / l_b^3, `tip_mass` in kg, `arm` in beam lengths.
struct Beam {
    stiffness: f64,
    mass: f64,
    tip_mass: f64,
    arm: f64,
    elements: usize,
    order: usize,
}

impl Beam {
    fn part(self, inverse_q: Vec<f64>) -> Result<LeverPart, InstrumentError> {
        for (what, value) in [("lever's stiffness", self.stiffness), ("lever's mass", self.mass)] {
            if !(value.is_finite() && value > 0.0) {
                return Err(InstrumentError::OutOfRange { what, value });
            }
        }
        let heaviness = self.tip_mass / self.mass;
        let unit = UnitBeam::new(self.elements, self.order, heaviness, self.arm)
            .ok_or(InstrumentError::OutOfRange { what: "tip's mass in lever masses", value: heaviness })?;
        let mass = unit.mass * (self.mass / self.stiffness);
        let tip = unit.tip / self.stiffness.sqrt();
        LeverPart {
            alone: Eigen::of(&mass)?,
            mass,
            base: unit.base * (self.mass / self.stiffness.sqrt()),
            rigid_mass: self.mass + self.tip_mass,
            drive: tip.clone(),
            tip,
            inverse_q,
            elements: self.elements,
        }
        .in_range()
    }
}

fn inverse_q(q: &QualityFactor) -> Result<Vec<f64>, InstrumentError> {
    let list = match q {
        QualityFactor::All(q) => std::slice::from_ref(q),
        QualityFactor::PerMode(list) => list.as_slice(),
    };
    if list.is_empty() {
        return Err(InstrumentError::NoQualityFactors);
    }
    list.iter().map(|&q| check_quality("the lever's quality_factor", q).map(|()| 1.0 / q)).collect()
}

/// The tip's mass, kg: as given, or that of its pyramid.
fn tip_mass(tip: &TipParams) -> Result<f64, InstrumentError> {
    match tip.mass {
        TipMass::Given(mass) => check_not_negative("the tip's mass", mass).map(|()| mass),
        TipMass::Pyramid { width, height, density } => {
            check_positive("the tip's width", width)?;
            check_positive("the tip's height", height)?;
            check_positive("the tip's density", density)?;
            // Table 1 prints no mass; a pyramid fits the shape of its figure 1.
            Ok(density * 2.0 * tip.half_length * width * height / 3.0)
        }
    }
}

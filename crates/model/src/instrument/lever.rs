//! The lever as a substructure relative to its base, whichever way it was described.
//!
//! All three descriptions of `scene::Lever` end as the same few arrays, the modes of the lever alone on a base at rest, so
//! nothing further on knows which was used.

use nalgebra::DMatrix;

use super::beam::UnitBeam;
use super::instrument_error::InstrumentError;
use super::secular::{Line, SecularPair, dot, orthonormality, pairs};
use super::unit_modes::{Quality, change, in_rows};
use super::{check_not_negative, check_positive, check_quality};
use crate::scene::{InstrumentParams, LeverMode, LeverSpec, QualityFactor, TipMass, TipParams};

/// First root of 1 + cos(x) cosh(x), the clamped-free beam.
const LAMBDA_1: f64 = 1.875_104_068_711_961;

/// Most of the mass that moves in a calibrated lever's first mode that its tip may have.
const TIP_SHARE: f64 = 0.999;
/// Each leaves a tenth of the miss and less.
const HEAVINESS_ROUNDS: usize = 12;

/// The lever by its modes alone in coordinates `y` of unit stiffness, slowest first: energy `y.y/2`; with the base at `s` its
/// kinetic energy is `sum of mu y'^2/2 + s' base.y' + rigid_mass s'^2/2`.
#[derive(Clone, Debug)]
pub(crate) struct LeverPart {
    /// 1/omega^2 of each mode, s^2.
    pub mu: Vec<f64>,
    /// Inertial coupling to the base, M r.
    pub base: Vec<f64>,
    /// What the base carries when everything moves with it, r.M r, kg.
    pub rigid_mass: f64,
    /// Travel of the tip relative to the base, per `y`.
    pub tip: Vec<f64>,
    /// Push of a drive on the tip, per `y`: equal to `tip` but for listed modes with a `drive`.
    pub drive: Vec<f64>,
    /// 1/Q of the modes; the last serves those beyond the list.
    inverse_q: Vec<f64>,
    /// What each mode has of the two highest degrees of each element, a row for each.
    high: DMatrix<f64>,
    /// How well each mode is met.
    pub quality: Vec<Quality>,
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
            LeverSpec::Dimensions { youngs_modulus, density, length, width, thickness } => {
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
            LeverSpec::Calibrated { stiffness, frequency } => {
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
            LeverSpec::Modes(modes) => Self::from_modes(modes),
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
        let column = |f: &dyn Fn(&LeverMode) -> f64| -> Vec<f64> {
            sorted.iter().map(|m| f(m) / m.stiffness.sqrt()).collect()
        };
        let tip = column(&|_| 1.0);
        let drive = column(&|m| m.drive);
        let mass_of = |m: &LeverMode| m.stiffness * (std::f64::consts::TAU * m.frequency).powi(-2);
        let base = column(&|m| mass_of(m) * m.drive);
        let rigid_mass = sorted.iter().map(|m| mass_of(m) * m.drive * m.drive).sum();
        let part = Self {
            mu: sorted.iter().map(|m| (std::f64::consts::TAU * m.frequency).powi(-2)).collect(),
            base,
            rigid_mass,
            tip,
            drive,
            inverse_q: sorted.iter().map(|m| 1.0 / m.quality_factor).collect(),
            high: DMatrix::zeros(0, sorted.len()),
            quality: vec![Quality::default(); sorted.len()],
            elements: 0,
        };
        part.in_range()
    }

    /// 1/Q of the j-th mode of the lever alone.
    pub fn inverse_q(&self, j: usize) -> f64 {
        self.inverse_q[j.min(self.inverse_q.len() - 1)]
    }

    /// The lever's part of 1/Q of a mode whose unit-stiffness shape has `y` on the lever: its strain energy in each mode of
    /// the lever alone times that mode's 1/Q.
    pub fn weighted_inverse_q(&self, y: &[f64]) -> f64 {
        match self.inverse_q[..] {
            [all] => all * dot(y, y),
            _ => y.iter().enumerate().map(|(j, y)| self.inverse_q(j) * y * y).sum(),
        }
    }

    /// The part of a shape's strain energy that is in the two highest degrees of each element; none of a list of modes.
    pub fn highest(&self, y: &[f64]) -> f64 {
        in_rows(&self.high, y)
    }

    /// See [`change`], of the j-th mode of the lever alone and its two highest degrees.
    pub fn change(&self, j: usize) -> f64 {
        change(self.high.column(j).norm_squared())
    }

    /// See [`Quality::absolute`], of each mode.
    pub fn misses(&self) -> impl Iterator<Item = [f64; 2]> {
        self.mu.iter().zip(&self.quality).map(|(mu, quality)| quality.absolute(*mu))
    }

    /// Angular frequency of the first mode alone, rad/s.
    pub fn first_omega(&self) -> f64 {
        self.mu[0].powf(-0.5)
    }

    fn in_range(self) -> Result<Self, InstrumentError> {
        let all = self.mu.iter().chain(&self.base).chain(&self.tip).chain(&self.drive);
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
        let unit = Loaded::new(elements, order, heaviness, 0.0)?;
        Ok((unit.tip[0].powi(-2), unit.tip[0].powi(-2) * unit.mu[0] - heaviness))
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
        let unit = Loaded::new(self.elements, self.order, self.tip_mass / self.mass, self.arm)?;
        let scaled = |all: Vec<f64>, scale: f64| -> Vec<f64> { all.iter().map(|one| one * scale).collect() };
        let tip = scaled(unit.tip, self.stiffness.sqrt().recip());
        LeverPart {
            mu: scaled(unit.mu, self.mass / self.stiffness),
            base: scaled(unit.base, self.mass / self.stiffness.sqrt()),
            rigid_mass: self.mass + self.tip_mass,
            drive: tip.clone(),
            tip,
            inverse_q,
            high: unit.high,
            quality: unit.quality,
            elements: self.elements,
        }
        .in_range()
    }
}

/// The modes of a clamped beam with a tip, of unit stiffness and dimensionless.
struct Loaded {
    mu: Vec<f64>,
    base: Vec<f64>,
    tip: Vec<f64>,
    high: DMatrix<f64>,
    quality: Vec<Quality>,
}

impl Loaded {
    /// On `elements` elements of degree `order`, with a tip of `heaviness` beam masses `arm` beam lengths beyond its end.
    fn new(elements: usize, order: usize, heaviness: f64, arm: f64) -> Result<Self, InstrumentError> {
        let bare = UnitBeam::on(elements, order)?;
        let tip: Vec<f64> = bare.end.iter().zip(&bare.slope).map(|(end, slope)| end + arm * slope).collect();
        let mut loaded = Self {
            mu: bare.modes.mu.clone(),
            base: bare.base.clone(),
            tip,
            high: bare.modes.high.clone(),
            quality: bare.modes.quality.clone(),
        };
        if !heaviness.is_finite() {
            return Err(InstrumentError::OutOfRange { what: "tip's mass in lever masses", value: heaviness });
        }
        // So light a tip changes nothing.
        if heaviness.recip().is_finite() {
            loaded.carry(heaviness);
        }
        Ok(loaded)
    }

    /// The tip's mass is one more square of the tip's speed in the kinetic energy.
    fn carry(&mut self, heaviness: f64) {
        let with = pairs(Line::rank_one(heaviness), &self.mu, &self.tip);
        let along = |row: &[f64], pair: &SecularPair| dot(row, &pair.rest);
        let shapes = DMatrix::from_fn(self.mu.len(), with.len(), |k, one| with[one].rest[k]);
        let tip: Vec<f64> = with.iter().map(|pair| along(&self.tip, pair)).collect();
        self.base =
            with.iter().zip(&tip).map(|(pair, tip)| along(&self.base, pair) + heaviness * tip).collect();
        self.high = &self.high * shapes;
        let parts: Vec<[f64; 2]> =
            self.mu.iter().zip(&self.quality).map(|(mu, quality)| quality.absolute(*mu)).collect();
        let quality = with.iter().zip(orthonormality(&with)).map(|(pair, orthonormality)| {
            let own = Quality { residual: pair.residual, orthonormality };
            Quality::of_sum(own, pair.value, &pair.rest, &parts)
        });
        self.quality = quality.collect();
        self.mu = with.iter().map(|pair| pair.value).collect();
        self.tip = tip;
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

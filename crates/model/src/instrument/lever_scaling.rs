//! The modes of a lever from those of another that differs in scale alone.
//!
//! A calibrated lever on a rigid base is a uniform beam of which only bending stiffness and mass are known: all of these have
//! the same shapes, and the same ratios of frequencies. With stiffness k and frequency f of the first mode every frequency goes
//! with f, every modal mass with k/f^2, and so tip travel and forces per modal coordinate with f/sqrt(k), the pull of a
//! moving base with sqrt(k)/f. Quality factors are the lever's own. One reduction serves all of them, to rounding.

use super::{Instrument, InstrumentError, Mode, check_positive, check_quality};
use crate::scene::{ActuatorModel, DriveOn, InstrumentParams, LeverSpec, QualityFactor, TipMass};

/// Stiffness (N/m) and frequency (Hz) of the first mode of a lever that is the same as all others but for scale; none where
/// more than these decides.
fn scale(params: &InstrumentParams) -> Option<(f64, f64)> {
    match (params.actuator.model, &params.cantilever.lever, params.tip.mass) {
        // A tip's mass of its own changes the shapes.
        (
            ActuatorModel::Rigid,
            LeverSpec::Calibrated { stiffness, frequency },
            TipMass::Pyramid { .. } | TipMass::Given(0.0),
        ) => Some((*stiffness, *frequency)),
        _ => None,
    }
}

/// The one reduction. It is always of the same lever, so that no instrument depends on which others there are.
#[derive(Clone, Debug)]
pub struct Pattern {
    unit: Instrument,
}

/// Stiffness (N/m) and frequency (Hz) of the lever that is reduced.
const UNIT: (f64, f64) = (1.0, 1e5);

impl Pattern {
    /// # Errors
    /// As [`Instrument::reduce`], of the tolerance.
    pub fn new(on: DriveOn, tolerance: f64) -> Result<Self, InstrumentError> {
        let mut params = InstrumentParams::default();
        params.actuator.model = ActuatorModel::Rigid;
        params.cantilever.lever = LeverSpec::Calibrated { stiffness: UNIT.0, frequency: UNIT.1 };
        Ok(Self { unit: Instrument::reduce(&params, on, tolerance)? })
    }

    /// Whether the instrument differs from the pattern in scale and damping alone.
    pub fn serves(params: &InstrumentParams) -> bool {
        scale(params).is_some()
    }

    /// The instrument of these parameters, equal to a reduction of its own to rounding; none where the pattern does not serve
    /// it.
    ///
    /// # Errors
    /// Impossible values.
    pub fn instrument(&self, params: &InstrumentParams) -> Option<Result<Instrument, InstrumentError>> {
        scale(params).map(|(stiffness, frequency)| self.scaled(params, stiffness, frequency))
    }

    fn scaled(
        &self,
        params: &InstrumentParams,
        stiffness: f64,
        frequency: f64,
    ) -> Result<Instrument, InstrumentError> {
        check_positive("the lever's stiffness", stiffness)?;
        check_positive("the lever's frequency", frequency)?;
        let unit = &self.unit;
        let faster = frequency / UNIT.1;
        let travel = faster * (UNIT.0 / stiffness).sqrt();
        let drive = match unit.on {
            DriveOn::Actuator => 1.0 / travel,
            DriveOn::Tip => travel,
        };
        let mode = |(number, mode): (usize, &Mode)| -> Result<Mode, InstrumentError> {
            Ok(Mode {
                omega: mode.omega * faster,
                quality_factor: quality(&params.cantilever.quality_factor, number)?,
                tip: mode.tip * travel,
                force: mode.force * travel,
                drive: mode.drive * drive,
                top: mode.top * travel,
            })
        };
        let modes: Vec<Mode> = unit.modes.iter().enumerate().map(mode).collect::<Result<_, _>>()?;
        let sum = |mode: &Mode| mode.omega + mode.tip.abs() + mode.drive.abs();
        match modes.iter().map(sum).find(|sum| !sum.is_finite()) {
            Some(value) => Err(InstrumentError::OutOfRange { what: "modes of a lever", value }),
            None => Ok(Instrument { modes, lever_frequency: unit.lever_frequency * faster, ..*unit }),
        }
    }
}

/// Quality factor of the mode of that number, by the same steps as a reduction takes.
fn quality(all: &QualityFactor, mode: usize) -> Result<f64, InstrumentError> {
    let own = match all {
        QualityFactor::All(value) => *value,
        QualityFactor::PerMode(values) => {
            values.get(mode).or(values.last()).copied().ok_or(InstrumentError::NoQualityFactors)?
        }
    };
    check_quality("the lever's quality_factor", own)?;
    Ok(1.0 / (1.0 / own))
}

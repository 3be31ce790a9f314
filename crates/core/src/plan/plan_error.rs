//! Errors of planning, at their places in the scene.

use crate::instrument::InstrumentError;
use crate::scene::{Scene, SceneError};
use thiserror::Error;

/// Why a scene cannot be planned.
#[derive(Debug, Error)]
pub enum PlanError {
    /// `values` names the swept values of the instance, empty without a sweep.
    #[error("instance {instance}{values}: {source}")]
    Instrument { instance: usize, values: String, source: InstrumentError },
}

impl PlanError {
    /// The error at its place in the scene, with what was expected and what to do.
    pub fn in_scene(&self, scene: &Scene) -> SceneError {
        let Self::Instrument { instance, values, source } = self;
        let (paths, expected, otherwise) = told(source);
        let text = source.to_string();
        // The instrument's message has two parts: what is wrong; what to do.
        let (title, help) = text.split_once("; ").unwrap_or((&text, otherwise));
        let found = match values.is_empty() {
            true => "found on planning".to_owned(),
            false => format!("found on planning instance {instance}{values}"),
        };
        scene.refusal(paths, title, &found, expected, help)
    }
}

/// The quantities concerned, most likely first, what was expected, and what to do if the message does not say.
fn told(error: &InstrumentError) -> (&'static [&'static str], &'static str, &'static str) {
    use InstrumentError as E;
    const ROD_AND_LEVER: &[&str] =
        &["instrument.actuator.length", "instrument.cantilever", "instrument.actuator"];
    match error {
        E::BadValue { expected, .. } => (&["instrument", "drive"], expected, "correct this value"),
        E::NoDimensions => (
            &["instrument.cantilever.stiffness", "instrument.cantilever"],
            "a lever given by its dimensions",
            "give length, width, thickness, density and youngs_modulus",
        ),
        E::NoModes => (&["instrument.cantilever.modes"], "at least one mode", "list a mode"),
        E::NoQualityFactors => {
            (&["instrument.cantilever.quality_factor"], "at least one number or inf", "give one")
        }
        E::UnstableRod { .. } => (
            &["instrument.actuator.h33", "instrument.actuator.beta33", "instrument.actuator.youngs_modulus"],
            "youngs_modulus above h33^2/beta33",
            "check h33 and beta33",
        ),
        E::RodTooSlow { .. } | E::Inaccurate { .. } => (
            ROD_AND_LEVER,
            "a rod and a lever whose frequencies lie within a few orders of magnitude",
            "check the dimensions of both",
        ),
        E::NotConverged { .. } => (
            &["instrument.tip", "instrument.cantilever", "run.accuracy"],
            "a tip that is small and light beside the lever",
            "check the tip's mass and length against the lever's",
        ),
        E::OutOfRange { .. } => (
            &["drive.frequency", "instrument.cantilever", "instrument", "drive"],
            "sizes whose frequencies and travels are ordinary numbers",
            "check the units",
        ),
        E::WrongDrive { .. } => (&["drive"], "a drive that fits the instrument", "give another drive"),
        E::DrivenOnResonance { .. } => (
            &["drive.frequency", "instrument.cantilever.quality_factor"],
            "a frequency at which the free motion is bounded",
            "give a finite quality_factor",
        ),
        E::NoTipMotion { .. } => (
            &["drive.free_amplitude", "drive.frequency"],
            "a frequency at which the drive moves the tip",
            "give another frequency",
        ),
        E::UndampedPeak { .. } => (
            &["drive.frequency", "instrument.cantilever.quality_factor"],
            "a damped lever, or a frequency in Hz",
            "give [instrument.cantilever] a quality_factor",
        ),
        E::NoPeak { .. } => (
            &["drive.frequency"],
            "a free response with a peak within a factor of 16 of the lever's first mode, or a frequency in Hz",
            "give the drive a frequency in Hz",
        ),
    }
}

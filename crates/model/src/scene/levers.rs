//! Makers' levers, as presets of `[instrument]`: nominal values as the makers' public data sheets print them.
//!
//! A lever of a box may be off its nominal stiffness by a factor of two and more, so a scene of an experiment replaces these
//! by what a calibration gave. No data sheet has a quality factor: it is the surroundings' as much as the lever's.

use super::params::PRESET;
use super::params::{InstrumentParams, LeverSpec};

/// A lever that can be bought. Stiffness and frequency are nominal ones in air, lengths nominal ones of the plan view.
#[derive(Debug, PartialEq)]
pub struct MakersLever {
    /// The word of `instrument.preset`.
    pub preset: &'static str,
    /// Maker and model, as its data sheet is headed.
    pub source: &'static str,
    /// N/m
    pub stiffness: f64,
    /// Hz
    pub frequency: f64,
    /// m; where the sheet gives a bound, the bound.
    pub tip_radius: f64,
    /// Length, width and thickness, m; of a triangular lever the width of an arm.
    pub size: [f64; 3],
    /// Two arms that meet at the tip, in place of a beam.
    pub triangular: bool,
}

macro_rules! lever {
    ($preset:literal, $source:literal, $stiffness:literal, $frequency:literal, $radius:literal, $size:expr, $triangular:literal) => {
        MakersLever {
            preset: $preset,
            source: $source,
            stiffness: $stiffness,
            frequency: $frequency,
            tip_radius: $radius,
            size: $size,
            triangular: $triangular,
        }
    };
}

/// Stiffness (N/m), frequency (Hz), tip radius (m); length, width and thickness (m); whether it is triangular.
#[rustfmt::skip]
pub static LEVERS: [MakersLever; 12] = [
    lever!("ppp-nchr", "NANOSENSORS PPP-NCHR", 42.0, 330e3, 10e-9, [125e-6, 30e-6, 4e-6], false),
    lever!("ppp-fmr", "NANOSENSORS PPP-FMR", 2.8, 75e3, 10e-9, [225e-6, 28e-6, 3e-6], false),
    lever!("ppp-contr", "NANOSENSORS PPP-CONTR", 0.2, 13e3, 10e-9, [450e-6, 50e-6, 2e-6], false),
    lever!("nchr", "NanoWorld NCHR", 42.0, 320e3, 8e-9, [125e-6, 30e-6, 4e-6], false),
    lever!("tap300-g", "BudgetSensors Tap300-G", 40.0, 300e3, 10e-9, [125e-6, 30e-6, 4e-6], false),
    lever!("multi75-g", "BudgetSensors Multi75-G", 3.0, 75e3, 10e-9, [225e-6, 28e-6, 3e-6], false),
    lever!("ac160ts", "Olympus OMCL-AC160TS", 26.0, 300e3, 7e-9, [160e-6, 40e-6, 3.7e-6], false),
    lever!("ac240ts", "Olympus OMCL-AC240TS", 2.0, 70e3, 7e-9, [240e-6, 40e-6, 2.3e-6], false),
    lever!("bl-ac40ts", "Olympus BL-AC40TS", 0.09, 110e3, 8e-9, [38e-6, 16e-6, 0.2e-6], false),
    lever!("rtespa-300", "Bruker RTESPA-300", 40.0, 300e3, 8e-9, [125e-6, 40e-6, 3.4e-6], false),
    lever!("scanasyst-air", "Bruker ScanAsyst-Air", 0.4, 70e3, 2e-9, [115e-6, 25e-6, 0.65e-6], true),
    lever!("mlct-bio-d", "Bruker MLCT-Bio, lever D", 0.03, 15e3, 20e-9, [225e-6, 20e-6, 0.55e-6], true),
];

/// What a preset's lever says of a scene.
pub(super) const GIVEN: [&str; 3] =
    ["instrument.cantilever.stiffness", "instrument.cantilever.frequency", "instrument.tip.radius"];

/// The words of `instrument.preset`, and the lever that each stands for; none of the paper's instrument.
pub(super) fn presets() -> Vec<(&'static str, Option<&'static MakersLever>)> {
    let levers = LEVERS.iter().map(|lever| (lever.preset, Some(lever)));
    std::iter::once((PRESET, None)).chain(levers).collect()
}

impl MakersLever {
    /// As a calibrated lever, its tip's radius included.
    pub(super) fn put(&self, params: &mut InstrumentParams) {
        params.cantilever.lever =
            LeverSpec::Calibrated { stiffness: self.stiffness, frequency: self.frequency };
        params.tip.radius = self.tip_radius;
    }
}

//! What can go wrong between an instrument's dimensions and its modes.

use thiserror::Error;

/// Every failure of this module: each carries its numbers and says what to do.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum InstrumentError {
    #[error("{what} is {}, but must be {expected}", plain(*value))]
    BadValue { what: &'static str, value: f64, expected: &'static str },

    #[error("the lever is given by a list of modes, but the list is empty; give at least one mode")]
    NoModes,

    #[error(
        "what a fluid does to a lever follows from its dimensions, and this one is given otherwise; give length, width, \
         thickness, density and youngs_modulus in [instrument.cantilever]"
    )]
    NoDimensions,

    #[error("the list of the lever's quality factors is empty; give at least one, or `inf` for no damping")]
    NoQualityFactors,

    #[error(
        "the rod is unstable: its Young's modulus {youngs_modulus:e} Pa must exceed the piezoelectric softening \
         h33^2/beta33 = {softening:e} Pa; lower h33 or raise beta33 or youngs_modulus"
    )]
    UnstableRod { youngs_modulus: f64, softening: f64 },

    #[error(
        "the rod's lowest frequency, {rod_hz:.4e} Hz, lies so far below the lever's, {lever_hz:.4e} Hz, that {needed:.0} \
         rod modes would be in play (at most {most}); shorten the rod or use model = \"rigid\""
    )]
    RodTooSlow { rod_hz: f64, lever_hz: f64, needed: f64, most: usize },

    #[error(
        "the natural frequencies still change by {change:.1e} (relative) at polynomial order {order}, more than the \
         {tolerance:.1e} asked for; ask for less, or check the tip's mass and length against the lever's"
    )]
    NotConverged { change: f64, tolerance: f64, order: usize },

    #[error(
        "the modes miss their equations: residual {residual:.1e}, orthonormality {orthonormality:.1e} (at most {limit:.0e}); \
         the frequencies of rod and lever lie too far apart for double precision: use model = \"rigid\" or \"prescribed\""
    )]
    Inaccurate { residual: f64, orthonormality: f64, limit: f64 },

    #[error(
        "the {what} of this instrument is {value:e}, out of the range of numbers; check the units of its dimensions"
    )]
    OutOfRange { what: &'static str, value: f64 },

    #[error("the drive is given as {given}, but this instrument is driven by {driven_by}; give {remedy}")]
    WrongDrive { given: &'static str, driven_by: &'static str, remedy: &'static str },

    #[error(
        "undamped and driven exactly at the natural frequency {} Hz (mode {}), the free motion grows without \
         bound; give a finite quality_factor or another frequency", plain(*frequency_hz), mode + 1
    )]
    DrivenOnResonance { frequency_hz: f64, mode: usize },

    #[error(
        "the free tip does not move at {} Hz, so no drive gives it an amplitude of {asked:e} m; drive it \
         elsewhere or by another frequency", plain(*frequency_hz)
    )]
    NoTipMotion { frequency_hz: f64, asked: f64 },

    #[error(
        "the peak at {} Hz is infinite, as the mode is undamped: `resonance` has no steady state there; give \
         quality_factor a finite value or the drive a frequency in Hz", plain(*frequency_hz)
    )]
    UndampedPeak { frequency_hz: f64 },

    #[error(
        "the free tip's response has no peak near the lever's first mode, {lever_hz:.6e} Hz (quality factor too low, or \
         nothing drives it); give the drive a frequency in Hz"
    )]
    NoPeak { lever_hz: f64 },
}

/// A number with digits that can be read: as it is, or with a power of ten.
fn plain(value: f64) -> String {
    match value.abs() {
        0.0 => "0".to_owned(),
        size if !size.is_finite() || (1e-3..1e9).contains(&size) => format!("{value}"),
        _ => format!("{value:e}"),
    }
}

//! The instrument without a sample: rod, lever and tip as modes, and their driven motion.
//!
//! Signs: travel is positive away from the sample, so is the tip force. Tip travel is the
//! absolute motion of the tip's centre, `u(l_p) + v(l_b) + l v_x(l_b)`.
//! The drive is `level * sin(omega t)`; a phasor `Z` stands for `z(t) = Im(Z exp(i omega t))`.

//!
//! [`Instrument::reduce`] turns dimensions into modes, [`Instrument::resonance`] finds the peak,
//! [`Instrument::free_motion`] gives the steady motion and the transients of a start from rest.
//! The equations are those of Ha, Fung & Chen 2005 (J. Dyn. Syst. Meas. Control 127(4), 705-709)
//! with time derivatives where their (4) prints subscripts z and x; each other choice stands
//! where it is made: the rod's field in `rod.rs`, the kinematics and the tip's force in
//! `assembly.rs`.
//!
//! ```
//! use afmsweep_model::instrument::{DEFAULT_TOLERANCE, Instrument};
//! use afmsweep_model::scene::{DriveLevel, DriveOn, InstrumentParams};
//!
//! let instrument = Instrument::reduce(&InstrumentParams::default(), DriveOn::Actuator, DEFAULT_TOLERANCE)?;
//! let motion = instrument.free_motion(DriveLevel::Voltage(15.0), 30e3)?;
//! assert!((motion.tip.norm() - 6.4722e-9).abs() < 1e-13); // m
//! # Ok::<(), afmsweep_model::instrument::InstrumentError>(())
//! ```
//!
//! Flow: `rod.rs`, `beam.rs` (elements, whose modes `unit_modes.rs` keeps) and `lever.rs` (three descriptions of a lever) ->
//! `assembly.rs` -> `secular.rs` (eigenpairs of what is coupled by one row) -> `natural_modes.rs` -> `mesh_refinement.rs` (which mesh) -> `response.rs`, `free_motion.rs`,
//! `mode_summary.rs`; `fluid.rs` has the lever in a fluid.

mod assembly;
mod beam;
mod eigen;
mod fluid;
mod free_motion;
mod instrument_error;
mod lever;
mod lever_scaling;
mod mesh_refinement;
pub mod mode_summary;
mod natural_modes;
mod response;
mod rod;
mod secular;
mod unit_modes;

use nalgebra::Complex;
use std::sync::Arc;

use crate::scene::DriveOn;

pub use assembly::Mesh;
pub use fluid::{Fluid, FluidMode, hydrodynamic_function, modes_in};
pub use free_motion::MotionPlace;
pub use instrument_error::InstrumentError;
pub use lever_scaling::Pattern;
pub use mesh_refinement::DEFAULT_TOLERANCE;

/// One mode: `q'' + (omega/Q) q' + omega^2 q = force * f + drive * (drive level)`, and
/// the tip moves by `tip * q`, the rod's top by `top * q`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mode {
    /// Undamped angular frequency, rad/s.
    pub omega: f64,
    /// Infinite means undamped.
    pub quality_factor: f64,
    /// Tip travel per modal coordinate, c_k (kg^-1/2).
    pub tip: f64,
    /// Modal force per tip force, b_k (kg^-1/2); differs from `tip` only as printed.
    pub force: f64,
    /// Modal force per drive level (V, N on the tip) or, for a moving rigid base, per base acceleration.
    pub drive: f64,
    /// Travel of the rod's top per modal coordinate.
    pub top: f64,
}

impl Mode {
    /// Acceleration of the tip per tip force through this mode, c_k b_k, 1/kg.
    pub fn inverse_mass(&self) -> f64 {
        self.tip * self.force
    }
}

/// The instrument as its modes, in rising frequency: all of the finite-element model.
#[derive(Clone, Debug, PartialEq)]
pub struct Instrument {
    pub modes: Vec<Mode>,
    /// Largest relative residual of the resolved eigenpairs, |K p - w^2 M p| / |K p|.
    pub residual: f64,
    /// Degrees of freedom and elements chosen, for the plan.
    pub rod_elements: usize,
    pub beam_elements: usize,
    pub order: usize,
    /// How many of the lowest modes meet the frequency accuracy.
    pub resolved: usize,
    /// Frequency of the lever's own first mode (alone, clamped), Hz.
    pub lever_frequency: f64,
    /// True for a base that moves as told: the tip follows it (adds level to its phasor).
    pub moving_base: bool,
    /// Where the drive acts: what `Mode::drive` is per unit of.
    pub on: DriveOn,
}

/// Motion without a sample, at one drive.
#[derive(Clone, Debug, PartialEq)]
pub struct FreeMotion {
    /// Drive frequency, rad/s.
    pub omega: f64,
    /// V, N or m: what the drive was set to (after scaling to a free amplitude).
    pub level: f64,
    /// Phasor of the tip's travel, m.
    pub tip: Complex<f64>,
    /// Its modulus (m) and argument (rad), worked out once: every instance asks for them.
    pub amplitude: f64,
    pub angle: f64,
    /// Phasor of the rod top's travel, m.
    pub top: Complex<f64>,
    /// How far the rod's top moves under a force on the tip at that frequency, per travel that the force gives the tip.
    /// 0 on a rigid base.
    pub top_per_tip: Complex<f64>,
    /// How far a steady force on the tip moves the tip against the rod's top, m/N.
    pub bending: f64,
    /// How far a force on the tip at that frequency moves the tip, m/N.
    pub compliance: Complex<f64>,
    /// The mode next to the lever's own first one: its frequency (Hz) and its stiffness at the tip (N/m).
    pub first_mode: (f64, f64),
    /// Phasors of the modal coordinates per unit of the level. Drives that differ in level share them.
    pub unit_modes: Arc<[Complex<f64>]>,
}

impl Instrument {
    /// Static travel of the tip per force on it, sum of c_k b_k / omega_k^2 over all modes, m/N.
    pub fn flexibility(&self) -> f64 {
        self.modes.iter().map(|m| m.inverse_mass() / (m.omega * m.omega)).sum()
    }

    /// Each mode's c_k^2/omega_k^2 over the sum of all.
    pub fn tip_shares(&self) -> Vec<f64> {
        shares(self.modes.iter().map(|m| m.tip * m.tip / (m.omega * m.omega)))
    }

    /// Each mode's part in the tip's static answer to the drive, g_k c_k/omega_k^2, over the sum of
    /// absolute values; signed. All zero if the drive moves nothing.
    pub fn drive_shares(&self) -> Vec<f64> {
        shares(self.modes.iter().map(|m| m.drive * m.tip / (m.omega * m.omega)))
    }
}

fn shares(parts: impl Iterator<Item = f64>) -> Vec<f64> {
    let parts: Vec<f64> = parts.collect();
    let sum: f64 = parts.iter().map(|p| p.abs()).sum();
    parts.into_iter().map(|p| if sum > 0.0 { p / sum } else { 0.0 }).collect()
}

fn check_positive(what: &'static str, value: f64) -> Result<(), InstrumentError> {
    if value.is_finite() && value > 0.0 {
        Ok(())
    } else {
        Err(InstrumentError::BadValue { what, value, expected: "positive and finite" })
    }
}

fn check_not_negative(what: &'static str, value: f64) -> Result<(), InstrumentError> {
    if value.is_finite() && value >= 0.0 {
        Ok(())
    } else {
        Err(InstrumentError::BadValue { what, value, expected: "zero or positive, and finite" })
    }
}

fn check_quality(what: &'static str, value: f64) -> Result<(), InstrumentError> {
    if value > 0.0 {
        Ok(())
    } else {
        Err(InstrumentError::BadValue { what, value, expected: "positive (`inf` for no damping)" })
    }
}

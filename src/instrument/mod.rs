//! The instrument without a sample: rod, lever and tip as modes, and their driven motion.
//!
//! Signs: travel is positive away from the sample, so is the tip force. Tip travel is the
//! absolute motion of the tip's centre, `u(l_p) + v(l_b) + l v_x(l_b)`.
//! The drive is `level * sin(omega t)`; a phasor `Z` stands for `z(t) = Im(Z exp(i omega t))`.

use nalgebra::Complex;

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

/// The instrument as its modes, in rising frequency: all of the finite-element model.
#[derive(Clone, Debug, PartialEq)]
pub struct Instrument {
    pub modes: Vec<Mode>,
    /// Largest relative residual of the eigenpairs, |K p - w^2 M p| / |K p|.
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
    /// Phasor of the rod top's travel, m.
    pub top: Complex<f64>,
    /// Phasors of the modal coordinates.
    pub modes: Vec<Complex<f64>>,
    /// Initial value and rate of each mode's free decaying part when the run starts from rest.
    pub transient: Vec<[f64; 2]>,
}

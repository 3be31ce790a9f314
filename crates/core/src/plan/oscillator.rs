//! One oscillator of a reduced basis.

use crate::instrument::Instrument;
use nalgebra::Complex;

/// One oscillator of the reduced instrument.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KeptMode {
    /// Index of the instrument's mode; `None` for the residual and the static oscillator and those of a reduction.
    pub index: Option<usize>,
    /// rad/s
    pub omega: f64,
    /// Damping ratio 1/(2Q).
    pub damping: f64,
    /// Acceleration of the tip per tip force through this mode, c_k b_k, 1/kg.
    pub inverse_mass: f64,
    /// Travel of the rod's top per travel of the tip, in this mode under a tip force.
    pub top: f64,
}

/// Frequency of the static oscillator over that of the drive, and its damping ratio. It adds 1/63 of its flexibility to the
/// response at the drive's frequency and loses next to nothing there.
const STATIC_RATE: f64 = 1.0 / 8.0;
const STATIC_DAMPING: f64 = 0.5;

impl KeptMode {
    /// An oscillator far below a drive of angular frequency `omega` that gives the tip this flexibility (m/N) under a steady
    /// force. `top` is the travel of the rod's top per travel of the tip.
    pub(super) fn at_rest(omega: f64, flexibility: f64, top: f64) -> Self {
        let omega = STATIC_RATE * omega;
        let inverse_mass = omega * omega * flexibility;
        Self { index: None, omega, damping: STATIC_DAMPING, inverse_mass, top }
    }

    /// Whether it is the static oscillator.
    pub fn is_static(&self) -> bool {
        self.index.is_none() && self.damping == STATIC_DAMPING
    }

    /// Whether both are the same mode, or stand for the same part of two instruments.
    pub fn corresponds(&self, other: &Self) -> bool {
        self.index == other.index && self.is_static() == other.is_static()
    }

    /// The instrument's mode `k` as it is.
    pub(super) fn of(instrument: &Instrument, k: usize) -> Self {
        let mode = &instrument.modes[k];
        Self {
            index: Some(k),
            omega: mode.omega,
            damping: 0.5 / mode.quality_factor,
            inverse_mass: mode.inverse_mass(),
            top: mode.top / mode.tip,
        }
    }

    /// Travel of the tip per steady tip force through this oscillator, m/N.
    pub fn flexibility(&self) -> f64 {
        self.inverse_mass / self.omega.powi(2)
    }

    /// Travel of the tip per tip force of angular frequency `omega` (rad/s) through this oscillator, m/N.
    pub fn response(&self, omega: f64) -> Complex<f64> {
        let stiff = (self.omega - omega) * (self.omega + omega);
        self.inverse_mass / Complex::new(stiff, 2.0 * self.damping * self.omega * omega)
    }
}

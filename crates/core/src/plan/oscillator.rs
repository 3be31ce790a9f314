//! One oscillator of a reduced basis.

use crate::instrument::Instrument;

/// One oscillator of the reduced instrument.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KeptMode {
    /// Index of the instrument's mode; `None` for the residual oscillator and those of a reduction.
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

impl KeptMode {
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
}

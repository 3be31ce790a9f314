//! One oscillator of a reduced basis.

/// One oscillator of the reduced instrument.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KeptMode {
    /// Which of the instrument's modes; none for the residual oscillator.
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

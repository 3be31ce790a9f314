//! Which sums and extremes a run keeps.

/// Harmonics that can be summed: 1 to this.
pub const HARMONICS: usize = 10;

/// Which sums and extremes an engine must keep; what nobody asked for is not computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Wants {
    /// Fourier sums of the tip's travel for harmonics 1 to this.
    pub harmonics: usize,
    /// Extremes of the indentation, from which those of the force follow.
    pub extremes: bool,
    /// Contact time, number of contacts.
    pub contact: bool,
    /// Impulse, work and virial.
    pub energy: bool,
}

impl Wants {
    /// The least: by the fundamental a run's steadiness is judged.
    pub const FUNDAMENTAL: Self = Self { harmonics: 1, extremes: false, contact: false, energy: false };
    /// All harmonics.
    pub const HARMONIC: Self = Self { harmonics: HARMONICS, ..Self::FUNDAMENTAL };
    /// Times and numbers of contacts.
    pub const CONTACT: Self = Self { contact: true, ..Self::FUNDAMENTAL };
    /// Impulse, work and virial.
    pub const ENERGY: Self = Self { energy: true, ..Self::FUNDAMENTAL };
    /// Extremes of the indentation; whether there was contact belongs to them.
    pub const EXTREMES: Self = Self { extremes: true, ..Self::CONTACT };

    /// What either of two needs.
    pub fn or(self, other: Self) -> Self {
        Self {
            harmonics: self.harmonics.max(other.harmonics),
            extremes: self.extremes | other.extremes,
            contact: self.contact | other.contact,
            energy: self.energy | other.energy,
        }
    }
}

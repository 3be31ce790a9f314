//! The rule that chooses a basis.

use crate::kernel::MODES_MAX;
use std::hash::{Hash, Hasher};

/// The rule that chooses the oscillators of a reduced basis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BasisRule {
    /// Modes in the order of their share of the tip's flexibility until the remainder suits this accuracy, and one residual
    /// oscillator. Modes that a harmonic of the drive meets head-on are among them, faint ones if it is `resonant`.
    Shares { accuracy: f64, resonant: bool },
    /// `count` oscillators for motions of the tip at rates up to `rate`, rad/s. Steps average over fast ones if the contact
    /// is `elastic`: the force of another depends on their speed. The modes of a rod that a harmonic of the drive meets are
    /// beside them if it is `resonant`.
    Contact { rate: f64, count: usize, elastic: bool, resonant: bool },
}

/// Numbers of oscillators that the rate of a contact may choose.
pub(super) const OSCILLATOR_COUNTS: [usize; 8] = [4, 6, 8, 10, 12, 16, 20, MODES_MAX];

impl Eq for BasisRule {}

impl Hash for BasisRule {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.key().hash(state);
    }
}

impl BasisRule {
    /// Modes by their share alone.
    pub fn shares(accuracy: f64) -> Self {
        Self::Shares { accuracy, resonant: false }
    }

    /// Whether it keeps the modes that otherwise wait.
    pub fn is_resonant(&self) -> bool {
        let (Self::Shares { resonant, .. } | Self::Contact { resonant, .. }) = self;
        *resonant
    }

    /// The same rule with the modes that otherwise wait.
    pub(super) fn with_resonant_modes(mut self) -> Self {
        let (Self::Shares { resonant, .. } | Self::Contact { resonant, .. }) = &mut self;
        *resonant = true;
        self
    }

    /// A key for bases made before.
    pub fn key(&self) -> [u64; 2] {
        match self {
            Self::Shares { accuracy, resonant } => [accuracy.to_bits(), u64::from(*resonant)],
            Self::Contact { rate, count, elastic, resonant } => {
                [rate.to_bits(), (*count as u64) << 2 | u64::from(*resonant) << 1 | u64::from(*elastic)]
            }
        }
    }

    /// The same rule with a function of its accuracy. The rule of a contact has none and stays.
    pub(super) fn with_accuracy(self, of: impl Fn(f64) -> f64) -> Self {
        match self {
            Self::Shares { accuracy, resonant } => Self::Shares { accuracy: of(accuracy), resonant },
            Self::Contact { .. } => self,
        }
    }

    /// The next rule with fewer oscillators, if the contact's rate chose this one.
    pub fn poorer(&self) -> Option<Self> {
        let Self::Contact { rate, count, elastic, resonant } = *self else { return None };
        let fewer = OSCILLATOR_COUNTS.into_iter().rev().find(|other| *other < count)?;
        Some(Self::Contact { rate, count: fewer, elastic, resonant })
    }

    /// The next rule with more oscillators, likewise.
    pub fn richer(&self) -> Option<Self> {
        let Self::Contact { rate, count, elastic, resonant } = *self else { return None };
        let more = OSCILLATOR_COUNTS.into_iter().find(|other| *other > count)?;
        Some(Self::Contact { rate, count: more, elastic, resonant })
    }
}

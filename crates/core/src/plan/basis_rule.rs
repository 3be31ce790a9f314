//! The rule that chooses a basis.

use crate::kernel::MODES_MAX;
use std::hash::{Hash, Hasher};

/// The rule that chooses the oscillators of a reduced basis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BasisRule {
    /// Modes in the order of their share of the tip's flexibility until the remainder suits this accuracy, and one residual
    /// oscillator. Modes that a harmonic of the drive meets head-on are among them unless they are faint.
    Shares { accuracy: f64 },
    /// The same, and the faint modes that a harmonic of the drive meets.
    Resonant { accuracy: f64 },
    /// `count` oscillators for motions of the tip at rates up to `rate`, rad/s. Steps average over fast ones if the contact
    /// is `elastic`: the force of another depends on their speed.
    Contact { rate: f64, count: usize, elastic: bool },
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
    /// A key for bases made before.
    pub fn key(&self) -> [u64; 2] {
        match self {
            Self::Shares { accuracy } => [accuracy.to_bits(), 0],
            Self::Resonant { accuracy } => [accuracy.to_bits(), u64::MAX],
            Self::Contact { rate, count, elastic } => {
                [rate.to_bits(), (*count as u64) << 1 | u64::from(*elastic)]
            }
        }
    }

    /// The same rule with a function of its accuracy. The rule of a contact has none and stays.
    pub(super) fn with_accuracy(self, of: impl Fn(f64) -> f64) -> Self {
        match self {
            Self::Shares { accuracy } => Self::Shares { accuracy: of(accuracy) },
            Self::Resonant { accuracy } => Self::Resonant { accuracy: of(accuracy) },
            Self::Contact { .. } => self,
        }
    }

    /// The next rule with fewer oscillators, if the contact's rate chose this one.
    pub fn poorer(&self) -> Option<Self> {
        let Self::Contact { rate, count, elastic } = *self else { return None };
        let fewer = OSCILLATOR_COUNTS.into_iter().rev().find(|other| *other < count)?;
        Some(Self::Contact { rate, count: fewer, elastic })
    }

    /// The next rule with more oscillators, likewise.
    pub fn richer(&self) -> Option<Self> {
        let Self::Contact { rate, count, elastic } = *self else { return None };
        let more = OSCILLATOR_COUNTS.into_iter().find(|other| *other > count)?;
        Some(Self::Contact { rate, count: more, elastic })
    }
}

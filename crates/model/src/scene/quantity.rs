//! What a quantity of a scene is: its path, dimension and domain, and access to its value in [`Params`].

use super::params::Params;
use crate::units::Dimension;

/// Values a quantity may take, beyond having the right dimension.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Domain {
    /// Any finite value.
    Finite,
    /// Finite, zero or above.
    NonNegative,
    /// Finite, above zero.
    Positive,
    /// Above zero, or `inf`: rigid.
    PositiveOrInfinite,
    /// Above 0; as a share below 1, as a phase below 360.
    SetPoint,
    /// Above 0 and below 90 degree.
    HalfAngle,
    /// Above -1, at most 0.5.
    PoissonRatio,
    /// Above 0.5, or `inf`: undamped.
    QualityFactor,
}

/// What a set-point is to be, and what to do about one that is not.
pub(super) const SETPOINT: (&str, &str) = (
    "more than 0 and less than 1; of a phase, more than 0 and less than 360",
    "give a share of the free amplitude between 0 and 1, such as 0.8, or degrees beside setpoint_of = \"phase\"",
);

impl Domain {
    /// Whether the value is allowed; NaN never is.
    pub fn holds(self, value: f64) -> bool {
        match self {
            Self::Finite => value.is_finite(),
            Self::NonNegative => value.is_finite() && value >= 0.0,
            Self::Positive => value.is_finite() && value > 0.0,
            Self::PositiveOrInfinite => value > 0.0,
            Self::SetPoint => value > 0.0 && value < 360.0,
            Self::HalfAngle => value > 0.0 && value < 90.0,
            Self::PoissonRatio => value > -1.0 && value <= 0.5,
            Self::QualityFactor => value > 0.5,
        }
    }

    /// Between which values it lies; an end may be allowed itself or not.
    pub fn ends(self) -> (f64, f64) {
        match self {
            Self::Finite => (f64::NEG_INFINITY, f64::INFINITY),
            Self::NonNegative | Self::Positive | Self::PositiveOrInfinite => (0.0, f64::INFINITY),
            Self::SetPoint => (0.0, 360.0),
            Self::HalfAngle => (0.0, 90.0),
            Self::PoissonRatio => (-1.0, 0.5),
            Self::QualityFactor => (0.5, f64::INFINITY),
        }
    }

    /// What to do about a value that is not allowed.
    pub fn advice(self, value: f64) -> &'static str {
        match self {
            _ if value < 0.0 && self.holds(-value) => "remove the minus sign",
            Self::Finite | Self::NonNegative => "give a finite value, zero included",
            Self::Positive if value.is_infinite() => {
                "give a finite value; a large one if it should hardly matter"
            }
            Self::Positive => "give a value above zero; a small one if it should hardly matter",
            Self::PositiveOrInfinite => "give a value above zero, or inf",
            Self::SetPoint => SETPOINT.1,
            Self::HalfAngle => "it counts from the axis: sharp tips have 10 to 40 degree",
            Self::PoissonRatio => "most solids have 0.2 to 0.45; 0.5 does not change its volume",
            Self::QualityFactor => "give a value above 0.5 (the motion must oscillate), or inf",
        }
    }

    /// The allowed values, after "expected ".
    pub fn described(self) -> &'static str {
        match self {
            Self::Finite => "any finite value",
            Self::NonNegative => "zero or more",
            Self::Positive => "more than zero",
            Self::PositiveOrInfinite => "more than zero, or inf for rigid",
            Self::SetPoint => SETPOINT.0,
            Self::HalfAngle => "more than 0 and less than 90 degree",
            Self::PoissonRatio => "more than -1 and at most 0.5 (incompressible)",
            Self::QualityFactor => "more than 0.5, or inf for undamped",
        }
    }
}

/// One entry of the table.
#[derive(Debug)]
pub struct Quantity {
    /// Path in the scene file; `#` stands for an index.
    pub path: &'static str,
    /// For a label.
    pub long_name: &'static str,
    pub dimension: Dimension,
    pub domain: Domain,
    pub(super) access: Access,
    /// Sizes that it has in an instrument that can be built, and that any matter has: SI, signs apart; zero and `inf` are the
    /// domain's to judge.
    pub(super) usual: [f64; 2],
    pub(super) possible: [f64; 2],
}

/// How the value of a quantity, of this index, is had from a case and put into it.
#[derive(Debug)]
pub(super) struct Access {
    pub get: fn(&Params, usize) -> Option<f64>,
    pub set: fn(&mut Params, usize, f64),
}

//! Why a search for a fixed point gives up.

/// Why a search has failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SearchFailure {
    /// The map was asked for as often as the options allow.
    OutOfEvaluations,
    /// No step reduces the residual, or Newton's matrix is singular.
    NoDescent,
    /// The fixed point is unstable.
    Unstable,
    /// The map is not finite, ends in another contact than it began, or was not computed because the run was stopped.
    Undefined,
}

impl SearchFailure {
    pub const ALL: [Self; 4] = [Self::OutOfEvaluations, Self::NoDescent, Self::Unstable, Self::Undefined];

    /// Its name in messages and in JSON.
    pub fn name(self) -> &'static str {
        match self {
            Self::OutOfEvaluations => "out of evaluations",
            Self::NoDescent => "no descent",
            Self::Unstable => "unstable",
            Self::Undefined => "undefined",
        }
    }
}

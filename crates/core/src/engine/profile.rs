//! The kinds of work of a run's threads.

/// A kind of work whose time is summed over all threads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ProfileSection {
    /// Stepping through periods on a processor.
    Steps,
    /// Making the kernel's constants of instances.
    Constants,
    /// Predictions, steps and bounds of searches.
    Algebra,
}

impl ProfileSection {
    /// All kinds.
    pub const ALL: [Self; 3] = [Self::Steps, Self::Constants, Self::Algebra];

    /// Its name in `run --json`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Steps => "steps",
            Self::Constants => "constants",
            Self::Algebra => "algebra",
        }
    }
}

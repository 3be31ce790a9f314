//! What the threads of a run are busy with.

/// A kind of work whose time is counted, of all threads together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ProfileSection {
    /// Stepping through periods on a processor.
    Steps,
    /// Making what the kernel is given of instances.
    Constants,
    /// Guesses, steps and bounds of searches.
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

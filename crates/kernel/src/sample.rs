//! What a step sees, and the drive at that moment.

use super::contact::Kick;

/// Cosine and sine of the drive's phase at a sample.
#[derive(Clone, Copy, Debug)]
pub struct Wave<E> {
    pub cosine: E,
    pub sine: E,
}

/// What a step saw.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sample<L> {
    /// Steady free travel of the tip.
    pub steady: L,
    /// Travel beyond it, corrected to fourth order.
    pub beyond: L,
    /// Indentation, corrected likewise.
    pub indentation: L,
    /// Work of the kick, impulse times speed of the tip's travel, to fourth order.
    pub work: L,
    /// Its virial, impulse times travel, likewise.
    pub virial: L,
    /// Least and largest force within the step, as impulses, where they are asked for.
    pub least: L,
    pub most: L,
    pub kick: Kick<L>,
}

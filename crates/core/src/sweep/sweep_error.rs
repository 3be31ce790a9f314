//! Why a sweep gave no results.

use super::SweepPhase;
use crate::engine::EngineError;
use crate::scene::SceneError;
#[cfg(feature = "hdf5")]
use crate::store::StoreError;

/// Why a sweep gave no results.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The scene cannot be read, or cannot be run; it says where.
    #[error(transparent)]
    Scene(#[from] SceneError),
    #[error(transparent)]
    Engine(#[from] EngineError),
    /// The results file.
    #[cfg(feature = "hdf5")]
    #[error(transparent)]
    Store(#[from] StoreError),
    /// A GPU was asked for, and this build has no GPU engine.
    #[error("this build has no GPU engine: it was made without the feature gpu")]
    NoGpuEngine,
    /// What was chosen cannot be taken.
    #[error("{what}")]
    Prepared { what: String },
    /// What was chosen, and what has been run, is an engine's whose last bits are others.
    #[error(
        "the run was begun on another kind of engine ({theirs}; here: {ours}): its bits would be of both; --resume=anyway goes on all the same"
    )]
    OtherEngine { theirs: String, ours: String },
    /// Shares of a run that are not there, or not whole: by their numbers.
    #[error("portions of these shares are missing: {}", words(.shares))]
    Missing { shares: Vec<usize> },
    /// Stopped before any instance was done.
    #[error("stopped in the {}, before any instance was done", .0.word())]
    Stopped(SweepPhase),
}

fn words(shares: &[usize]) -> String {
    shares.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ")
}

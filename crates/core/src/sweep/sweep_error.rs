//! Errors of a sweep.

use super::SweepPhase;
use crate::engine::EngineError;
use crate::scene::SceneError;
#[cfg(feature = "hdf5")]
use crate::store::StoreError;

/// The reason why a sweep has no results.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The scene cannot be read or run. The error says where.
    #[error(transparent)]
    Scene(#[from] SceneError),
    #[error(transparent)]
    Engine(#[from] EngineError),
    /// The results file failed.
    #[cfg(feature = "hdf5")]
    #[error(transparent)]
    Store(#[from] StoreError),
    /// A GPU was requested, and this build has no GPU engine.
    #[error("this build has no GPU engine: it was made without the feature gpu")]
    NoGpuEngine,
    /// The choices cannot be used.
    #[error("{what}")]
    Prepared { what: String },
    /// The choices and earlier results come from an engine with other last bits.
    #[error(
        "the run was begun on another kind of engine ({theirs}; here: {ours}): its bits would be of both; --resume=anyway goes on all the same"
    )]
    OtherEngine { theirs: String, ours: String },
    /// These shares of a run are missing or incomplete.
    #[error("portions of these shares are missing: {}", words(.shares))]
    Missing { shares: Vec<usize> },
    /// The run was stopped before any instance was done.
    #[error("stopped in the {}, before any instance was done", .0.word())]
    Stopped(SweepPhase),
}

fn words(shares: &[usize]) -> String {
    shares.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ")
}

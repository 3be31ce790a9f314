//! Why a sweep gave no results.

use super::Phase;
use crate::engine::EngineError;
use crate::engine::gpu::GpuError;
use crate::scene::SceneError;
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
    /// The GPU that was asked for.
    #[error(transparent)]
    Gpu(#[from] GpuError),
    #[error(transparent)]
    Store(#[from] StoreError),
    /// So many threads could not be started.
    #[error("{threads} threads could not be started: {why}")]
    Threads { threads: usize, why: String },
    /// Stopped before any instance was done.
    #[error("stopped in the {}, before any instance was done", .0.word())]
    Stopped(Phase),
}

//! Speed and error of the engines on one scene, over the size of the ensemble.

mod bench_measurement;
mod bench_page;

pub use bench_measurement::{BenchOptions, BenchSeries, ErrorSample, Machine, Point, measure};
pub use bench_page::{GENERATOR, files, table};

use crate::engine::EngineError;
use crate::plan::PlanError;

/// Why nothing can be measured.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BenchError {
    #[error(transparent)]
    Plan(#[from] PlanError),
    #[error(transparent)]
    Engine(#[from] EngineError),
    #[error("the scene has nothing to step: no instance touches a sample")]
    NothingToStep,
    #[error("the scene has no axis under [sweep] that could take more points: it has {instances} instances")]
    NoAxis { instances: usize },
}

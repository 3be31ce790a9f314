//! Studies: a question, what it takes to answer it, and one page that does.
//!
//! A study runs scenes that are built into the program, so it works from any folder; the same scenes
//! stand in `scenes/` to be run and changed by hand.

mod number;
pub mod paper;
mod scene_run;

pub use number::{Number, Numbers};

use crate::engine::EngineError;
use crate::instrument::InstrumentError;
use crate::plan::PlanError;
use crate::report::ReportError;
use crate::scene::SceneError;
use crate::store::StoreError;

/// Why a study cannot be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StudyError {
    #[error(transparent)]
    Scene(#[from] SceneError),
    #[error(transparent)]
    Plan(#[from] PlanError),
    #[error(transparent)]
    Engine(#[from] EngineError),
    #[error(transparent)]
    Instrument(#[from] InstrumentError),
    #[error(transparent)]
    Store(#[from] StoreError),
    #[error(transparent)]
    Report(#[from] ReportError),
    /// The drive that reaches a given indentation.
    #[error("no drive found that presses the tip {wanted:e} m into the sample: {reached:e} m at {voltage} V")]
    NoDrive { wanted: f64, reached: f64, voltage: f64 },
}

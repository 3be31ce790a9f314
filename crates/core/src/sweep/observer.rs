//! What a sweep tells while it runs.

use super::EngineChoice;
use crate::engine::{Engine, ProgressPhase as Stage};
use crate::plan::Plan;
use std::ops::ControlFlow;

/// Told what a sweep does. Every method does nothing unless it is written.
pub trait Observer: Sync {
    /// An engine was taken that was not named, and why.
    fn chosen(&self, _choice: &EngineChoice) {}

    /// The plan is made; stepping begins.
    fn planned(&self, _plan: &Plan, _engine: &dyn Engine) {}

    /// How far it is, some twenty times a second, from another thread. A break ends the run early; what is complete is
    /// kept.
    fn progress(&self, _stage: &Stage) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}

/// Nobody listens.
#[derive(Clone, Copy, Debug)]
pub struct Silent;

impl Observer for Silent {}

//! The interface by which a sweep reports while it runs.

use super::EngineChoice;
use crate::engine::{Engine, ProgressPhase as Stage};
use crate::plan::Plan;
use std::ops::ControlFlow;

/// Receives reports of a sweep. Every method does nothing by default.
pub trait Observer: Sync {
    /// The run chose an engine that the user did not name.
    fn chosen(&self, _choice: &EngineChoice) {}

    /// The plan is made; stepping begins.
    fn planned(&self, _plan: &Plan, _engine: &dyn Engine) {}

    /// Progress, about twenty times a second, from another thread. A break ends the run early; finished work is kept.
    fn progress(&self, _stage: &Stage) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}

/// An observer that ignores everything.
#[derive(Clone, Copy, Debug)]
pub struct Silent;

impl Observer for Silent {}

//! The phases of a sweep, and those that a run has not done.

use crate::control::{InstanceFlags, JournaledRun};
use crate::engine::Progress;
use crate::observe::Status;

/// The phases of a sweep, in order. Their words are in the results file, as `incomplete_phase` and `missing`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SweepPhase {
    Planning,
    /// Trials, and the first runs of every instance.
    Stepping,
    /// Runs with more steps or modes, and the test for sensitivity.
    Refinement,
    /// Second periodic states.
    Branches,
    Audit,
    Waveforms,
    Spectra,
}

impl SweepPhase {
    /// Name of the phase in the results file and in messages.
    pub fn word(self) -> &'static str {
        match self {
            Self::Planning => "planning",
            Self::Stepping => "stepping",
            Self::Refinement => "refinement",
            Self::Branches => "branches",
            Self::Audit => "audit",
            Self::Waveforms => "waveforms",
            Self::Spectra => "spectra",
        }
    }
}

/// Phases that a sweep has not done. If one is missing, so are all later ones.
#[derive(Debug, Default)]
pub(super) struct MissingPhases(pub Vec<SweepPhase>);

impl MissingPhases {
    /// Missing phases of the instances, after their run. If nothing stopped the run, a missing phase is a bug.
    pub fn of(run: &JournaledRun) -> Self {
        let any = |what: &dyn Fn(&InstanceFlags) -> bool| run.marks().iter().any(what);
        let mut missing = Vec::new();
        if any(&|one| one.status() == Status::NotRun && !one.measured()) {
            missing.push(SweepPhase::Stepping);
        }
        if any(&|one| one.status() == Status::NotRun && one.measured()) {
            missing.push(SweepPhase::Refinement);
        }
        Self(missing)
    }

    /// Does a phase if it is requested. A phase that was stopped is missing; if it was stopped before, it only collects what
    /// is already known.
    pub fn phase<T: Default, E>(
        &mut self,
        (phase, wanted): (SweepPhase, bool),
        progress: &Progress,
        work: impl FnOnce() -> Result<T, E>,
    ) -> Result<T, E> {
        if !wanted {
            return Ok(T::default());
        }
        let done = work()?;
        if progress.stopped() {
            self.0.push(phase);
        }
        Ok(done)
    }

    /// Names of the missing phases for the file.
    pub fn words(&self) -> Vec<&'static str> {
        self.0.iter().map(|phase| phase.word()).collect()
    }
}

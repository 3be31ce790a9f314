//! What a sweep does, in its order, and what of it was not done.

use crate::control::{InstanceFlags, JournaledRun};
use crate::engine::Progress;
use crate::observe::Status;

/// What a sweep does, in its order. The words stand in the results file, as `incomplete_phase` and `missing`.
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
    /// Its name in the results file and in messages.
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

/// What a sweep has not done. Once something is missing, so is all that comes after it.
#[derive(Debug, Default)]
pub(super) struct MissingPhases(pub Vec<SweepPhase>);

impl MissingPhases {
    /// What of the instances themselves is missing; to be asked once they have run. Where nothing stopped the run, that is a
    /// fault of the program.
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

    /// Does a phase that was asked for; one that was stopped on the way or before, when it only finds what is known of it, is
    /// missing.
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

    /// As the file says it.
    pub fn words(&self) -> Vec<&'static str> {
        self.0.iter().map(|phase| phase.word()).collect()
    }
}

//! A run that was stopped on its way: in which phase, what its file lacks, and what the program says and returns.

use super::signals::{self, Signal};
use afmsweep::control::Controlled;
use afmsweep::engine::{Finished, Progress};
use afmsweep::observe::Status;
use std::path::Path;

/// What a run does, in its order. The words stand in the file, as `incomplete_phase` and `missing`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// Trials, and the first runs of every instance.
    Stepping,
    /// Runs with more steps or modes, and the test for sensitivity.
    Refinement,
    /// Second periodic states.
    Branches,
    Audit,
    Waveforms,
}

impl Phase {
    fn word(self) -> &'static str {
        match self {
            Self::Stepping => "stepping",
            Self::Refinement => "refinement",
            Self::Branches => "branches",
            Self::Waveforms => "waveforms",
            Self::Audit => "audit",
        }
    }
}

/// What a run has not done. Once something is missing, so is all that comes after it.
#[derive(Debug, Default)]
pub struct Missing(Vec<Phase>);

impl Missing {
    /// What of the instances themselves is missing; to be asked once they have run.
    pub fn of(run: &Controlled, progress: &Progress) -> Self {
        if !progress.stopped() {
            return Self::default();
        }
        let results = &run.outcome.results;
        let any = |what: &dyn Fn(&Finished) -> bool| results.iter().any(what);
        let mut missing = Vec::new();
        if any(&|one| one.status == Status::NotRun && !one.measured.is_any()) {
            missing.push(Phase::Stepping);
        }
        if any(&|one| one.status == Status::NotRun && one.measured.is_any()) {
            missing.push(Phase::Refinement);
        }
        Self(missing)
    }

    /// Does a phase that was asked for unless the run was stopped before; one that was stopped on the way is missing.
    pub fn phase<T: Default, E>(
        &mut self,
        (phase, wanted): (Phase, bool),
        progress: &Progress,
        work: impl FnOnce() -> Result<T, E>,
    ) -> Result<T, E> {
        if !wanted {
            return Ok(T::default());
        }
        let done = if progress.stopped() { T::default() } else { work()? };
        if progress.stopped() {
            self.0.push(phase);
        }
        Ok(done)
    }

    /// Whether nothing is.
    pub fn nothing(&self) -> bool {
        self.0.is_empty()
    }

    /// As the file says it.
    pub fn words(&self) -> Vec<&'static str> {
        self.0.iter().map(|phase| phase.word()).collect()
    }
}

/// Ends the program with the code of a signal, after saying what became of the run.
#[derive(Debug, thiserror::Error)]
#[error("{text}")]
pub struct Stopped {
    pub code: u8,
    text: String,
}

impl Stopped {
    fn new(text: impl FnOnce(&str) -> String) -> Self {
        // Nothing but a signal stops a run.
        let signal = signals::first().unwrap_or(Signal::Interrupt);
        Self { code: signal.code(), text: text(signal.word()) }
    }

    /// Before any instance was done.
    pub fn before(phase: &str) -> Self {
        Self::new(|word| format!("{word} in the {phase}, before any instance was done; nothing was written"))
    }

    /// With a partial file at `partial`.
    pub fn with(missing: &Missing, results: &[Finished], partial: &Path) -> Self {
        let done = results.iter().filter(|one| one.status != Status::NotRun).count();
        let begun =
            results.iter().filter(|one| one.status == Status::NotRun && one.measured.is_any()).count();
        let words = missing.words();
        let begun = match begun {
            0 => String::new(),
            _ => format!(" and {begun} whose error was not brought down (marked not_run)"),
        };
        Self::new(|word| {
            format!(
                "{word} in the {}: {done} of {} instances{begun} are in {}; missing: {}; run the scene again for a whole file",
                words.first().copied().unwrap_or("writing"),
                results.len(),
                partial.display(),
                words.join(", ")
            )
        })
    }
}

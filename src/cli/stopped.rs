//! A run that was stopped on its way: what the program says and returns.

use super::signals::{self, Signal};
use afmsweep::Status;
use afmsweep::control::Ran;
use afmsweep::sweep::{Phase, Share};
use std::path::Path;

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
    pub fn before(phase: Phase) -> Self {
        Self::new(|word| {
            format!("{word} in the {}, before any instance was done; nothing was written", phase.word())
        })
    }

    /// A share of a run, with its journal at `partial`.
    pub fn share(share: Share, partial: &Path) -> Self {
        Self::new(|word| {
            format!(
                "{word} in the stepping of share {share}: the portions that are done are in {}; run it again with --resume",
                partial.display()
            )
        })
    }

    /// Of a merge, with its journal at `partial`.
    pub fn merge(phase: Phase, partial: &Path) -> Self {
        Self::new(|word| {
            format!(
                "{word} in the {}: what is found so far is in {}; merge again to go on with it",
                phase.word(),
                partial.display()
            )
        })
    }

    /// With a partial file at `partial`.
    pub fn with(missing: &[Phase], run: &Ran, partial: &Path) -> Self {
        let done = run.len() - run.count(Status::NotRun);
        let begun = run.marks().iter().filter(|one| one.status() == Status::NotRun && one.measured()).count();
        let words: Vec<&str> = missing.iter().map(|phase| phase.word()).collect();
        let begun = match begun {
            0 => String::new(),
            _ => format!(" and {begun} whose error was not brought down (marked not_run)"),
        };
        Self::new(|word| {
            format!(
                "{word} in the {}: {done} of {} instances{begun} are in {}; missing: {}; run the scene again with --resume for a whole file",
                words.first().copied().unwrap_or("writing"),
                run.len(),
                partial.display(),
                words.join(", ")
            )
        })
    }
}

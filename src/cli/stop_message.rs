//! A run that did not come to its end: what the program says and returns.

use super::signals::{self, Signal};
use afmsweep::Status;
use afmsweep::control::JournaledRun;
use afmsweep::sweep::{Share, SweepPhase};
use std::path::Path;

/// Exit code where instances were not run though nothing stopped the run.
const LEFT_BEHIND: u8 = 4;

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
        let signal = signals::first().unwrap_or(Signal::INTERRUPT);
        Self { code: signal.code(), text: text(signal.word) }
    }

    /// Instances were not run though nothing stopped the run.
    pub fn left_behind(run: &JournaledRun, place: &str, partial: &Path) -> Self {
        let text = format!(
            "internal error: {} of {} instances were not run, though nothing stopped the run; the first is instance {place}. The \
             others are in {}. Please report this with the scene. `run --resume` tries them again, `--cold` by another way",
            run.count(Status::NotRun),
            run.len(),
            partial.display()
        );
        Self { code: LEFT_BEHIND, text }
    }

    /// The same of a share.
    pub fn share_left_behind(share: Share, partial: &Path) -> Self {
        let text = format!(
            "internal error: instances of share {share} were not run, though nothing stopped it. The others are in {}. Please report \
             this with the scene. `run --resume` tries them again, `--cold` by another way",
            partial.display()
        );
        Self { code: LEFT_BEHIND, text }
    }

    /// Before any instance was done.
    pub fn before(phase: SweepPhase) -> Self {
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
    pub fn merge(phase: SweepPhase, partial: &Path) -> Self {
        Self::new(|word| {
            format!(
                "{word} in the {}: what is found so far is in {}; merge again to go on with it",
                phase.word(),
                partial.display()
            )
        })
    }

    /// With a partial file at `partial`.
    pub fn with(missing: &[SweepPhase], run: &JournaledRun, partial: &Path) -> Self {
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

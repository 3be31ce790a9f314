//! Progress of a run, phase by phase, and the request to stop; shared with its display.

use super::ProfileSection;
use crate::clock::Instant;
use crate::periodic::SearchFailure;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

/// The present phase of a run, and its progress.
#[derive(Clone, Debug, PartialEq)]
pub struct ProgressPhase {
    /// Counts phases: another number is another phase.
    pub number: u64,
    /// As `run: search`.
    pub name: String,
    /// From 0 to 1; `None` if the amount of work is unknown. More work may turn up on the way, so it may fall.
    pub share: Option<f64>,
}

/// Progress of a run, and the request to stop.
#[derive(Debug, Default)]
pub struct Progress {
    counts: Arc<Counts>,
    stop: AtomicBool,
}

#[derive(Debug, Default)]
struct Counts {
    steps: AtomicU64,
    expected: AtomicU64,
    /// Nanoseconds by kind of work, summed over threads.
    busy: [AtomicU64; ProfileSection::ALL.len()],
    /// Searches that gave up, by reason.
    failures: [AtomicU64; SearchFailure::ALL.len()],
    /// Completed pieces of the phase, if it is counted in pieces.
    done: AtomicU64,
    /// Whether a phase is held, and ignores what the work within it reports.
    held: AtomicBool,
    now: Mutex<Now>,
}

/// The present phase.
#[derive(Debug, Default)]
struct Now {
    number: u64,
    /// Names of the stage's parts in turn, the last one for all further parts.
    names: &'static [&'static str],
    part: usize,
    task: String,
    /// Steps done and expected at its start.
    from: (u64, u64),
    /// Pieces to be done; 0 if it is counted in steps.
    pieces: u64,
}

impl Progress {
    /// Instance-steps done.
    pub fn steps(&self) -> u64 {
        self.counts.steps.load(Ordering::Relaxed)
    }

    /// Instance-steps expected, as far as known.
    pub fn expected(&self) -> u64 {
        self.counts.expected.load(Ordering::Relaxed)
    }

    /// Adds expected instance-steps.
    pub fn foresee(&self, steps: u64) {
        self.counts.expected.fetch_add(steps, Ordering::Relaxed);
    }

    /// Adds completed instance-steps.
    pub fn add(&self, steps: u64) {
        self.counts.steps.fetch_add(steps, Ordering::Relaxed);
    }

    /// Runs work of this kind and adds its time.
    pub fn timed<T>(&self, of: ProfileSection, work: impl FnOnce() -> T) -> T {
        let begun = Instant::now();
        let done = work();
        let time = begun.elapsed().as_nanos() as u64;
        self.counts.busy[of as usize].fetch_add(time, Ordering::Relaxed);
        done
    }

    /// Time spent on it by all threads together, s.
    pub fn seconds(&self, of: ProfileSection) -> f64 {
        self.counts.busy[of as usize].load(Ordering::Relaxed) as f64 * 1e-9
    }

    /// Counts a search that gave up.
    pub fn gave_up(&self, why: SearchFailure) {
        self.counts.failures[why as usize].fetch_add(1, Ordering::Relaxed);
    }

    /// How many searches gave up for this reason.
    pub fn failures(&self, why: SearchFailure) -> u64 {
        self.counts.failures[why as usize].load(Ordering::Relaxed)
    }

    /// Asks the run to end early; complete results are kept.
    pub fn stop(&self) {
        self.stop.store(true, Ordering::Relaxed);
    }

    /// Whether someone asked the run to end.
    pub fn stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// For work that may be stopped alone; its counts are shared.
    pub fn fork(&self) -> Self {
        Self { counts: Arc::clone(&self.counts), stop: AtomicBool::new(false) }
    }

    /// Begins a stage of the run. Its parts have these names in turn; further ones have the last name and a number.
    pub fn stage(&self, names: &'static [&'static str]) {
        self.begin(0, |now| (now.names, now.part, now.task) = (names, 0, String::new()));
    }

    /// Begins the next part of the stage.
    pub fn part(&self) {
        self.begin(0, |now| (now.part, now.task) = (now.part + 1, String::new()));
    }

    /// Begins a task of the part, of `pieces` pieces (see [`Progress::done`]), or 0 to count steps.
    pub fn task(&self, name: impl Into<String>, pieces: u64) {
        self.begin(pieces, |now| now.task = name.into());
    }

    /// Adds completed pieces of the task.
    pub fn done(&self, pieces: u64) {
        if !self.counts.held.load(Ordering::Relaxed) {
            self.counts.done.fetch_add(pieces, Ordering::Relaxed);
        }
    }

    /// Begins a phase of `pieces` pieces that lasts until the returned guard is dropped, for work whose parts run side by
    /// side. What the parts report is ignored.
    pub fn hold(&self, names: &'static [&'static str], pieces: u64) -> HeldPhase<'_> {
        self.begin(pieces, |now| (now.names, now.part, now.task) = (names, 0, String::new()));
        self.counts.held.store(true, Ordering::Relaxed);
        HeldPhase(self)
    }

    fn begin(&self, pieces: u64, change: impl FnOnce(&mut Now)) {
        if self.counts.held.load(Ordering::Relaxed) {
            return;
        }
        let mut now = self.counts.now.lock().unwrap_or_else(PoisonError::into_inner);
        change(&mut now);
        now.number += 1;
        (now.from, now.pieces) = ((self.steps(), self.expected()), pieces);
        self.counts.done.store(0, Ordering::Relaxed);
    }

    /// The present phase.
    pub fn phase(&self) -> ProgressPhase {
        let now = self.counts.now.lock().unwrap_or_else(PoisonError::into_inner);
        let part = now.part.max(1);
        let mut name = now.names.get(part - 1).or(now.names.last()).copied().unwrap_or("run").to_owned();
        let again = (part + 1).saturating_sub(now.names.len().max(1));
        if again > 1 {
            name += &format!(" {again}");
        }
        if !now.task.is_empty() {
            name += &format!(": {}", now.task);
        }
        let (done, all) = match now.pieces {
            0 => (self.steps() - now.from.0, self.expected().saturating_sub(now.from.1)),
            pieces => (self.counts.done.load(Ordering::Relaxed), pieces),
        };
        let share = (all > 0).then(|| (done as f64 / all as f64).min(1.0));
        ProgressPhase { number: now.number, name, share }
    }
}

/// A phase that ignores what the work within it reports.
#[derive(Debug)]
pub struct HeldPhase<'a>(&'a Progress);

impl HeldPhase<'_> {
    /// Adds completed pieces of it.
    pub fn done(&self, pieces: u64) {
        self.0.counts.done.fetch_add(pieces, Ordering::Relaxed);
    }
}

impl Drop for HeldPhase<'_> {
    fn drop(&mut self) {
        self.0.counts.held.store(false, Ordering::Relaxed);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seen(progress: &Progress) -> (String, Option<f64>) {
        let phase = progress.phase();
        (phase.name, phase.share)
    }

    #[test]
    fn each_part_and_task_begins_anew_under_its_own_name() {
        let progress = Progress::default();
        progress.stage(&["estimate", "run", "refinement"]);
        progress.part();
        progress.foresee(10);
        progress.add(5);
        assert_eq!(seen(&progress), ("estimate".into(), Some(0.5)));
        progress.part();
        assert_eq!(seen(&progress), ("run".into(), None));
        progress.task("search", 4);
        progress.done(1);
        progress.foresee(100);
        assert_eq!(seen(&progress), ("run: search".into(), Some(0.25)));
        let before = progress.phase().number;
        progress.part();
        assert_eq!(seen(&progress), ("refinement".into(), None));
        assert!(progress.phase().number > before);
        progress.part();
        assert_eq!(seen(&progress).0, "refinement 2");
    }

    #[test]
    fn a_held_phase_hears_nothing_of_what_runs_within_it() {
        let progress = Progress::default();
        let held = progress.hold(&["run"], 8);
        progress.part();
        progress.task("search", 3);
        progress.done(3);
        held.done(2);
        assert_eq!(seen(&progress), ("run".into(), Some(0.25)));
        drop(held);
        progress.stage(&["branches"]);
        assert_eq!(seen(&progress), ("branches".into(), None));
    }

    #[test]
    fn a_fork_counts_with_the_whole_and_stops_alone() {
        let progress = Progress::default();
        let fork = progress.fork();
        fork.add(3);
        fork.stop();
        assert_eq!((progress.steps(), progress.stopped(), fork.stopped()), (3, false, true));
    }
}

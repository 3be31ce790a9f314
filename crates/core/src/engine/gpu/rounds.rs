//! Sequences of dispatches: those of a period, and those of a search, whose rounds consist of a period and a solver step for
//! all instances in progress.

use super::Failure;
use super::pace::Pace;
use super::session::{Later, Session};
use crate::engine::Progress;
use std::time::Instant;
use wgpu::{Buffer, SubmissionIndex};

/// Issues the dispatches of a piece, for periods of `steps` steps.
pub(super) struct Dispatches<'a> {
    pub session: &'a Session,
    pub pace: &'a mut Pace,
    pub progress: &'a Progress,
    pub steps: u32,
    /// Most steps of a dispatch.
    pub longest: u32,
}

/// First step of a dispatch, and number of its steps.
type Part = (u32, u32);

/// A piece of a search.
pub(super) trait Search {
    /// Dispatches some steps of all instances in progress in a round.
    fn period(&self, round: u32, part: Part) -> Result<SubmissionIndex, Failure>;

    /// Dispatches a solver step for each of them.
    fn stride(&self, round: u32) -> Result<SubmissionIndex, Failure>;

    /// The number of instances in progress, by round.
    fn going(&self) -> &Buffer;
}

/// The dispatch that runs, and its steps.
type Running = Option<(SubmissionIndex, u64)>;

impl Dispatches<'_> {
    /// One period; false if the run was stopped.
    pub fn once(
        &mut self,
        dispatch: impl Fn(Part) -> Result<SubmissionIndex, Failure>,
    ) -> Result<bool, Failure> {
        self.period(&mut None, dispatch)
    }

    fn period(
        &mut self,
        running: &mut Running,
        dispatch: impl Fn(Part) -> Result<SubmissionIndex, Failure>,
    ) -> Result<bool, Failure> {
        let mut clock = Instant::now();
        let mut at = 0;
        while at < self.steps {
            if self.progress.stopped() {
                return Ok(false);
            }
            let count = self.pace.steps(self.steps, at, self.longest).min(u64::from(self.steps - at));
            let submitted = dispatch((at, count as u32))?;
            at += count as u32;
            // One dispatch runs while the next is prepared.
            if let Some((before, count)) = running.replace((submitted, count)) {
                self.session.wait(before)?;
                self.pace.took(count, clock.elapsed());
                clock = Instant::now();
            }
        }
        Ok(true)
    }

    /// Runs rounds until no search is in progress, `most` at most; false if stopped. A round is enqueued while the one before
    /// it runs, before that one's remaining number is known. So at most one round is enqueued in vain, and its threads end at
    /// once.
    pub fn rounds(&mut self, most: u32, search: &impl Search) -> Result<bool, Failure> {
        let mut running = None;
        let mut left: Option<Later> = None;
        for round in 0..most {
            if !self.period(&mut running, |part| search.period(round, part))? {
                return Ok(false);
            }
            search.stride(round)?;
            let next = self.session.later(search.going(), 4 * u64::from(round + 1), 4)?;
            // The round before is complete by now.
            if let Some(before) = left.replace(next)
                && bytemuck::pod_collect_to_vec::<u8, u32>(&self.session.now(&before)?) == [0]
            {
                break;
            }
        }
        Ok(true)
    }
}

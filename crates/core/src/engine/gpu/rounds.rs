//! Dispatches one after another: those of a period, and the rounds of a search, each a period of all that are under way and a
//! stride of each.

use super::Failure;
use super::pace::Pace;
use super::session::{Later, Session};
use crate::engine::Progress;
use std::time::Instant;
use wgpu::{Buffer, SubmissionIndex};

/// What hands out a piece's dispatches, for periods of so many steps.
pub(super) struct Dispatches<'a> {
    pub session: &'a Session,
    pub pace: &'a mut Pace,
    pub progress: &'a Progress,
    pub steps: u32,
    /// Most steps of a dispatch.
    pub longest: u32,
}

/// What one dispatch does: it begins at a step, and takes so many.
type Part = (u32, u32);

/// A piece of a search.
pub(super) trait Search {
    /// So many steps of all that are under way in a round.
    fn period(&self, round: u32, part: Part) -> Result<SubmissionIndex, Failure>;

    /// A stride of each of them.
    fn stride(&self, round: u32) -> Result<SubmissionIndex, Failure>;

    /// How many are under way, by round.
    fn going(&self) -> &Buffer;
}

/// The dispatch that runs, and its steps.
type Running = Option<(SubmissionIndex, u64)>;

impl Dispatches<'_> {
    /// One period; false where the run was stopped.
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
                self.session.wait(Some(before))?;
                self.pace.took(count, clock.elapsed());
                clock = Instant::now();
            }
        }
        Ok(true)
    }

    /// Rounds until none is under way, so many at most; false where the search was stopped. While a round is enqueued the one
    /// before it runs, and how many that one leaves is not known: at most one round is enqueued in vain, and its threads end at
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
            // By now the round before has been waited for.
            if let Some(before) = left.replace(next)
                && bytemuck::pod_collect_to_vec::<u8, u32>(&self.session.now(&before)?) == [0]
            {
                break;
            }
        }
        Ok(true)
    }
}

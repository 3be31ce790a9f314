//! Searches from many starts, piece by piece. Each piece is stored when done, and stored results are not searched for again.

use super::chunk::ChunkJournal;
use super::followup::{FollowupKey, FollowupKind, FollowupResult};
use crate::clock::Instant;
use crate::engine::{Engine, EngineError, Finished, Progress};
use crate::orbit::{self, Jacobian, OrbitSolution, PeriodicState};
use crate::plan::{Plan, SectionState};
use std::cell::{Cell, RefCell};
use std::time::Duration;

/// Target time of a piece: a killed run loses about this much.
const CHECKPOINT_INTERVAL: Duration = Duration::from_secs(5);
/// Size of the first piece for each thread. Slow instances take a tenth of a second.
const FIRST_SEARCHES_PER_THREAD: usize = 64;
/// Largest growth from one piece to the next.
const MAX_SIZE_GROWTH: f64 = 4.0;

/// A result and its state. None if a stopped run has not searched.
pub(super) type FoundOrbit = Option<(Finished, Option<Box<PeriodicState>>)>;

/// Searches for the states of these instances, whose plan is given.
type FollowupSearch<'a> = &'a dyn Fn(&Plan, &[u32]) -> Result<OrbitSolution, EngineError>;

/// The engine of the searches, and the journal of earlier ones.
pub(super) struct CheckpointedSearch<'a> {
    pub engine: &'a dyn Engine,
    pub progress: &'a Progress,
    keep: &'a dyn ChunkJournal,
    size: Cell<usize>,
    /// Messages for the user.
    pub notes: RefCell<Vec<String>>,
}

impl<'a> CheckpointedSearch<'a> {
    pub fn new(keep: &'a dyn ChunkJournal, engine: &'a dyn Engine, progress: &'a Progress) -> Self {
        let size =
            if keep.lasts() { FIRST_SEARCHES_PER_THREAD * rayon::current_num_threads() } else { usize::MAX };
        Self { engine, progress, keep, size: Cell::new(size), notes: RefCell::default() }
    }

    /// Searches for the state of each of the plan's instances from its start; see [`orbit::solve_from_sections`].
    pub fn solve_from_sections(
        &self,
        plan: &Plan,
        places: &[SectionState],
    ) -> Result<Vec<FoundOrbit>, EngineError> {
        let questions: Vec<FollowupKey> = plan
            .instances()
            .zip(places)
            .map(|(i, place)| FollowupKey::new(FollowupKind::State, plan, i, Some(place)))
            .collect();
        self.answer(plan, &questions, &|part, piece| {
            let places: Vec<SectionState> = piece.iter().map(|i| places[*i as usize]).collect();
            orbit::solve_from_sections(part, &places, self.engine, self.progress)
        })
    }

    /// Searches from the lever at rest; see [`orbit::solve_from_rest`].
    pub fn solve_from_rest(&self, plan: &Plan) -> Result<Vec<FoundOrbit>, EngineError> {
        let questions: Vec<FollowupKey> =
            plan.instances().map(|i| FollowupKey::new(FollowupKind::FromRest, plan, i, None)).collect();
        self.answer(plan, &questions, &|part, _| {
            let all: Vec<u32> = part.instances().collect();
            orbit::solve_from_rest(part, &all, self.engine, self.progress)
        })
    }

    /// Answers a question about each of the plan's instances, from the journal or by `search`.
    fn answer(
        &self,
        plan: &Plan,
        questions: &[FollowupKey],
        search: FollowupSearch,
    ) -> Result<Vec<FoundOrbit>, EngineError> {
        let recalled = self.keep.recalled(questions).into_iter().zip(plan.instances());
        let mut found: Vec<FoundOrbit> = recalled.map(|(one, i)| Some(one?.state(plan, i))).collect();
        let mut open = plan.by_class();
        open.retain(|i| found[*i as usize].is_none());
        let many = open.len() > self.size.get();
        let held = many.then(|| self.progress.hold(&["branches"], open.len() as u64));
        let mut rest = &open[..];
        while !rest.is_empty() && !self.progress.stopped() {
            let (piece, later) = rest.split_at(rest.len().min(self.size.get()));
            let start = Instant::now();
            let part = plan.part(piece);
            let OrbitSolution { outcome, found: states, .. } = search(&part, piece)?;
            if self.progress.stopped() {
                // A stopped search has not looked everywhere.
                break;
            }
            self.notes.borrow_mut().extend(outcome.notes);
            let all: Vec<(FollowupKey, FollowupResult)> = piece
                .iter()
                .zip(outcome.results.iter().zip(&states))
                .map(|(i, (one, state))| {
                    (questions[*i as usize], FollowupResult::of_state(*one, state.as_deref()))
                })
                .collect();
            if self.keep.answered(&all).is_break() {
                self.progress.stop();
            }
            for (i, (one, state)) in piece.iter().zip(outcome.results.into_iter().zip(states)) {
                // The Jacobian is not needed again.
                let state =
                    state.map(|state| Box::new(PeriodicState { jacobian: Jacobian::Unknown, ..*state }));
                found[*i as usize] = Some((one, state));
            }
            if let Some(held) = &held {
                held.done(piece.len() as u64);
            }
            if !later.is_empty() {
                self.size.set(next_size(piece.len(), start.elapsed()));
            }
            rest = later;
        }
        Ok(found)
    }
}

/// Size of the next piece, given the size and the duration of the last.
fn next_size(count: usize, lasted: Duration) -> usize {
    let factor = CHECKPOINT_INTERVAL.as_secs_f64() / lasted.as_secs_f64().max(1e-3);
    ((count as f64 * factor.clamp(1.0 / MAX_SIZE_GROWTH, MAX_SIZE_GROWTH)) as usize).max(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_come_to_last_as_long_as_they_may() {
        let second = Duration::from_secs(1);
        assert_eq!(next_size(100, 5 * second), 100);
        assert_eq!(next_size(100, 10 * second), 50);
        assert_eq!(next_size(100, 1000 * second), 25);
        assert_eq!(next_size(100, second / 1000), 400);
        assert_eq!(next_size(1, 1000 * second), 1);
    }
}

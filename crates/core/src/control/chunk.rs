//! Chunks of a run that have ended, and who keeps them.

use super::ChunkRun;
use super::codec::{ChunkReader, portion_to_bytes as to_bytes};
use super::compact_orbit::CompactOrbit;
use super::followup::{AuditBudget, FollowupKey, FollowupResult};
use super::instance_flags::{InstanceFacts, InstanceFlags};
use super::instance_record::{ChunkMeta, InstanceRecord};
use crate::engine::{Finished, WantedColumns};
use std::ops::{ControlFlow, Range};

/// A chunk that has ended: what is held of it in memory, and the bytes that are kept.
#[derive(Clone, Debug)]
pub struct Chunk {
    pub meta: ChunkMeta,
    /// Of its instances, in its order.
    pub flags: Vec<InstanceFlags>,
    /// How many of their results began at their neighbours' states.
    pub neighbour_started: usize,
    pub bytes: Vec<u8>,
}

/// What is known of a run before it begins, of its chunks and of what is asked after them, who is told of what ends, and
/// where chunks are that have ended.
pub trait ChunkJournal: Sync {
    /// In how many shares the run is done: these decide how it is divided.
    fn shares(&self) -> usize {
        1
    }

    /// Whether this run does one of them: what is asked of all instances together is left to who has all.
    fn partly(&self) -> bool {
        false
    }

    /// Whether this run is to do the chunk of this number.
    fn wanted(&self, _number: usize) -> bool {
        true
    }

    /// Its bytes, if an earlier run has ended it with so many instances. One that was not whole is shown and not gone on with.
    fn known(&self, _number: usize, _instances: usize) -> Option<Vec<u8>> {
        None
    }

    /// A chunk has ended, or a part of it where it is not whole, and its bytes are to be kept; a break ends the run.
    fn ended(&self, number: usize, whole: bool, bytes: Vec<u8>) -> ControlFlow<()>;

    /// Some of the bytes of a chunk that has ended in this run, or that was known before. Whether they are what was kept is
    /// the reader's to know.
    ///
    /// # Errors
    /// In words, why they cannot be had.
    fn bytes(&self, number: usize, range: Range<usize>) -> Result<Vec<u8>, String>;

    /// Whether what it is told outlasts the run: then it is told of pieces of the work.
    fn lasts(&self) -> bool {
        false
    }

    /// The answers that an earlier run has found, one for each question.
    fn recalled(&self, asked: &[FollowupKey]) -> Vec<Option<FollowupResult>> {
        vec![None; asked.len()]
    }

    /// Questions that have been answered; a break ends the run.
    fn answered(&self, _all: &[(FollowupKey, FollowupResult)]) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    /// The instances that an earlier run's audit has redone.
    fn redone(&self) -> Vec<u32> {
        Vec::new()
    }

    /// The numbers that answer a question of another kind, as an earlier run has found them.
    fn numbers(&self, _asked: &FollowupKey) -> Option<Vec<f64>> {
        None
    }

    /// Numbers that answer such a question; a break ends the run.
    fn numbered(&self, _asked: &FollowupKey, _numbers: &[f64]) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    /// What an earlier run's audit has spent.
    fn allowance(&self) -> Option<AuditBudget> {
        None
    }

    /// What the audit has spent so far; a break ends the run.
    fn spent(&self, _so_far: AuditBudget) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}

impl Chunk {
    /// Of a run of some instances. What is measured in any case and was not asked for is not kept.
    pub(super) fn of(run: &ChunkRun, number: usize, whole: bool) -> Self {
        let (plan, results) = (&run.plan, &run.outcome.results);
        let is_told = |all: &[bool], n: usize| all.get(n).is_some_and(|told| *told);
        let wanted = WantedColumns::by(&plan.observables);
        let instance = |n: usize| {
            let rest = run.from_rest.get(n).and_then(Option::as_ref);
            InstanceRecord {
                finished: Finished { measured: wanted.only(&results[n].measured), ..results[n] },
                estimate: run.estimates[n],
                left_out: run.truncation[n],
                periods: run.periods[n],
                jump: is_told(&run.jumps, n),
                neighbour_started: is_told(&run.neighbour_started, n),
                precision: run.arithmetic.of[n],
                fineness: plan.resolution_of(n as u32),
                state: run.found.get(n).and_then(|state| state.as_deref()).map(CompactOrbit::of),
                from_rest: rest.map(|rest| Box::new((rest.finished, CompactOrbit::of(&rest.orbit)))),
            }
        };
        let mark = |n: usize| {
            let seen = InstanceFacts {
                status: results[n].status,
                stepped: plan.resolution_of(n as u32).steps > 0,
                measured: results[n].measured.is_any(),
                estimate: run.estimates[n],
                found: run.found.get(n).is_some_and(Option::is_some),
                precision: run.arithmetic.of[n],
            };
            InstanceFlags::of(seen, plan.run.accuracy)
        };
        let about = ChunkMeta {
            whole,
            searched: !run.found.is_empty(),
            curves: !run.jumps.is_empty(),
            from_rest: !run.from_rest.is_empty(),
            notes: run.outcome.notes.clone(),
        };
        let bytes = to_bytes(number, &about, plan.len(), instance);
        let neighbour_started = run.neighbour_started.iter().filter(|begun| **begun).count();
        Self { meta: about, flags: (0..plan.len()).map(mark).collect(), neighbour_started, bytes }
    }

    /// Of its bytes; none where they are no such chunk of so many instances. How many there are is the caller's to know:
    /// bytes may tell of more than there is memory for.
    pub fn of_bytes(bytes: Vec<u8>, (number, count): (usize, usize), accuracy: f64) -> Option<Self> {
        let source = |range: Range<usize>| Ok(bytes.get(range).ok_or("it is cut off")?.to_vec());
        let view = ChunkReader::of(&source, number, count).ok()?;
        let about = view.meta().filter(|_| view.length() == bytes.len())?;
        let (marks, neighbour_started) = view.flags(accuracy)?;
        if view.failure().is_some() {
            return None;
        }
        drop(view);
        Some(Self { meta: about, flags: marks, neighbour_started, bytes })
    }

    /// Whether it is whole, or anything was measured of its instances: else there is nothing to keep.
    pub fn is_any(&self) -> bool {
        self.meta.whole || self.flags.iter().any(|mark| mark.measured())
    }
}

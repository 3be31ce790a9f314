//! Finished chunks of a run, and the interface to their storage.

use super::ChunkRun;
use super::codec::{ChunkReader, portion_to_bytes as to_bytes};
use super::compact_orbit::CompactOrbit;
use super::followup::{AuditBudget, FollowupKey, FollowupResult};
use super::instance_flags::{InstanceFacts, InstanceFlags};
use super::instance_record::{ChunkMeta, InstanceRecord};
use crate::engine::{Finished, WantedColumns};
use std::ops::{ControlFlow, Range};

/// A finished chunk: the part that stays in memory, and the bytes to be stored.
#[derive(Clone, Debug)]
pub struct Chunk {
    pub meta: ChunkMeta,
    /// Flags of its instances, in the chunk's order.
    pub flags: Vec<InstanceFlags>,
    /// Number of results from searches started at neighbours' states.
    pub neighbour_started: usize,
    pub bytes: Vec<u8>,
}

/// Storage of a run: finished chunks of this and earlier runs, and answers to follow-up questions.
pub trait ChunkJournal: Sync {
    /// Number of shares that the run is split into. Chunk sizes depend on it.
    fn shares(&self) -> usize {
        1
    }

    /// Whether this run computes one share. Questions about all instances then wait until the shares are joined.
    fn partly(&self) -> bool {
        false
    }

    /// Whether this run computes the chunk of this number.
    fn wanted(&self, _number: usize) -> bool {
        true
    }

    /// Bytes of a chunk of this many instances from an earlier run. An incomplete chunk is shown, not continued.
    fn known(&self, _number: usize, _instances: usize) -> Option<Vec<u8>> {
        None
    }

    /// Stores the bytes of a finished chunk, or of part of one if it is not `whole`. A break ends the run.
    fn ended(&self, number: usize, whole: bool, bytes: Vec<u8>) -> ControlFlow<()>;

    /// Reads a range of a chunk's bytes, finished in this run or before. The reader checks that they are what was stored.
    ///
    /// # Errors
    /// Says why the bytes cannot be read.
    fn bytes(&self, number: usize, range: Range<usize>) -> Result<Vec<u8>, String>;

    /// Whether storage outlasts the run. If so, it also receives checkpoints of searches and audits.
    fn lasts(&self) -> bool {
        false
    }

    /// Answers that an earlier run found, one entry for each question.
    fn recalled(&self, asked: &[FollowupKey]) -> Vec<Option<FollowupResult>> {
        vec![None; asked.len()]
    }

    /// Stores answers to questions. A break ends the run.
    fn answered(&self, _all: &[(FollowupKey, FollowupResult)]) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    /// Instances that an earlier run's audit has redone.
    fn redone(&self) -> Vec<u32> {
        Vec::new()
    }

    /// Numbers that answer another kind of question, from an earlier run.
    fn numbers(&self, _asked: &FollowupKey) -> Option<Vec<f64>> {
        None
    }

    /// Stores such numbers. A break ends the run.
    fn numbered(&self, _asked: &FollowupKey, _numbers: &[f64]) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    /// Time that an earlier run's audit has spent.
    fn allowance(&self) -> Option<AuditBudget> {
        None
    }

    /// Stores the time that the audit has spent so far. A break ends the run.
    fn spent(&self, _so_far: AuditBudget) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}

impl Chunk {
    /// Packs a run of some instances. Measured quantities that nobody requested are dropped.
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

    /// Reads a chunk from its bytes. None if they are no such chunk. The caller provides the number of instances, because
    /// damaged bytes may claim more than memory can hold.
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

    /// Whether the chunk is whole or has any measurement. Otherwise there is nothing to store.
    pub fn is_any(&self) -> bool {
        self.meta.whole || self.flags.iter().any(|mark| mark.measured())
    }
}

//! A chunk of instances that runs on a device, dispatch by dispatch.

use super::pace::Pace;
use super::pack::{self, Numbers, Tables};
use super::piece_buffers::PieceBuffers;
use super::session::Session;
use super::{Drill, Failure};
use crate::engine::Progress;
use crate::engine::checkpoint::InstanceCheckpoint;
use crate::engine::cpu::decays;
use crate::kernel::ShaderSpec;
use crate::plan::{Class, Plan};
use std::time::{Duration, Instant};
use wgpu::{Buffer, BufferUsages, SubmissionIndex};

/// Time between two copies of the state to the host.
const SAVE_EVERY: Duration = Duration::from_secs(5);
/// Bytes of decaying free motion sent with one dispatch.
const DECAY_BYTES: u64 = 16 << 20;

/// The states of a chunk's instances after `done` periods.
pub(super) struct Checkpoint {
    pub saved: Vec<InstanceCheckpoint>,
    pub done: u32,
}

impl Checkpoint {
    /// The checkpoint of some of the instances.
    pub fn part(&self, range: std::ops::Range<usize>) -> Self {
        Self { saved: self.saved[range].to_vec(), done: self.done }
    }
}

/// A chunk on a device.
pub(super) struct Chunk<'a> {
    pub plan: &'a Plan,
    pub class: &'a Class,
    pub session: &'a Session,
    pub drill: &'a Drill,
    tables: &'a Tables,
    job: Buffer,
    on: PieceBuffers,
    marks: Buffer,
}

impl<'a> Chunk<'a> {
    /// Creates buffers for the tables.
    pub fn new(
        plan: &'a Plan,
        class: &'a Class,
        session: &'a Session,
        drill: &'a Drill,
        tables: &'a Tables,
    ) -> Result<Self, Failure> {
        let write = BufferUsages::STORAGE | BufferUsages::COPY_SRC;
        Ok(Self {
            job: PieceBuffers::job(session)?,
            on: PieceBuffers::new(session, drill, &tables.piece)?,
            marks: session.buffer("marks", bytemuck::cast_slice(&tables.marks), write)?,
            plan,
            class,
            session,
            drill,
            tables,
        })
    }

    /// Steps the chunk from `done` periods to the end of the run, and keeps the latest checkpoint.
    pub fn run(
        &self,
        done: u32,
        pace: &mut Pace,
        checkpoint: &mut Option<Checkpoint>,
        progress: &Progress,
    ) -> Result<Option<Vec<InstanceCheckpoint>>, Failure> {
        let steps = u64::from(self.class.steps);
        let warm = u64::from(self.plan.run.periods - self.plan.run.measure) * steps;
        let total = u64::from(self.plan.run.periods) * steps;
        let begun = u64::from(done) * steps;
        let mut at = begun;
        let mut pending: Option<(SubmissionIndex, u64)> = None;
        let mut clock = Instant::now();
        let mut kept = Instant::now();
        while at < total {
            if progress.stopped() {
                return Ok(None);
            }
            let limit = if at < warm { warm } else { total };
            let count = pace.steps(self.class.steps, (at % steps) as u32, self.longest()).min(limit - at);
            let submitted = self.dispatch(at, count as u32, at >= warm)?;
            at += count;
            // One dispatch runs while the next is prepared.
            if let Some((before, count)) = pending.replace((submitted, count)) {
                self.session.wait(before)?;
                pace.took(count, clock.elapsed());
                progress.add(count * u64::from(self.tables.piece.count()));
                clock = Instant::now();
            }
            if at % steps == 0 && at < total && kept.elapsed() > self.drill.save_every.unwrap_or(SAVE_EVERY) {
                let saved = self.saved(at - begun)?;
                *checkpoint = Some(Checkpoint { saved, done: (at / steps) as u32 });
                kept = Instant::now();
            }
        }
        if let Some((last, count)) = pending {
            self.session.wait(last)?;
            progress.add(count * u64::from(self.tables.piece.count()));
        }
        self.saved(total - begun).map(Some)
    }

    /// Most steps of a dispatch that its table of decaying motion allows.
    fn longest(&self) -> u32 {
        if !self.tables.piece.spec.decay {
            return u32::MAX;
        }
        let row = 3 * self.tables.piece.spec.bytes() * self.tables.piece.drives.len() as u64;
        (DECAY_BYTES / row).max(1) as u32
    }

    fn dispatch(&self, at: u64, count: u32, measured: bool) -> Result<SubmissionIndex, Failure> {
        self.drill.strike(self.session);
        let (piece, on) = (&self.tables.piece, &self.on);
        let job = piece.job(0, (at % u64::from(self.class.steps)) as u32, count);
        let mut buffers = vec![
            &self.job,
            &on.waves,
            &on.drives,
            &on.cases,
            &on.drive_of,
            &on.states,
            &self.marks,
            &on.going,
        ];
        let table;
        if self.tables.piece.spec.decay {
            table = self.decay_table(at, count)?;
            buffers.push(&table);
        }
        self.session.dispatch(ShaderSpec { measured, ..piece.spec }, job, piece.count(), &buffers)
    }

    /// `[drive][step][travel, speed, acceleration]` for this dispatch.
    fn decay_table(&self, at: u64, count: u32) -> Result<Buffer, Failure> {
        let rows = self.tables.piece.drives.iter().flat_map(|drive| {
            let driven = &self.plan.drives[*drive as usize];
            decays::<f64>(driven, self.class.steps, at, count as usize)
        });
        let values = rows.flat_map(|row| [row.travel, row.speed, row.acceleration]).collect();
        let numbers = Numbers::new(self.tables.piece.spec.double, values);
        self.session.buffer("decays", numbers.bytes(), BufferUsages::STORAGE)
    }

    /// Waits, reads the state back, and checks that each instance did `steps` steps.
    fn saved(&self, steps: u64) -> Result<Vec<InstanceCheckpoint>, Failure> {
        let count = self.tables.piece.count() as usize;
        let (states, marks) = (self.tables.piece.states.bytes().len() as u64, 8 * count as u64);
        let bytes = self.session.read(&[(&self.on.states, states), (&self.marks, marks)])?;
        let marks: Vec<u32> = bytemuck::pod_collect_to_vec(&bytes[1]);
        let expected = steps as u32;
        match marks[..count].iter().find(|done| **done != expected) {
            Some(done) => Err(Failure::Steps { done: *done, expected }),
            None => Ok(pack::saved(
                &self.tables.piece.spec,
                &Numbers::read(self.tables.piece.spec.double, &bytes[0]),
                &marks,
            )),
        }
    }
}

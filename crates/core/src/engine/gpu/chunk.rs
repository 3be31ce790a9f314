//! A chunk of instances that runs on a device, dispatch by dispatch.

use super::pace::Pace;
use super::pack::{self, Numbers, Tables};
use super::session::{Job, Session};
use super::{Drill, Failure};
use crate::engine::Progress;
use crate::engine::checkpoint::InstanceCheckpoint;
use crate::engine::cpu::decays;
use crate::kernel::{Entry, ShaderSpec};
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
    spec: ShaderSpec,
    tables: &'a Tables,
    job: Buffer,
    waves: Buffer,
    drives: Buffer,
    cases: Buffer,
    drive_of: Buffer,
    states: Buffer,
    marks: Buffer,
    going: Buffer,
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
        if drill.memory_for.is_some_and(|most| tables.instances.len() > most) {
            return Err(Failure::Memory);
        }
        let read = BufferUsages::STORAGE;
        let write = BufferUsages::STORAGE | BufferUsages::COPY_SRC;
        let going: Vec<u32> = pack::going(Entry::Sweep, tables.instances.len() as u32).collect();
        let (name, uniform) = ("job", BufferUsages::UNIFORM | BufferUsages::COPY_DST);
        Ok(Self {
            job: session.empty(name, size_of::<Job>() as u64, uniform)?,
            waves: session.buffer("waves", tables.waves.bytes(), read)?,
            drives: session.buffer("drives", tables.drive_table.bytes(), read)?,
            cases: session.buffer("cases", tables.cases.bytes(), read)?,
            drive_of: session.buffer("drive_of", bytemuck::cast_slice(&tables.drive_of), read)?,
            states: session.buffer("states", tables.states.bytes(), write)?,
            marks: session.buffer("marks", bytemuck::cast_slice(&tables.marks), write)?,
            going: session.buffer("going", bytemuck::cast_slice(&going), read)?,
            spec: tables.spec,
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
                self.session.wait(Some(before))?;
                pace.took(count, clock.elapsed());
                progress.add(count * self.tables.instances.len() as u64);
                clock = Instant::now();
            }
            if at % steps == 0 && at < total && kept.elapsed() > self.drill.save_every.unwrap_or(SAVE_EVERY) {
                let saved = self.saved(at - begun)?;
                *checkpoint = Some(Checkpoint { saved, done: (at / steps) as u32 });
                kept = Instant::now();
            }
        }
        if let Some((last, count)) = pending {
            self.session.wait(Some(last))?;
            progress.add(count * self.tables.instances.len() as u64);
        }
        self.saved(total - begun).map(Some)
    }

    /// Most steps of a dispatch that its table of decaying motion allows.
    fn longest(&self) -> u32 {
        if !self.spec.decay {
            return u32::MAX;
        }
        let row = 3 * self.spec.bytes() * self.tables.drives.len() as u64;
        (DECAY_BYTES / row).max(1) as u32
    }

    fn dispatch(&self, at: u64, count: u32, measured: bool) -> Result<SubmissionIndex, Failure> {
        self.drill.strike(self.session);
        let (instances, drives) = (self.tables.instances.len() as u32, self.tables.drives.len() as u32);
        let steps = self.class.steps;
        let first = (at % u64::from(steps)) as u32;
        let job = Job { instances, drives, steps, first, count, width: 0, round: 0 };
        let mut buffers = vec![
            &self.job,
            &self.waves,
            &self.drives,
            &self.cases,
            &self.drive_of,
            &self.states,
            &self.marks,
            &self.going,
        ];
        let table;
        if self.spec.decay {
            table = self.decay_table(at, count)?;
            buffers.push(&table);
        }
        self.session.dispatch(ShaderSpec { measured, ..self.spec }, job, instances, &buffers)
    }

    /// `[drive][step][travel, speed, acceleration]` for this dispatch.
    fn decay_table(&self, at: u64, count: u32) -> Result<Buffer, Failure> {
        let rows = self.tables.drives.iter().flat_map(|drive| {
            let driven = &self.plan.drives[*drive as usize];
            decays::<f64>(driven, self.class.steps, at, count as usize)
        });
        let values = rows.flat_map(|row| [row.travel, row.speed, row.acceleration]).collect();
        let numbers = Numbers::new(self.spec.double, values);
        self.session.buffer("decays", numbers.bytes(), BufferUsages::STORAGE)
    }

    /// Waits, reads the state back, and checks that each instance did `steps` steps.
    fn saved(&self, steps: u64) -> Result<Vec<InstanceCheckpoint>, Failure> {
        let count = self.tables.instances.len();
        let (states, marks) = (self.tables.states.bytes().len() as u64, 8 * count as u64);
        let bytes = self.session.read(&[(&self.states, states), (&self.marks, marks)])?;
        let marks: Vec<u32> = bytemuck::pod_collect_to_vec(&bytes[1]);
        let expected = steps as u32;
        match marks[..count].iter().find(|done| **done != expected) {
            Some(done) => Err(Failure::Steps { done: *done, expected }),
            None => Ok(pack::saved(&self.spec, &Numbers::read(self.spec.double, &bytes[0]), &marks)),
        }
    }
}

//! The GPU engine: one thread of a compute shader takes one instance through the run.

mod adapter;
mod chunk;
mod pace;
mod pack;
mod session;
mod strict;

pub use adapter::{AdapterReport, adapters};
pub use chunk::Job;

use super::cpu::{self, Resume};
use super::measure::{Sums, finish};
use super::member::member;
use super::saved::Saved;
use super::{Ended, Engine, EngineError, Outcome, Progress, station};
use crate::kernel::Rounding;
use crate::plan::{Class, Plan, Precision};
use chunk::{Checkpoint, Chunk};
use pace::Pace;
use rayon::prelude::*;
use session::Session;
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;
use thiserror::Error;

/// Why no GPU can run the plan.
#[derive(Debug, Error)]
pub enum GpuError {
    #[error(
        "no GPU adapter found: install the GPU's Vulkan driver, or a software one (Debian and Ubuntu: apt install mesa-vulkan-drivers), or use --backend cpu"
    )]
    NoAdapter,
    #[error("no GPU adapter `{wanted}`; there is: {}", found.join(", "))]
    NoSuchAdapter { wanted: String, found: Vec<String> },
    #[error("{0} cannot compute in f64 in shaders: use --precision f32, or --backend cpu")]
    NoDouble(String),
    #[error("{0} cannot be kept from fusing sums and products: only a Vulkan driver can")]
    NoStrict(String),
    #[error("{adapter} cannot be opened: {why}; use --backend cpu")]
    Device { adapter: String, why: String },
}

/// What can go wrong on a device that was opened.
#[derive(Clone, Debug, Error)]
pub(crate) enum Failure {
    #[error("out of memory")]
    Memory,
    #[error("the device was lost ({0})")]
    Lost(String),
    #[error("the driver refused: {0}")]
    Refused(String),
    #[error("an instance did {done} steps of {expected}")]
    Steps { done: u32, expected: u32 },
}

/// Breaks things on purpose, so that what happens then can be tested.
#[derive(Debug, Default)]
pub struct Drill {
    /// The device is destroyed before this dispatch, counted from 1; each time the count is reached
    /// `times` more dispatches decide anew.
    pub lose_at: Option<u32>,
    /// How often that happens.
    pub times: u32,
    /// Chunks of more instances are refused for want of memory.
    pub memory_for: Option<usize>,
    /// Time between checkpoints in place of some seconds.
    pub save_every: Option<Duration>,
    /// Changes the shader's text before it is compiled.
    pub edit: Option<fn(String) -> String>,
    dispatches: AtomicU32,
    lost: AtomicU32,
}

impl Drill {
    fn strike(&self, session: &Session) {
        let Some(at) = self.lose_at else { return };
        let number = self.dispatches.fetch_add(1, Ordering::Relaxed) + 1;
        if number.is_multiple_of(at) && self.lost.fetch_add(1, Ordering::Relaxed) < self.times {
            session.device.destroy();
        }
    }
}

/// A GPU, or a driver that plays one.
pub struct Gpu {
    adapter: wgpu::Adapter,
    report: AdapterReport,
    /// Most instances on the device at a time, below what its memory allows.
    pub chunk: Option<usize>,
    /// Forbids the driver to fuse or reorder sums and products: what it computes is then what the CPU does
    /// with [`Cpu::strict`](crate::engine::Cpu::strict), bit by bit, as far as the device divides and takes roots as IEEE 754 asks. From the start on for
    /// software drivers, to which it costs nothing; only a Vulkan driver can do it.
    pub strict: bool,
    /// For tests of what happens when a device fails.
    pub drill: Drill,
    /// The device and its compiled shaders between two runs, and the precision and strictness it is open for.
    idle: Mutex<Option<(Precision, bool, Session)>>,
}

/// Failures on one chunk after which the CPU takes over.
const TRIES: u32 = 3;

impl Gpu {
    /// The adapter asked for by index or part of its name; else the best there is.
    pub fn new(wanted: Option<&str>) -> Result<Self, GpuError> {
        let (adapter, report) = adapter::choose(wanted)?;
        let strict = report.strict && report.software();
        let (drill, idle) = (Drill::default(), Mutex::default());
        Ok(Self { adapter, report, chunk: None, strict, drill, idle })
    }

    /// What it can do.
    pub fn report(&self) -> &AdapterReport {
        &self.report
    }

    /// Most instances of the class that the device takes at a time.
    fn capacity(&self, plan: &Plan, class: &Class) -> usize {
        let spec = pack::spec(plan, class);
        let each = spec.bytes() * spec.state_fields().len().max(spec.case_fields().len()) as u64;
        let most = self.report.binding_bytes.min(self.report.buffer_bytes) / each;
        // Threads are numbered with 32 bits, workgroups up to the device's limit in two dimensions.
        let most = most.min(1 << 24) as usize;
        self.chunk.map_or(most, |chunk| chunk.min(most)).max(1)
    }

    fn class(
        &self,
        plan: &Plan,
        class: &Class,
        opened: &mut Opened,
        progress: &Progress,
    ) -> Result<Vec<Ended>, EngineError> {
        let chunks: Vec<&[u32]> = class.instances.chunks(self.capacity(plan, class)).collect();
        let mut out = Vec::with_capacity(class.instances.len());
        let begin =
            |instances: &[u32]| station::begin(plan, instances).map(|saved| Checkpoint { saved, done: 0 });
        let tables = |instances: &[u32]| {
            let at = begin(instances);
            let tables = pack::tables(plan, class, instances, at.as_ref().map(|at| at.saved.as_slice()));
            (tables, at)
        };
        let mut next = chunks.first().map(|first| tables(first));
        for number in 0..chunks.len() {
            let Some((packed, at)) = next.take() else { break };
            // The next chunk's tables are made while this one runs.
            let (finished, made) = std::thread::scope(|scope| {
                let tables = &tables;
                let after = chunks.get(number + 1).map(|after| scope.spawn(move || tables(after)));
                let finished = self.chunk(plan, class, packed, at, opened, progress);
                (finished, after.and_then(|made| made.join().ok()))
            });
            out.extend(finished?);
            next = made;
        }
        Ok(out)
    }

    /// One chunk, whatever happens: on the device, with half as many instances, on the CPU.
    fn chunk(
        &self,
        plan: &Plan,
        class: &Class,
        mut tables: pack::Tables,
        mut checkpoint: Option<Checkpoint>,
        opened: &mut Opened,
        progress: &Progress,
    ) -> Result<Vec<Ended>, EngineError> {
        for _ in 0..TRIES {
            let done = checkpoint.as_ref().map_or(0, |at| at.done);
            opened.open(self, plan.precision);
            let Opened { session: Some(session), pace, .. } = opened else { break };
            let run = Chunk::new(plan, class, session, &self.drill, &tables)
                .and_then(|chunk| chunk.run(done, pace, &mut checkpoint, progress));
            let failure = match run {
                Ok(Some(saved)) => return Ok(finish_all(plan, class, &tables.instances, &saved)),
                Ok(None) => return Ok(vec![Ended::NOT_RUN; tables.instances.len()]),
                Err(failure) => session.cause(failure),
            };
            opened.session = None;
            opened.pace.slow_down();
            let saved = checkpoint.as_ref().map(|at| at.saved.as_slice());
            let count = tables.instances.len();
            if matches!(failure, Failure::Memory) && count > 1 {
                opened.notes.push(format!("{failure} with {count} instances: going on with half of them"));
                let mut out = Vec::with_capacity(count);
                for half in [0..count / 2, count / 2..count] {
                    let at = checkpoint.as_ref().map(|at| at.part(half.clone()));
                    let saved = at.as_ref().map(|at| at.saved.as_slice());
                    let tables = pack::tables(plan, class, &tables.instances[half], saved);
                    out.extend(self.chunk(plan, class, tables, at, opened, progress)?);
                }
                return Ok(out);
            }
            let from = checkpoint.as_ref().map_or(0, |at| at.done);
            opened.notes.push(format!("{failure}: going on from period {from} with a new device"));
            tables = pack::tables(plan, class, &tables.instances, saved);
        }
        let from = checkpoint.as_ref().map_or(0, |at| at.done);
        opened.notes.push(format!("going on from period {from} on the CPU"));
        let rest = Class { instances: tables.instances, ..class.clone() };
        let resume = checkpoint.as_ref().map(|at| Resume::Saved(&at.saved, at.done));
        cpu::resume(plan, &rest, resume, Rounding::new(self.strict), progress)
    }
}

fn finish_all(plan: &Plan, class: &Class, instances: &[u32], saved: &[Saved]) -> Vec<Ended> {
    let tell = plan.starts.is_some();
    instances
        .par_iter()
        .zip(saved)
        .map(|(instance, saved)| {
            let (case, driven) = member(plan, *instance);
            let sums = Sums::new(saved.run_sums, saved.finite, plan.run.measure, class.steps);
            Ended {
                finished: finish(&sums, &case, driven, &plan.run, plan.wants),
                end: tell.then(|| Box::new(station::station(saved))),
            }
        })
        .collect()
}

/// The device while it holds, and what there is to tell.
struct Opened {
    session: Option<Session>,
    pace: Pace,
    notes: Vec<String>,
}

impl Opened {
    /// Opens a device if none is open.
    fn open(&mut self, gpu: &Gpu, precision: Precision) {
        if self.session.is_none() {
            match Session::open(gpu, precision == Precision::F64) {
                Ok(session) => self.session = Some(session),
                Err(error) => self.notes.push(error.to_string()),
            }
        }
    }
}

impl Engine for Gpu {
    fn device(&self) -> String {
        self.report.title()
    }

    fn kind(&self) -> String {
        // What it hands back to the processor, and searches in f64 where it has none, counts too.
        format!("gpu {} beside {}", self.device(), cpu::Cpu::default().kind())
    }

    fn double(&self) -> bool {
        self.report.double
    }

    fn run(&self, plan: &Plan, progress: &Progress) -> Result<Outcome, EngineError> {
        // A device that cannot be opened at all is an error, before anything is computed.
        let mut idle = self.idle.lock().unwrap_or_else(PoisonError::into_inner);
        let held = idle.take().filter(|held| (held.0, held.1) == (plan.precision, self.strict));
        let session = match held {
            Some((.., session)) => session,
            None => Session::open(self, plan.precision == Precision::F64)?,
        };
        let pace = Pace::new(self.report.software());
        let mut opened = Opened { session: Some(session), pace, notes: Vec::new() };
        let mut outcome = Outcome::of(plan);
        for class in &plan.classes() {
            let finished = match class.steps {
                0 => cpu::free_class(plan, class),
                _ if progress.stopped() => continue,
                _ => self.class(plan, class, &mut opened, progress)?,
            };
            outcome.put(&class.instances, finished);
        }
        *idle = opened.session.map(|session| (plan.precision, self.strict, session));
        outcome.notes = opened.notes;
        Ok(outcome)
    }
}

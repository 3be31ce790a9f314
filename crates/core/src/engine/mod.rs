//! Engines, which step plans, behind one small trait.

mod batch;
mod batch_map;
mod broyden_search;
mod checkpoint;
mod cpu;
#[cfg(feature = "gpu")]
pub mod gpu;
#[cfg(test)]
mod instructions_agree;
mod kernel_constants;
mod kernel_dispatch;
mod measurement;
mod newton_search;
mod period_jacobian;
mod profile;
mod progress;
mod reference;
mod result_columns;
mod return_map;
mod section_state;
mod start;
mod threads;
mod time_estimate;
mod trace;

pub use broyden_search::{Correction, Corrections, INSTANCES_PER_BATCH, Prediction, Predictions};
pub use cpu::{Cpu, processor};
pub(crate) use measurement::lag;
pub use newton_search::{NewtonResult, NewtonResults, NewtonStart, NewtonStarts};
pub use period_jacobian::{PeriodJacobian, PeriodJacobians};
pub use profile::ProfileSection;
pub use progress::{HeldPhase, Progress, ProgressPhase};
pub use reference::{Model, Reference, TOLERANCE, Work, solve, solve_near};
pub use result_columns::{ResultColumns, WantedColumns};
pub use return_map::{JacobianStart, ReturnMap};
pub use threads::{on_threads, while_watched};
pub use time_estimate::estimate;
pub use trace::{Between, Trace, TraceSample, trace};

use crate::observe::{Measured, Status};
use crate::plan::{Plan, SectionState};
use thiserror::Error;

/// The engine if it can compute in f64, or else the processor.
pub(crate) fn in_double(engine: &dyn Engine) -> &dyn Engine {
    if engine.double() { engine } else { &Cpu { strict: false } }
}

/// Steps every instance of a plan.
pub trait Engine: Send + Sync {
    /// Name of the device, for the results file.
    fn device(&self) -> String;

    /// What the last bits of results depend on: two engines of one kind give the same.
    fn kind(&self) -> String {
        self.device()
    }

    /// Whether it can compute in f64.
    fn double(&self) -> bool {
        true
    }

    /// Whether it can start at a plan's starts.
    fn resumes(&self) -> bool {
        true
    }

    /// Chunk size in a run of very many instances, and number of chunks in flight: large enough to fill the device, small
    /// enough for memory.
    fn portions(&self) -> (usize, usize) {
        (1 << 17, 1)
    }

    /// Whether many small runs side by side are as good as a large one: the engine has no threads but its callers'.
    fn by_threads(&self) -> bool {
        false
    }

    /// Devices of one kind, one of which a small run keeps busy.
    fn devices(&self) -> usize {
        1
    }

    /// The share of each device in the work so far, in words; `None` for a single device.
    fn dealt(&self) -> Option<String> {
        None
    }

    /// The return map of these instances, for repeated use; `None` if the engine has no faster way than to run a plan each
    /// time.
    ///
    /// # Errors
    /// Returns the engine's error.
    fn return_map(
        &self,
        _plan: &Plan,
        _instances: &[u32],
    ) -> Result<Option<Box<dyn ReturnMap>>, EngineError> {
        Ok(None)
    }

    /// Whether it computes Jacobians of periods, [`Engine::slopes`].
    fn tells_slopes(&self) -> bool {
        false
    }

    /// Steps one period of each instance of a plan, in steady free motion from the plan's starts, and computes its Jacobian.
    /// It may drop terms of about the size `least`, by instance. An engine that leaves Jacobians to differences returns none.
    ///
    /// # Errors
    /// Returns the engine's error.
    fn slopes(
        &self,
        plan: &Plan,
        _least: &[f64],
        _progress: &Progress,
    ) -> Result<PeriodJacobians, EngineError> {
        Ok(PeriodJacobians::none(plan, None))
    }

    /// Searches for periodic states from these predictions by Broyden's method, in f64: one measured period after another,
    /// [`ROUNDS`](crate::kernel::broyden::ROUNDS) at most, with the plan's steps and in steady free motion. An engine without
    /// its own implementation leaves this to the CPU.
    ///
    /// # Errors
    /// Returns the engine's error.
    fn broyden(
        &self,
        plan: &Plan,
        guesses: &mut Predictions,
        progress: &Progress,
    ) -> Result<Corrections, EngineError> {
        Cpu::default().broyden(plan, guesses, progress)
    }

    /// Whether it runs whole searches itself, [`Engine::newton`].
    fn searches(&self) -> bool {
        false
    }

    /// Searches for the state of each instance of the plan by Newton's method, in the plan's precision and from its starts:
    /// one period with its Jacobian after another, [`ROUNDS`](crate::kernel::newton::ROUNDS) at most. An engine that leaves
    /// the rounds to its callers searches for none.
    ///
    /// # Errors
    /// Returns the engine's error.
    fn newton(
        &self,
        plan: &Plan,
        _seeks: &NewtonStarts,
        _progress: &Progress,
    ) -> Result<NewtonResults, EngineError> {
        Ok(NewtonResults::none(plan, NewtonResult::NOT_RUN))
    }

    /// Runs the plan. A failed instance is data, not an error.
    fn run(&self, plan: &Plan, progress: &Progress) -> Result<Outcome, EngineError>;
}

/// Why nothing could be run.
#[derive(Debug, Error)]
pub enum EngineError {
    #[error(
        "the plan keeps {modes} modes for an instance and this engine steps at most {most}: set [run] modes"
    )]
    TooManyModes { modes: usize, most: usize },
    #[error("the plan keeps no mode for an instance: the tip force does not move this tip")]
    NoModes,
    /// The system does not provide them.
    #[error("{threads} threads could not be started: {why}")]
    Threads { threads: usize, why: String },
    #[cfg(feature = "gpu")]
    #[error(transparent)]
    Gpu(#[from] gpu::GpuError),
    #[error("the reference engine's tolerance is {0:e}: give one from 1e-14 to 1e-3")]
    Tolerance(f64),
    #[error("the reference engine starts where the scene says, not where it is told to")]
    Starts,
    #[error("no instance {instance}: the plan has {count}, numbered from 0")]
    NoInstance { instance: usize, count: usize },
    /// The record of a chunk.
    #[error("the journal's record of a chunk cannot be read: {why}")]
    Unread { why: String },
}

/// Values of some instances, in order.
#[derive(Clone, Debug)]
pub struct Noted<T> {
    pub all: Vec<T>,
    /// Messages for the user, one line each.
    pub notes: Vec<String>,
}

impl<T: Clone> Noted<T> {
    /// Before any run: `none` for each instance of the plan.
    pub fn none(plan: &Plan, none: T) -> Self {
        Self { all: vec![none; plan.len()], notes: Vec::new() }
    }

    /// Stores the values of these instances.
    fn put(&mut self, instances: &[u32], told: Vec<T>) {
        instances.iter().zip(told).for_each(|(instance, one)| self.all[*instance as usize] = one);
    }
}

/// The results of a run, by instance.
#[derive(Clone, Debug)]
pub struct Outcome {
    pub results: Vec<Finished>,
    /// The end state of each if the plan sets the starts; `None` where nothing was stepped.
    pub ends: Vec<Option<Box<SectionState>>>,
    /// Messages for the user, one line each.
    pub notes: Vec<String>,
}

impl Outcome {
    /// Before anything has run.
    pub fn of(plan: &Plan) -> Self {
        let count = plan.len();
        let ends = if plan.starts.is_some() { vec![None; count] } else { Vec::new() };
        Self { results: vec![Finished::NOT_RUN; count], ends, notes: Vec::new() }
    }

    /// Stores the results of these instances.
    fn put(&mut self, instances: &[u32], ended: Vec<Ended>) {
        for (instance, one) in instances.iter().zip(ended) {
            self.results[*instance as usize] = one.finished;
            if let Some(place) = self.ends.get_mut(*instance as usize) {
                *place = one.end;
            }
        }
    }
}

/// One instance at the end of a run.
#[derive(Clone, Debug)]
struct Ended {
    finished: Finished,
    end: Option<Box<SectionState>>,
}

impl Ended {
    const NOT_RUN: Self = Self { finished: Finished::NOT_RUN, end: None };
}

impl From<Finished> for Ended {
    fn from(finished: Finished) -> Self {
        Self { finished, end: None }
    }
}

/// One instance, measured.
#[derive(Clone, Copy, Debug)]
pub struct Finished {
    pub measured: Measured,
    pub status: Status,
}

impl Finished {
    /// An instance that was not computed.
    pub const NOT_RUN: Self = Self { measured: Measured::NONE, status: Status::NotRun };
}

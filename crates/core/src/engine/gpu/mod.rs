//! The GPU engine: one thread of a compute shader takes one instance through the run, on one device or on several.

mod adapter;
mod capacity;
mod chunk;
mod deal;
mod dealer;
mod device;
mod errand;
mod newton;
mod pace;
mod pack;
mod piece;
mod piece_buffers;
mod rounds;
mod runs;
mod session;
mod slopes;
mod strict;
mod stride_tables;
mod strides;

pub use adapter::{AdapterReport, adapters, alike};
pub use session::Job;
pub use strict::spirv;

use super::cpu;
use super::{
    Correction, Corrections, Engine, EngineError, NewtonResult, NewtonResults, NewtonStarts, Outcome,
    PeriodJacobians, Predictions, Progress,
};
use crate::plan::{Class, Plan, Precision};
use deal::Deal;
use dealer::Dealer;
use device::Device;
use newton::Walks;
use piece::{Cut, Piece};
use runs::Runs;
use session::Session;
use slopes::Periods;
use std::collections::VecDeque;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Duration;
use strides::{Strides, Ways};
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
    #[error(
        "`{wanted}` names the GPU adapter {adapter} twice: name each once, by its index as `afmsweep devices` lists them"
    )]
    Twice { wanted: String, adapter: String },
    #[error(
        "the GPU adapters of `{wanted}` are of different kinds ({}); an instance's last bits would then depend on the adapter that ran it: name adapters of one kind{}",
        kinds.join("; "), advice(of_one_kind)
    )]
    Kinds { wanted: String, kinds: Vec<String>, of_one_kind: Vec<usize> },
    #[error("{0} cannot compute in f64 in shaders: use --precision f32, or --backend cpu")]
    NoDouble(String),
    #[error("{0} cannot be kept from fusing sums and products: only a Vulkan driver can")]
    NoStrict(String),
    #[error("{adapter} cannot be opened: {why}; use --backend cpu")]
    Device { adapter: String, why: String },
}

/// `, as 0,1`; empty if no two are of one kind.
fn advice(of_one_kind: &[usize]) -> String {
    let indices: Vec<String> = of_one_kind.iter().map(ToString::to_string).collect();
    if indices.is_empty() { String::new() } else { format!(", as --device {}", indices.join(",")) }
}

/// Failures of a device that was opened.
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

/// Injects faults, to test how the engine handles them.
#[derive(Debug, Default)]
pub struct Drill {
    /// Destroys the device before each dispatch whose number, from 1, is a multiple of this.
    pub lose_at: Option<u32>,
    /// Most times that this happens.
    pub times: u32,
    /// Restricts this to the device of this index in the engine.
    pub only: Option<usize>,
    /// Once lost, a device cannot be opened again.
    pub for_good: bool,
    /// Chunks of more instances are refused for lack of memory.
    pub memory_for: Option<usize>,
    /// Time between checkpoints, instead of some seconds.
    pub save_every: Option<Duration>,
    /// Changes the shader's text before it is compiled.
    pub edit: Option<fn(String) -> String>,
    dispatches: AtomicU32,
    lost: AtomicU32,
}

impl Drill {
    fn concerns(&self, place: usize) -> bool {
        self.only.is_none_or(|only| only == place)
    }

    fn strike(&self, session: &Session) {
        let Some(at) = self.lose_at.filter(|_| self.concerns(session.place)) else { return };
        let number = self.dispatches.fetch_add(1, Ordering::Relaxed) + 1;
        if number.is_multiple_of(at) && self.lost.fetch_add(1, Ordering::Relaxed) < self.times {
            session.device.destroy();
        }
    }

    /// Whether a device must not be opened any more.
    fn keeps_shut(&self, place: usize) -> bool {
        self.for_good && self.concerns(place) && self.lost.load(Ordering::Relaxed) > 0
    }
}

/// GPUs of one kind, or a driver that emulates one. Several share each run by their past speed, and each free one takes the
/// next piece. Results do not depend on which device took a piece.
pub struct Gpu {
    devices: Vec<Device>,
    dealer: Dealer,
    report: AdapterReport,
    /// Most instances on a device at a time, if below what its memory allows.
    pub chunk: Option<usize>,
    /// Fewest instances of a class that justify another device.
    pub least: usize,
    /// Forbids the driver to fuse or reorder sums and products. The results are then those of the CPU with
    /// [`Cpu::strict`](crate::engine::Cpu::strict), bit by bit, if the device divides and takes roots as IEEE 754 asks. It is
    /// on from the start for software drivers, where it costs nothing; only a Vulkan driver can do it.
    pub strict: bool,
    /// For tests of how failures of a device are handled.
    pub drill: Drill,
}

/// 16 workgroups: fewer leave most processors of a GPU without work as it is. Not measured on one.
const LEAST: usize = 1024;

impl Gpu {
    /// The requested adapters, by index or part of a name, several separated by commas, or `all` of the best one's kind;
    /// without a request the best one.
    ///
    /// # Errors
    /// There is no such adapter, or several are not of one kind.
    pub fn new(wanted: Option<&str>) -> Result<Self, GpuError> {
        let (first, others) = adapter::choose(wanted)?;
        let report = first.1.clone();
        let strict = report.strict && report.software();
        let all = std::iter::once(first).chain(others);
        let devices: Vec<Device> = all.enumerate().map(|(place, one)| Device::new(place, one)).collect();
        let (dealer, drill) = (Dealer::new(devices.len()), Drill::default());
        Ok(Self { devices, dealer, report, chunk: None, least: LEAST, strict, drill })
    }

    /// Capabilities of each of its devices, which are of one kind.
    pub fn report(&self) -> &AdapterReport {
        &self.report
    }

    /// Capabilities of its devices one by one.
    pub fn reports(&self) -> impl Iterator<Item = &AdapterReport> {
        self.devices.iter().map(|one| &one.report)
    }

    /// Instance-steps of each device.
    pub fn taken(&self) -> Vec<u64> {
        self.dealer.taken()
    }

    /// Sets the relative speeds of the devices that are assumed until they have shown theirs.
    pub fn suppose(&self, speeds: &[f64]) {
        self.dealer.suppose(speeds);
    }

    /// The plan's classes in pieces, and those that never reach the sample.
    fn pieces(&self, plan: &Plan, most: impl Fn(&Class) -> usize) -> (Vec<Class>, VecDeque<Piece>) {
        let devices = self.dealer.speeds();
        let cut = Cut { devices: &devices, least: self.least, software: self.report.software() };
        let (free, stepped): (Vec<Class>, Vec<Class>) =
            plan.classes().into_iter().partition(|class| class.steps == 0);
        let all = stepped.iter().enumerate();
        let mut pieces: Vec<Piece> =
            all.flat_map(|(group, class)| cut.pieces(plan, (group, class), most(class))).collect();
        if self.devices.len() > 1 {
            // The largest first, so that no large piece remains for the end.
            pieces.sort_by_key(|piece| std::cmp::Reverse(piece.work(plan)));
        }
        (free, pieces.into())
    }

    /// Opens devices that were never opened. It is an error before any computation if none can be opened; later runs continue
    /// on the CPU.
    fn open(&self, precision: Precision) -> Result<Vec<String>, EngineError> {
        if precision == Precision::F64 && !self.report.double {
            return Err(GpuError::NoDouble(self.report.name.clone()).into());
        }
        self.dealer.begin_anew();
        let (mut notes, mut why) = (Vec::new(), None);
        for place in self.dealer.untried() {
            match self.devices.get(place).map(|device| device.open(self.strict, &self.drill)) {
                Some(Err(error)) => {
                    self.dealer.lost(place);
                    notes.push(self.without(place, &error));
                    why = Some(error);
                }
                _ => self.dealer.give_back(place),
            }
        }
        match why {
            Some(error) if self.dealer.holding() == 0 => Err(error.into()),
            _ => Ok(notes),
        }
    }

    /// A message on a device that is left out.
    fn without(&self, place: usize, error: &GpuError) -> String {
        let why = match error {
            GpuError::Device { why, .. } => format!("the device cannot be opened ({why})"),
            other => other.to_string(),
        };
        format!("{}{why}: going on without it", self.who(place))
    }

    /// `adapter 1: `, or nothing for a single device.
    fn who(&self, place: usize) -> String {
        match self.devices.get(place).filter(|_| self.devices.len() > 1) {
            Some(device) => format!("adapter {}: ", device.report.index),
            None => String::new(),
        }
    }
}

/// `0, 1 and 2`.
fn listed(words: &[String]) -> String {
    match words {
        [most @ .., last] if !most.is_empty() => format!("{} and {last}", most.join(", ")),
        _ => words.concat(),
    }
}

impl Engine for Gpu {
    fn device(&self) -> String {
        match self.devices.len() {
            1 => self.report.title(),
            count => {
                let indices: Vec<String> = self.reports().map(|one| one.index.to_string()).collect();
                format!("{count} devices of one kind, {}, adapters {}", self.report.title(), listed(&indices))
            }
        }
    }

    fn kind(&self) -> String {
        // The CPU counts: it does failed work, and f64 searches if the device has no f64. The number of devices does not.
        format!("gpu {} beside {}", self.report.title(), cpu::Cpu::default().kind())
    }

    fn tells_slopes(&self) -> bool {
        true
    }

    fn slopes(
        &self,
        plan: &Plan,
        least: &[f64],
        progress: &Progress,
    ) -> Result<PeriodJacobians, EngineError> {
        let mut slopes = PeriodJacobians::none(plan, None);
        slopes.notes = self.open(plan.precision)?;
        let _entered = self.dealer.enter();
        let (_, pieces) = self.pieces(plan, |class| self.slope_capacity(plan, class));
        let errand = Periods { plan, least, binding: self.binding() };
        let notes = Deal::new(self, &errand, progress).all(pieces, &mut slopes)?;
        slopes.notes.extend(notes);
        Ok(slopes)
    }

    fn broyden(
        &self,
        plan: &Plan,
        guesses: &mut Predictions,
        progress: &Progress,
    ) -> Result<Corrections, EngineError> {
        let mut notes = self.open(Precision::F64)?;
        let _entered = self.dealer.enter();
        let instances: Vec<u32> = guesses.all.iter().map(|one| one.instance).collect();
        let mut part = plan.part(&instances).in_precision(Precision::F64);
        (part.run.periods, part.run.measure) = (1, 1);
        let (_, pieces) = self.pieces(&part, |class| self.stride_capacity(&part, class));
        let arrived = vec![Correction::NOT_RUN; instances.len()];
        let mut ways = Ways { arrived, places: guesses.places.clone(), undoes: guesses.undoes.clone() };
        let errand = Strides { plan: &part, guesses };
        notes.extend(Deal::new(self, &errand, progress).all(pieces, &mut ways)?);
        (guesses.places, guesses.undoes) = (ways.places, ways.undoes);
        Ok(Corrections { all: ways.arrived, notes })
    }

    fn searches(&self) -> bool {
        true
    }

    fn newton(
        &self,
        plan: &Plan,
        seeks: &NewtonStarts,
        progress: &Progress,
    ) -> Result<NewtonResults, EngineError> {
        let mut searches = NewtonResults::none(plan, NewtonResult::NOT_RUN);
        searches.notes = self.open(plan.precision)?;
        let _entered = self.dealer.enter();
        let least = seeks.all.iter().map(|one| one.least).collect();
        let errand = Walks { plan, seeks, least, binding: self.binding() };
        let (_, pieces) = self.pieces(plan, |class| self.walk_capacity(plan, class));
        let notes = Deal::new(self, &errand, progress).all(pieces, &mut searches.all)?;
        searches.notes.extend(notes);
        Ok(searches)
    }

    fn double(&self) -> bool {
        self.report.double
    }

    /// Chunks on devices hide what the others do on the processor.
    fn portions(&self) -> (usize, usize) {
        (1 << 17, if self.devices.len() > 1 { 2 * self.devices.len() } else { 1 })
    }

    fn devices(&self) -> usize {
        self.devices.len()
    }

    fn dealt(&self) -> Option<String> {
        let taken = self.taken();
        let all = taken.iter().sum::<u64>() as f64;
        let one = |(report, steps): (&AdapterReport, &u64)| {
            format!("adapter {} {:.0} %", report.index, 100.0 * *steps as f64 / all)
        };
        let words: Vec<String> = self.reports().zip(&taken).map(one).collect();
        (words.len() > 1 && all > 0.0).then(|| format!("instance-steps on the GPUs: {}", listed(&words)))
    }

    fn run(&self, plan: &Plan, progress: &Progress) -> Result<Outcome, EngineError> {
        let mut outcome = Outcome::of(plan);
        outcome.notes = self.open(plan.precision)?;
        let _entered = self.dealer.enter();
        let (free, pieces) = self.pieces(plan, |class| self.capacity(plan, class));
        free.iter().for_each(|class| outcome.put(&class.instances, cpu::free_class(plan, class)));
        let notes = Deal::new(self, &Runs(plan), progress).all(pieces, &mut outcome)?;
        outcome.notes.extend(notes);
        Ok(outcome)
    }
}

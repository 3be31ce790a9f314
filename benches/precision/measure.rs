//! Every solver in this program on a problem, timed and held against the truth.

use crate::answer::{Answer, Errors};
use crate::problem::Problem;
use crate::rk4;
use afmsweep::engine::gpu::Gpu;
use afmsweep::engine::{Cpu, Engine, Progress};
use afmsweep::observe::Measured;
use afmsweep::plan::Precision;
use cpu_time::ProcessTime;
use serde::Serialize;
use std::time::Instant;

/// Steps per period of this crate's engines.
const STEPS: [u32; 9] = [16, 24, 32, 64, 128, 256, 512, 1024, 2048];
/// Those of the Runge-Kutta method, which is not stable below about 40 and needs more than the engines.
const RK4_STEPS: [u32; 9] = [48, 64, 128, 256, 512, 1024, 2048, 4096, 8192];
/// Longest step that the adaptive solvers may take, rad: the deviation from free motion is zero until the first
/// contact, and nothing but this keeps a step from passing over it.
pub const LONGEST: f64 = 0.25;
/// Tolerances, relative and absolute, of the adaptive solvers.
#[cfg(feature = "peers")]
const TOLERANCES: [f64; 7] = [1e-3, 1e-4, 1e-5, 1e-6, 1e-8, 1e-10, 1e-12];
/// Shortest time that is measured, s.
const SHORTEST: f64 = 0.1;
/// s
const PATIENCE: f64 = 2.0;

/// A solver at one setting.
#[derive(Clone, Debug, Serialize)]
pub struct Point {
    pub law: String,
    pub solver: String,
    pub setting: String,
    /// Steps per period, the mean over the ensemble; none where the solver does not tell.
    pub steps: Option<f64>,
    /// s per instance for the whole run.
    pub seconds: f64,
    /// `cpu`: of all threads together, which on a device that is no processor would say nothing: `wall`.
    pub clock: &'static str,
    pub instances: usize,
    /// Instances that the solver gave up.
    pub failed: usize,
    pub errors: Errors,
}

type Results = (Vec<(usize, Measured)>, Option<f64>);

/// A solver at one setting that waits for its turn.
struct Entry<'a> {
    solver: String,
    setting: String,
    clock: &'static str,
    instances: usize,
    warm: Option<Box<dyn Fn() + 'a>>,
    run: Box<dyn Fn() -> Results + 'a>,
    seconds: f64,
    results: Option<Results>,
}

/// The devices that take part, and what is to be said of those that do not.
pub struct Devices {
    pub gpu: Option<Gpu>,
    pub notes: Vec<String>,
}

impl Devices {
    pub fn find() -> Self {
        match Gpu::new(None) {
            Ok(gpu) => Self { gpu: Some(gpu), notes: Vec::new() },
            Err(error) => Self { gpu: None, notes: vec![format!("gpu f32, gpu f64: not run. {error}")] },
        }
    }
}

/// All solvers of this program on a problem. In each of `repeats` rounds every setting has its turn; the fastest run of
/// each counts, and one that takes longer than [`PATIENCE`] has one turn.
pub fn measure(problem: &Problem, devices: &mut Devices, repeats: u32) -> Vec<Point> {
    let mut notes = Vec::new();
    let mut entries = engines(problem, devices, &mut notes);
    entries.extend(by_hand(problem));
    #[cfg(feature = "peers")]
    entries.extend(libraries(problem));
    for round in 0..repeats {
        for entry in &mut entries {
            if round > 0 && entry.seconds > PATIENCE {
                continue;
            }
            // A device keeps the programs of the last precision only: they are compiled before the clock runs.
            if let Some(warm) = &entry.warm {
                warm();
            }
            let (seconds, results) = timed(entry.clock, || (entry.run)());
            if round == 0 {
                eprintln!("{} {} {}: {seconds:.3} s", problem.name, entry.solver, entry.setting);
            }
            entry.seconds = entry.seconds.min(seconds);
            entry.results = Some(results);
        }
    }
    let points = entries.into_iter().map(|entry| point(problem, entry)).collect();
    devices.notes.extend(notes);
    points
}

/// Seconds that `work` takes by that clock, and what it says. What is short is done again and again: a process's CPU time
/// is told in coarse steps.
pub fn timed<T>(clock: &str, work: impl Fn() -> T) -> (f64, T) {
    let (cpu, wall) = (ProcessTime::now(), Instant::now());
    let mut count = 0;
    loop {
        let said = work();
        count += 1;
        if wall.elapsed().as_secs_f64() > SHORTEST {
            let seconds = match clock {
                "cpu" => cpu.elapsed().as_secs_f64(),
                _ => wall.elapsed().as_secs_f64(),
            };
            return (seconds / f64::from(count), said);
        }
    }
}

fn point(problem: &Problem, entry: Entry) -> Point {
    let (results, steps) = entry.results.unwrap_or_default();
    Point {
        law: problem.name.to_owned(),
        solver: entry.solver,
        setting: entry.setting,
        steps,
        seconds: entry.seconds / entry.instances as f64,
        clock: entry.clock,
        instances: entry.instances,
        failed: entry.instances - results.len(),
        errors: problem.errors(results.into_iter()),
    }
}

/// This crate's engines.
fn engines<'a>(problem: &'a Problem, devices: &'a Devices, notes: &mut Vec<String>) -> Vec<Entry<'a>> {
    static CPU: Cpu = Cpu { strict: false };
    let mut machines: Vec<(&str, Precision, &dyn Engine)> =
        vec![("cpu f32", Precision::F32, &CPU), ("cpu f64", Precision::F64, &CPU)];
    if let Some(gpu) = &devices.gpu {
        machines.extend([("gpu f32", Precision::F32, gpu as &dyn Engine), ("gpu f64", Precision::F64, gpu)]);
    }
    let all: Vec<u32> = (0..problem.plan.len() as u32).collect();
    let mut entries = Vec::new();
    for (name, precision, engine) in machines {
        // Whether the device can do it at all.
        let trial = problem.plan.part(&all[..1]).with_steps(|_| 32).in_precision(precision);
        if let Err(error) = engine.run(&trial, &Progress::default()) {
            let note = format!("{name}: not run. {error}");
            if !devices.notes.contains(&note) {
                notes.push(note);
            }
            continue;
        }
        // Another kind of device has its own time; a software driver's is the processor's.
        let clock =
            if name.starts_with("cpu") || engine.device().contains("llvmpipe") { "cpu" } else { "wall" };
        for steps in STEPS {
            let plan = problem.plan.part(&all).with_steps(|_| steps).in_precision(precision);
            let run = move || -> Results {
                let outcome = engine.run(&plan, &Progress::default()).expect("the plan can be run");
                let results = outcome.results.iter().enumerate().map(|(i, one)| (i, one.measured)).collect();
                (results, Some(f64::from(steps)))
            };
            let mut entry = entry(name, format!("{steps} steps"), clock, all.len(), run);
            if name.starts_with("gpu") {
                let one = problem.plan.part(&all[..1]).with_steps(|_| steps).in_precision(precision);
                entry.warm = Some(Box::new(move || {
                    engine.run(&one, &Progress::default()).expect("the plan can be run");
                }));
            }
            entries.push(entry);
        }
    }
    entries
}

/// The Runge-Kutta method.
fn by_hand(problem: &Problem) -> Vec<Entry<'_>> {
    let reduced = &problem.reduced;
    let count = reduced.samples.len();
    let entries = RK4_STEPS.iter().map(|&steps| {
        let run = move || {
            let answers = rk4::run(reduced, steps);
            (translated(problem, 0..count, answers.into_iter().map(Some)), Some(f64::from(steps)))
        };
        entry("RK4 by hand", format!("{steps} steps"), "cpu", count, run)
    });
    entries.collect()
}

/// Rust's libraries, on every fourth instance.
#[cfg(feature = "peers")]
fn libraries(problem: &Problem) -> Vec<Entry<'_>> {
    use crate::dopri::{self, Method};
    let reduced = &problem.reduced;
    let some: Vec<usize> = (0..reduced.samples.len()).step_by(4).collect();
    let methods =
        [("ode_solvers dopri5", Some(Method::Dopri5)), ("ode_solvers dop853", Some(Method::Dop853))];
    let mut entries = Vec::new();
    for tolerance in TOLERANCES {
        for (name, method) in methods.into_iter().chain([("diffsol tsit45", None)]) {
            let some = some.clone();
            let count = some.len();
            let run = move || {
                let (answers, steps) = match method {
                    Some(method) => dopri::run(reduced, &some, method, tolerance),
                    None => crate::diffsolve::run(reduced, &some, tolerance),
                };
                (translated(problem, some.iter().copied(), answers), Some(steps))
            };
            entries.push(entry(name, format!("{tolerance:e}"), "cpu", count, run));
        }
    }
    entries
}

/// Answers in the engines' terms; an instance given up has none.
pub fn translated(
    problem: &Problem,
    instances: impl IntoIterator<Item = usize>,
    answers: impl IntoIterator<Item = Option<Answer>>,
) -> Vec<(usize, Measured)> {
    let pairs = instances.into_iter().zip(answers);
    pairs.filter_map(|(i, answer)| Some((i, problem.measured(i, &answer?)))).collect()
}

fn entry<'a>(
    solver: &str,
    setting: String,
    clock: &'static str,
    instances: usize,
    run: impl Fn() -> Results + 'a,
) -> Entry<'a> {
    let solver = solver.to_owned();
    Entry {
        solver,
        setting,
        clock,
        instances,
        warm: None,
        run: Box::new(run),
        seconds: f64::INFINITY,
        results: None,
    }
}

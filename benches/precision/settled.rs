//! The periodic state that tapping settles in: what this crate's search for it costs, and for how many periods everyone
//! else has to wait for it.

use crate::answer::Errors;
use crate::measure::{Point, timed};
use crate::problem::Problem;
use afmsweep::compare::{Scales, worst};
use afmsweep::control::by_reference;
use afmsweep::engine::{Cpu, Engine, Finished, Model, Progress, Reference};
use afmsweep::observe::Status;
use afmsweep::orbit;
use afmsweep::plan::Plan;

/// How the names of the points of searches begin.
pub const NAME: &str = "cpu search";
/// Accuracies asked of the searches: they end where the state is known so well.
const ASKED: [f64; 2] = [1e-3, 1e-6];
/// Steps per period of the searches.
const STEPS: [u32; 8] = [16, 24, 32, 64, 128, 256, 512, 1024];
/// Accuracy to which the truth's states are found.
const FINEST: f64 = 1e-5;
/// Steps per period of those who wait, fine enough to end in the truth's state where there are two.
const WAIT_STEPS: u32 = 512;
/// Periods waited for: what is left after the last number is nothing.
const WAITED: [u32; 12] = [32, 48, 64, 96, 128, 192, 256, 384, 512, 768, 1024, 4096];
/// Difference between the state waited for and the truth up to which they are the same one.
const SAME: f64 = 1e-3;

/// What is known of an ensemble's periodic states.
pub struct Settled {
    pub law: String,
    /// Instances that count: those whose state is known, and is where waiting ends.
    pub counted: usize,
    pub instances: usize,
    /// Periods waited for, and how far from the state that ends in their median is.
    pub waiting: Vec<(u32, f64)>,
    /// Searches, by accuracy asked for and steps.
    pub points: Vec<Point>,
}

impl Settled {
    /// Periods until the median is so near to the state it ends in; between numbers waited for by their logarithm, which
    /// falls evenly.
    pub fn periods(&self, level: f64) -> Option<f64> {
        let (from, to) =
            self.waiting.iter().zip(self.waiting.iter().skip(1)).find(|(_, to)| to.1 <= level)?;
        let share = (from.1 / level).ln() / (from.1 / to.1).ln();
        Some(f64::from(from.0) + share.clamp(0.0, 1.0) * f64::from(to.0 - from.0))
    }
}

/// Finds it out, in CPU-seconds of this program with one thread.
pub fn measure(problem: &Problem, repeats: u32) -> Settled {
    let cpu = Cpu::default();
    let all: Vec<u32> = (0..problem.plan.len() as u32).collect();
    let mut fine = problem.searched.clone();
    fine.run.accuracy = FINEST;
    let reference = Reference { tolerance: 1e-13, model: Model::Kept };
    let mut truth =
        by_reference(&fine, &reference, &Progress::default()).expect("can be run").outcome.results;
    let ends: Vec<Vec<Finished>> =
        WAITED.iter().map(|periods| waited(problem, &all, *periods, &cpu)).collect();
    let end = &ends[ends.len() - 1];
    for (i, one) in truth.iter_mut().enumerate() {
        let same = error(problem, i, &end[i], one) < SAME;
        if !(same && one.status == Status::Ok) {
            one.status = Status::NotSteady;
        }
    }
    let mut usable = end.clone();
    usable.iter_mut().zip(&truth).for_each(|(end, truth)| end.status = truth.status);
    let left = |results: &Vec<Finished>| errors(problem, &usable, results).median;
    let waiting = WAITED.iter().zip(&ends).take(ends.len() - 1).map(|(n, ends)| (*n, left(ends))).collect();
    let mut points = Vec::new();
    for accuracy in ASKED {
        for steps in STEPS {
            let mut plan = problem.searched.part(&all).with_steps(|_| steps);
            plan.run.accuracy = accuracy;
            let mut seconds = f64::INFINITY;
            let mut results = Vec::new();
            for _ in 0..repeats {
                let search =
                    || orbit::solve(&plan, &[], &cpu, &Progress::default()).expect("the plan can be run");
                let (took, settled) = timed("cpu", search);
                seconds = seconds.min(took);
                results = settled.outcome.results;
            }
            points.push(Point {
                law: problem.name.to_owned(),
                solver: format!("{NAME} to {accuracy:.0e}"),
                setting: format!("{steps} steps"),
                steps: Some(f64::from(steps)),
                seconds: seconds / all.len() as f64,
                clock: "cpu",
                instances: all.len(),
                failed: 0,
                errors: errors(problem, &truth, &results),
            });
        }
    }
    let counted = truth.iter().filter(|one| one.status == Status::Ok).count();
    Settled { law: problem.name.to_owned(), counted, instances: all.len(), waiting, points }
}

/// What the stepping makes of the last ten of so many periods.
fn waited(problem: &Problem, all: &[u32], periods: u32, engine: &Cpu) -> Vec<Finished> {
    let mut plan: Plan = problem.plan.part(all).with_steps(|_| WAIT_STEPS);
    plan.run.periods = periods;
    engine.run(&plan, &Progress::default()).expect("the plan can be run").results
}

fn error(problem: &Problem, i: usize, ours: &Finished, truth: &Finished) -> f64 {
    let scales = Scales::of(&problem.plan, i, &truth.measured);
    worst(&problem.plan.observables, &ours.measured, &truth.measured, &scales)
}

fn errors(problem: &Problem, truth: &[Finished], results: &[Finished]) -> Errors {
    problem.errors_from(truth, results.iter().enumerate().map(|(i, one)| (i, one.measured)))
}

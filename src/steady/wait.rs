//! Waiting: until an instance has settled, at most as long as the scene says.

use super::Settled;
use crate::engine::{Engine, EngineError, Finished, Outcome, Progress};
use crate::observe::Status;
use crate::plan::{Plan, Station};
use crate::scene::Start;
use std::f64::consts::TAU;
use std::sync::Arc;

/// Share of the accuracy to which an instance has settled when it waits no longer.
pub const SETTLED: f64 = 0.03;
/// A look is worth its while if so much longer a run is asked for; the next looks are that much later.
const LATER: f64 = 1.5;

/// Runs the plan, of which `stepped` need steps. Where many more periods are asked for than the slowest mode takes
/// to die out, it looks on the way which instances have settled, and leaves them at that.
pub(super) fn run(
    plan: &Plan,
    stepped: &[u32],
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<Settled, EngineError> {
    let looks = if engine.resumes() { looks(plan, stepped) } else { Vec::new() };
    if looks.is_empty() {
        progress.task("stepping", 0);
        progress.foresee(plan.instance_steps());
        let mut periods = vec![0; plan.cases.len()];
        stepped.iter().for_each(|i| periods[*i as usize] = plan.run.periods);
        return Ok(Settled { outcome: engine.run(plan, progress)?, found: Vec::new(), periods });
    }
    let mut periods = vec![0; plan.cases.len()];
    let mut whole: Option<Outcome> = None;
    let mut now = plan.clone();
    let mut stations: Vec<Station> = (0..plan.cases.len() as u32).map(|i| Station::free(plan, i)).collect();
    let mut done = 0;
    let mut left = stepped.to_vec();
    let count = looks.len() + 1;
    for (number, until) in (1..).zip(looks.into_iter().chain([plan.run.periods])) {
        let last = until == plan.run.periods;
        now.run.periods = until - done;
        now.run.accuracy = if last { plan.run.accuracy } else { SETTLED * plan.run.accuracy };
        now.stations = Some(Arc::new(std::mem::take(&mut stations)));
        progress.task(format!("waiting {number}/{count}"), 0);
        progress.foresee(now.instance_steps());
        let mut outcome = engine.run(&now, progress)?;
        let ends = std::mem::take(&mut outcome.ends);
        stations = ends.into_iter().map(|end| end.map_or(Station::FREE, |end| *end)).collect();
        left.iter().for_each(|i| periods[*i as usize] = until);
        left.retain(|i| matches!(outcome.results[*i as usize].status, Status::NotSteady | Status::NotRun));
        match &mut whole {
            None => whole = Some(outcome),
            Some(whole) => {
                for class in &now.classes {
                    for &i in &class.instances {
                        whole.results[i as usize] = outcome.results[i as usize];
                    }
                }
                whole.notes.extend(outcome.notes);
            }
        }
        if progress.stopped() && !last {
            // Who waits is not done.
            if let Some(whole) = &mut whole {
                left.iter().for_each(|i| whole.results[*i as usize] = Finished::NOT_RUN);
            }
        }
        if left.is_empty() || progress.stopped() {
            break;
        }
        now = plan.only(&left);
        done = until;
    }
    let outcome = whole.map_or_else(|| engine.run(plan, progress), Ok)?;
    Ok(Settled { outcome, found: Vec::new(), periods })
}

/// Numbers of periods after which to look, all below the scene's.
fn looks(plan: &Plan, stepped: &[u32]) -> Vec<u32> {
    if plan.run.start == Start::Rest || stepped.is_empty() {
        return Vec::new();
    }
    let settling = |i: &u32| {
        let case = &plan.cases[*i as usize];
        let driven = &plan.drives[case.drive as usize];
        let rate = |damping: f64, omega: f64| TAU * damping * omega / driven.free.omega;
        let slowest = driven.kept.modes.iter().map(|mode| rate(mode.damping, mode.omega));
        let slowest = slowest.fold(f64::INFINITY, f64::min);
        // The change into a period has to fall to this share of the free amplitude.
        let change = SETTLED * plan.run.accuracy * slowest.min(1.0);
        -change.ln() / slowest
    };
    let longest = stepped.iter().map(settling).fold(0.0, f64::max) + f64::from(plan.run.measure);
    let mut looks = Vec::new();
    let mut at = longest.max(4.0 * f64::from(plan.run.measure)).max(8.0);
    while at * LATER < f64::from(plan.run.periods) {
        looks.push(at as u32);
        at *= LATER;
    }
    looks
}

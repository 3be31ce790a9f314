//! Integration to steady state: until an instance has settled, at most as long as the scene says.

use super::OrbitSolution;
use super::residual::{force_share, measure_period};
use super::verification::SHALLOW_AMPLITUDES;
use crate::compare::{Scales, worst};
use crate::engine::{Engine, EngineError, Finished, Outcome, Progress};
use crate::observe::{Observable, Status};
use crate::plan::{Plan, SectionState, StartState};
use crate::scene::Start;
use std::f64::consts::TAU;

/// An instance that has settled to this share of the accuracy stops early.
pub const SETTLED_SHARE: f64 = 0.03;
/// Forces that depend on the motion more strongly than this, as a share of the accuracy, need the full run.
const MAX_FORCE_SHARE: f64 = 1.0;
/// A checkpoint pays if the run is at least this factor longer; later checkpoints are spaced by the same factor.
const CHECKPOINT_GROWTH: f64 = 1.5;

/// Runs the plan. If it asks for many more periods than the slowest mode takes to decay, instances that have settled stop at
/// checkpoints.
pub(super) fn integrate(
    plan: &Plan,
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<OrbitSolution, EngineError> {
    let looks = if engine.resumes() { checkpoints(plan) } else { Vec::new() };
    let (mut outcome, periods) = if looks.is_empty() {
        progress.task("stepping", 0);
        progress.foresee(plan.instance_steps());
        let of = |i| if plan.steps(i) > 0 { plan.run.periods } else { 0 };
        // An engine tells the ends of runs whose starts it is given.
        let gives_starts = plan.starts.is_none() && engine.resumes() && plan.run.start == Start::Steady;
        let outcome = match gives_starts {
            true => engine.run(&plan.clone().starting_at(free_starts(plan)), progress)?,
            false => engine.run(plan, progress)?,
        };
        (outcome, plan.instances().map(of).collect())
    } else {
        let mut waiting = IntegrationRun::new(plan);
        let count = looks.len() + 1;
        for (number, until) in (1..).zip(looks.into_iter().chain([plan.run.periods])) {
            progress.task(format!("waiting {number}/{count}"), 0);
            waiting.step(plan, until, engine, progress)?;
            if waiting.left.is_empty() || progress.stopped() {
                break;
            }
        }
        (waiting.outcome, waiting.periods)
    };
    compare_two_periods(plan, &mut outcome, engine, progress)?;
    Ok(OrbitSolution { outcome, found: Vec::new(), periods, jumps: Vec::new() })
}

/// Marks steady instances as not steady if their next two periods differ by more than the accuracy. The fundamental hardly
/// shows that a tip hits the sample hard and softly by turns, and the measured periods together show the harder hit alone.
fn compare_two_periods(
    plan: &Plan,
    outcome: &mut Outcome,
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<(), EngineError> {
    // A number of contacts is compared by the steadiness of the measured periods.
    let compared: Vec<Observable> =
        plan.observables.iter().copied().filter(|one| *one != Observable::Contacts).collect();
    let end = |i: u32| outcome.ends.get(i as usize)?.as_deref().copied();
    let is_steady = |i: u32| outcome.results[i as usize].status.is_steady() && plan.steps(i) > 0;
    let (steady, ends): (Vec<u32>, Vec<SectionState>) =
        plan.instances().filter(|i| is_steady(*i)).filter_map(|i| Some((i, end(i)?))).unzip();
    if steady.is_empty() || progress.stopped() || plan.run.start == Start::Rest {
        return Ok(());
    }
    let one = measure_period(plan.part(&steady), ends.into_iter(), engine, progress)?;
    let after = one.ends.iter().map(|end| end.as_deref().map_or(SectionState::FREE, |end| *end));
    let two = measure_period(plan.part(&steady), after, engine, progress)?;
    if progress.stopped() {
        return Ok(());
    }
    for ((i, one), two) in steady.into_iter().zip(&one.results).zip(&two.results) {
        let scales = Scales::of(plan, i as usize, &one.measured);
        let change = worst(&compared, &two.measured, &one.measured, &scales);
        // Numbers beyond f32's range have a status of their own.
        if change > plan.run.accuracy && change.is_finite() {
            outcome.results[i as usize].status = Status::NotSteady;
        }
    }
    Ok(())
}

/// The free oscillation of every instance.
fn free_starts(plan: &Plan) -> Vec<StartState> {
    plan.instances().map(|i| SectionState::free(plan, i).into()).collect()
}

/// A plan between checkpoints.
struct IntegrationRun {
    outcome: Outcome,
    /// By instance: periods stepped.
    periods: Vec<u32>,
    /// Instances that have not settled, and their states.
    left: Vec<u32>,
    starts: Vec<StartState>,
    /// Periods they have done.
    done: u32,
}

impl IntegrationRun {
    /// All instances, in free oscillation or at the plan's starts.
    fn new(plan: &Plan) -> Self {
        Self {
            outcome: Outcome::of(plan),
            periods: vec![0; plan.len()],
            left: plan.instances().collect(),
            starts: plan.starts.as_ref().map_or_else(|| free_starts(plan), |starts| starts.to_vec()),
            done: 0,
        }
    }

    /// Steps the remaining instances to period `until`, and removes those that have settled.
    fn step(
        &mut self,
        plan: &Plan,
        until: u32,
        engine: &dyn Engine,
        progress: &Progress,
    ) -> Result<(), EngineError> {
        let last = until == plan.run.periods;
        let mut now = plan.part(&self.left).starting_at(std::mem::take(&mut self.starts));
        now.run.periods = until - self.done;
        now.run.accuracy = if last { plan.run.accuracy } else { SETTLED_SHARE * plan.run.accuracy };
        progress.foresee(now.instance_steps());
        let Outcome { results, ends, notes } = engine.run(&now, progress)?;
        self.outcome.notes.extend(notes);
        let cut_short = progress.stopped() && !last;
        for ((i, finished), end) in std::mem::take(&mut self.left).into_iter().zip(results).zip(ends) {
            self.outcome.results[i as usize] = finished;
            if let Some(place) = self.outcome.ends.get_mut(i as usize) {
                place.clone_from(&end);
            }
            if plan.steps(i) == 0 {
                continue;
            }
            self.periods[i as usize] = until;
            let hangs = !last && needs_full_integration(plan, i, &finished);
            if !hangs && !matches!(finished.status, Status::NotSteady | Status::NotRun) {
                continue;
            }
            self.left.push(i);
            self.starts.push(end.map_or(SectionState::FREE, |end| *end).into());
            if cut_short {
                // An unsettled instance is not done.
                self.outcome.results[i as usize] = Finished::NOT_RUN;
            }
        }
        self.done = until;
        Ok(())
    }
}

/// Whether forces need more of the motion than the accuracy of amplitudes: where the free oscillation grazes the sample, and
/// where a tip rests on it. The rest of the settling then matters more.
fn needs_full_integration(plan: &Plan, i: u32, finished: &Finished) -> bool {
    let (amplitude, gap) = (plan.driven(i).free_amplitude(), plan.case(i).gap);
    let rests = finished.measured.harmonics[0] < SHALLOW_AMPLITUDES * amplitude
        && force_share(plan, i, &finished.measured, SETTLED_SHARE * amplitude) > MAX_FORCE_SHARE;
    (amplitude - gap).abs() < SHALLOW_AMPLITUDES * amplitude || rests
}

/// Period numbers of the checkpoints, all below the scene's periods.
fn checkpoints(plan: &Plan) -> Vec<u32> {
    let stepped = plan.stepped();
    if plan.run.start == Start::Rest || stepped.is_empty() {
        return Vec::new();
    }
    let settling = |i: &u32| {
        let driven = plan.driven(*i);
        let rate = |damping: f64, omega: f64| TAU * damping * omega / driven.free.omega;
        let slowest = driven.kept.modes.iter().map(|mode| rate(mode.damping, mode.omega));
        let slowest = slowest.fold(f64::INFINITY, f64::min);
        // The change per period has to fall to this share of the free amplitude.
        let change = SETTLED_SHARE * plan.run.accuracy * slowest.min(1.0);
        -change.ln() / slowest
    };
    let longest = stepped.iter().map(settling).fold(0.0, f64::max) + f64::from(plan.run.measure);
    let mut looks = Vec::new();
    let mut at = longest.max(4.0 * f64::from(plan.run.measure)).max(8.0);
    while at * CHECKPOINT_GROWTH < f64::from(plan.run.periods) {
        looks.push(at as u32);
        at *= CHECKPOINT_GROWTH;
    }
    looks
}

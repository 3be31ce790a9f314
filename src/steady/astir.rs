//! Waiting that ends early where a motion comes no nearer to repeating itself.

use super::wait;
use super::{Settled, measured};
use crate::engine::{Engine, EngineError, Outcome, Progress};
use crate::observe::Status;
use crate::plan::{Plan, StartState, Station};
use std::f64::consts::TAU;

/// Periods before the first look.
const FIRST: u32 = 20;
/// Between the two looks free motion falls by this exponent.
const FALLS: f64 = 2.0;
/// A motion that is still so large a share of the way from repeating itself as it was at the first look does not settle.
const STILL: f64 = 0.5;
/// Motions that repeat after up to so many periods count as repeating.
const REPEATS: usize = 8;
/// Periods before those that are measured at the end: their changes tell that it is not steady.
const BEFORE: u32 = 5;

/// Waits for the plan's instances, whose neighbours in a sweep have no periodic state: those that are no nearer to one
/// after a while are measured as they are then, and the others are waited for as long as any.
pub(super) fn run(plan: &Plan, engine: &dyn Engine, progress: &Progress) -> Result<Settled, EngineError> {
    let stepped = plan.stepped();
    let between = stepped.iter().map(|i| falls(plan, *i)).max().unwrap_or(0);
    let short = FIRST + between + 2 * REPEATS as u32 + BEFORE + plan.run.measure;
    if !engine.resumes() || stepped.len() < plan.len() || 2 * short > plan.run.periods {
        return wait::run(plan, engine, progress);
    }
    let free = plan.instances().map(|i| Station::free(plan, i)).collect();
    let (first, at) = look(plan, after(plan, free, FIRST, engine, progress)?, engine, progress)?;
    let (second, at) = look(plan, after(plan, at, between, engine, progress)?, engine, progress)?;
    let astir = |i: &u32| second[*i as usize] >= STILL * first[*i as usize];
    let (astir, others): (Vec<u32>, Vec<u32>) = plan.instances().partition(astir);
    let mut settled = Settled {
        outcome: Outcome { ends: Vec::new(), ..Outcome::of(plan) },
        found: Vec::new(),
        periods: vec![short; plan.len()],
        jumps: Vec::new(),
    };
    let mut on = plan.part(&astir).starting_at(astir.iter().map(|i| at[*i as usize].into()).collect());
    on.run.periods = BEFORE + plan.run.measure;
    progress.foresee(on.instance_steps());
    let ended = engine.run(&on, progress)?;
    settled.outcome.notes.extend(ended.notes);
    let mut left = others;
    for (i, finished) in astir.iter().zip(ended.results) {
        match finished.status {
            // It does repeat.
            Status::Ok => left.push(*i),
            _ => settled.outcome.results[*i as usize] = finished,
        }
    }
    if !left.is_empty() {
        let waited = wait::run(&plan.part(&left), engine, progress)?;
        for (place, i) in left.iter().map(|i| *i as usize).enumerate() {
            settled.outcome.results[i] = waited.outcome.results[place];
            settled.periods[i] += waited.periods[place];
        }
        settled.outcome.notes.extend(waited.outcome.notes);
    }
    Ok(settled)
}

/// Periods in which free motion of an instance's slowest mode falls as far as two looks need.
fn falls(plan: &Plan, instance: u32) -> u32 {
    let driven = plan.driven(instance);
    let rates = driven.kept.modes.iter().map(|mode| TAU * mode.damping * mode.omega / driven.free.omega);
    (FALLS / rates.fold(f64::INFINITY, f64::min)).min(1e9) as u32
}

/// Where the instances are so many periods after these places.
fn after(
    plan: &Plan,
    places: Vec<Station>,
    periods: u32,
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<Vec<Station>, EngineError> {
    let all: Vec<u32> = plan.instances().collect();
    let starts = places.into_iter().map(StartState::from).collect();
    let on = plan.trial(&all, periods, 1).starting_at(starts);
    progress.foresee(on.instance_steps());
    let ends = engine.run(&on, progress)?.ends;
    Ok(ends.into_iter().map(|end| end.map_or(Station::FREE, |end| *end)).collect())
}

/// How far each instance is from repeating itself, m, and where it is then.
fn look(
    plan: &Plan,
    places: Vec<Station>,
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<(Vec<f64>, Vec<Station>), EngineError> {
    let mut nearest = vec![f64::INFINITY; plan.len()];
    let mut at = places.clone();
    for _ in 0..REPEATS {
        at = after(plan, at, 1, engine, progress)?;
        for ((nearest, now), then) in nearest.iter_mut().zip(&at).zip(&places) {
            *nearest = nearest.min(measured::distance(now, then));
        }
    }
    Ok((nearest, at))
}

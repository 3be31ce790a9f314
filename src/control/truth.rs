//! What the reference engine makes of instances whose motion a stepped engine has seen.

use super::{Arithmetic, Controlled, steps};
use crate::engine::{Cpu, Engine, EngineError, Finished, Progress, Reference, solve_near};
use crate::observe::{Measured, Status};
use crate::plan::{Plan, Precision, Station};
use crate::scene::{Start, Steady};
use crate::steady::{self, PeriodicState, Settled};
use rayon::prelude::*;

/// A run by the reference engine. States that the scene wants searched for are the reference's own next to those that
/// the CPU engine finds.
///
/// # Errors
/// What the engines say.
pub fn by_reference(
    plan: &Plan,
    reference: &Reference,
    progress: &Progress,
) -> Result<Controlled, EngineError> {
    progress.stage(&["reference"]);
    let count = plan.cases.len();
    let search = plan.run.steady == Steady::Search;
    let stepped: Vec<u32> = (0..count as u32).filter(|i| plan.cases[*i as usize].steps > 0).collect();
    let Settled { mut outcome, found, periods } = match search {
        true => {
            // By the same way as a controlled run, so that of two states it is the same one.
            let plan = Plan { precision: Precision::F64, ..plan.clone() };
            let rough = match plan.run.steps_per_period {
                Some(_) => Vec::new(),
                None => {
                    steady::run(&steps::quartered(&plan, &stepped), &[], &Cpu::default(), progress)?.found
                }
            };
            steady::run(&plan, &rough, &Cpu::default(), progress)?
        }
        false => steady::run(plan, &[], reference, progress)?,
    };
    if search && !progress.stopped() {
        let truths = truths(plan, true, &stepped, &found, reference, progress)?;
        stepped.iter().zip(truths).for_each(|(i, truth)| outcome.results[*i as usize] = truth);
    }
    let unknown = vec![f64::NAN; count];
    Ok(Controlled {
        plan: plan.clone(),
        outcome,
        estimates: unknown.clone(),
        left_out: unknown,
        found,
        periods,
        arithmetic: Arithmetic::of(
            &Plan { precision: Precision::F64, ..plan.clone() },
            "the reference engine has no other",
        ),
    })
}

/// Where these instances are in their periodic motion: as found, or else as the stepped engine leaves them at the
/// end of the run; none for runs from rest, whose beginning counts.
fn stations(
    plan: &Plan,
    instances: &[u32],
    found: &[Option<Box<PeriodicState>>],
    progress: &Progress,
) -> Result<Vec<Option<Station>>, EngineError> {
    if plan.run.start == Start::Rest {
        return Ok(vec![None; instances.len()]);
    }
    let known = |i: u32| found.get(i as usize).and_then(|place| place.as_deref()).map(|place| place.station);
    let waiting: Vec<u32> = instances.iter().copied().filter(|i| known(*i).is_none()).collect();
    let mut ends = std::collections::HashMap::new();
    if !waiting.is_empty() {
        let mut trial = plan.trial(&waiting, plan.run.periods, plan.run.measure);
        trial.precision = Precision::F64;
        trial.stations = Some(std::sync::Arc::new(
            (0..trial.cases.len() as u32).map(|i| Station::free(&trial, i)).collect(),
        ));
        let ended = Cpu::default().run(&trial, progress)?.ends;
        ends.extend(waiting.into_iter().zip(ended));
    }
    let end = |i: u32| ends.get(&i)?.as_deref().copied().filter(|station| station.finite);
    Ok(instances.iter().map(|i| known(*i).or_else(|| end(*i))).collect())
}

/// The reference's results of these instances: their periodic states next to where the stepped engine was; where that
/// has none, a whole run if it is to `wait`, and else the word that it is not steady. Runs from rest are whole ones.
pub(super) fn truths(
    plan: &Plan,
    wait: bool,
    instances: &[u32],
    found: &[Option<Box<PeriodicState>>],
    reference: &Reference,
    progress: &Progress,
) -> Result<Vec<Finished>, EngineError> {
    let stations = stations(plan, instances, found, progress)?;
    progress.task("periodic states", instances.len() as u64);
    // In their order: a run that is stopped has done the first ones.
    let mut near = vec![None; instances.len()];
    let done: Vec<(usize, Option<Finished>)> = stations
        .iter()
        .enumerate()
        .par_bridge()
        .filter_map(|(n, station)| Some((n, station.as_ref()?)))
        .map(|(n, station)| {
            let near = solve_near(plan, instances[n] as usize, station, reference, progress)?;
            progress.done(1);
            Ok((n, near))
        })
        .collect::<Result<_, EngineError>>()?;
    done.into_iter().for_each(|(n, found)| near[n] = found);
    let none = || instances.iter().zip(&near).filter(|(_, near)| near.is_none()).map(|(i, _)| *i);
    let left: Vec<u32> = if wait || plan.run.start == Start::Rest { none().collect() } else { Vec::new() };
    let lost = match progress.stopped() {
        true => Finished::NOT_RUN,
        false => Finished { measured: Measured::NONE, status: Status::NotSteady },
    };
    let whole = match left.is_empty() {
        true => Vec::new(),
        false => {
            let left = plan.only(&left);
            progress.task("waiting", 0);
            progress.foresee(left.instance_steps());
            reference.run(&left, progress)?.results
        }
    };
    Ok(instances
        .iter()
        .zip(near)
        .map(|(i, near)| near.unwrap_or_else(|| whole.get(*i as usize).copied().unwrap_or(lost)))
        .collect())
}

//! Error estimates of second states: with half of the steps, with a richer basis, and with more steps if necessary.

use super::RunResult;
use super::difference_scale::scaled_difference;
use super::energy_balance::{missed_resonances, work_of_steps};
use super::search_checkpoints::CheckpointedSearch;
use super::second_orbit::{SecondOrbit, SecondState};
use crate::engine::{EngineError, Finished};
use crate::observe::Status;
use crate::orbit::{self, PeriodicState};
use crate::plan::{Plan, STEPS_MAX, SectionState};
use std::collections::{BTreeMap, HashMap};

/// Second states with error estimates. Each is searched for again from its orbit with half of its steps and, if there is one,
/// with the next richer basis. If the error stays above the aim, its steps are doubled, as for first states. The estimate is
/// infinite if the state does not exist with other steps or another basis.
///
/// If a first state has no estimate, neither has the second. A stopped run leaves unfinished states as not_run.
pub(super) fn estimated(
    run: &RunResult,
    seconds: BTreeMap<u32, SecondState>,
    pieces: &CheckpointedSearch,
) -> Result<Vec<SecondOrbit>, EngineError> {
    let (numbers, all): (Vec<u32>, Vec<SecondState>) = seconds.into_iter().unzip();
    let plan = run.plan.part(&numbers);
    let others = numbers.iter().zip(&all).zip(plan.cases()).map(|((i, second), case)| SecondOrbit {
        instance: *i,
        finished: second.finished,
        multiplier: second.orbit.floquet.multiplier,
        estimate: f64::NAN,
        steps: case.steps,
    });
    let asked = |n: &u32| !run.estimates[numbers[*n as usize] as usize].is_nan();
    let known: Vec<u32> = (0..numbers.len() as u32).filter(asked).collect();
    let mut sight = SecondRefinement {
        of_steps: vec![f64::INFINITY; numbers.len()],
        of_modes: numbers.iter().map(|i| run.truncation[*i as usize]).collect(),
        of_resonances: vec![0.0; numbers.len()],
        others: others.collect(),
        places: all.into_iter().map(|second| *second.orbit).collect(),
        open: vec![false; numbers.len()],
        plan,
    };
    if known.is_empty() {
        return Ok(sight.others);
    }
    sight.refine(&known, pieces)?;
    for &n in &known {
        let estimate = sight.estimate(n as usize);
        let other = &mut sight.others[n as usize];
        if sight.open[n as usize] {
            other.finished.status = Status::NotRun;
            continue;
        }
        other.estimate = estimate;
        if other.finished.status == Status::Ok && other.estimate > sight.plan.run.accuracy {
            other.finished.status = Status::AccuracyNotMet;
        }
    }
    Ok(sight.others)
}

/// Second states and their errors, by their number among those that have one.
struct SecondRefinement {
    plan: Plan,
    others: Vec<SecondOrbit>,
    places: Vec<PeriodicState>,
    of_steps: Vec<f64>,
    of_modes: Vec<f64>,
    of_resonances: Vec<f64>,
    /// Whether some of its work was skipped.
    open: Vec<bool>,
}

impl SecondRefinement {
    fn refine(&mut self, known: &[u32], pieces: &CheckpointedSearch) -> Result<(), EngineError> {
        let (fewest, left) = (self.plan.policy.fewest_steps, self.plan.policy.left_of_steps);
        let halved = |steps: u32| (steps / 2).max(fewest.min(steps));
        let coarse = self.plan.part(known).with_steps(halved);
        for (n, found) in self.again(&coarse, known, pieces)? {
            let of_work = work_of_steps(&self.plan, n as u32, &self.others[n].finished.measured);
            self.of_steps[n] = found.map_or(f64::INFINITY, |(apart, ..)| (left * apart).max(of_work));
        }
        self.add_unmet_modes(known, pieces)?;
        let (poor, _) = self.plan.can_be_richer(known.to_vec());
        let rich = self.plan.part(&poor).with_richer_bases();
        let mut taken = HashMap::new();
        for (there, (n, found)) in self.again(&rich, &poor, pieces)?.into_iter().enumerate() {
            self.of_modes[n] = found.as_ref().map_or(f64::INFINITY, |(apart, ..)| left * apart);
            if let Some((_, finished, place)) = found.filter(|_| self.estimate(n) > self.aim()) {
                self.put(n, finished, *place);
                self.plan.take_resolution(n as u32, &rich, there as u32, &mut taken);
            }
        }
        for _ in 0..self.plan.policy.doublings {
            let leads = |n: usize| self.of_steps[n] >= self.of_modes[n];
            let doubtful = |n: &&u32| {
                let n = **n as usize;
                !self.open[n]
                    && self.estimate(n) > self.aim()
                    && leads(n)
                    && self.plan.steps(n as u32) <= STEPS_MAX / 2
            };
            let rough: Vec<u32> = known.iter().filter(doubtful).copied().collect();
            if rough.is_empty() {
                break;
            }
            let finer = self.plan.part(&rough).with_steps(|steps| 2 * steps);
            let mut taken = HashMap::new();
            for (there, (n, found)) in self.again(&finer, &rough, pieces)?.into_iter().enumerate() {
                let Some((apart, finished, place)) = found else { continue };
                let of_work = work_of_steps(&finer, there as u32, &finished.measured);
                self.of_steps[n] = (left * apart).max(of_work);
                self.put(n, finished, *place);
                self.plan.take_resolution(n as u32, &finer, there as u32, &mut taken);
            }
        }
        Ok(())
    }

    /// Adds the resonant modes that the bases leave out where the measured force asks for them.
    fn add_unmet_modes(&mut self, known: &[u32], pieces: &CheckpointedSearch) -> Result<(), EngineError> {
        for &n in known {
            let measured = &self.others[n as usize].finished.measured;
            self.of_resonances[n as usize] = missed_resonances(&self.plan, n, measured);
        }
        let leads = |n: usize| self.of_resonances[n] > self.of_steps[n].max(self.of_modes[n]);
        let asked = |n: &&u32| self.estimate(**n as usize) > self.aim() && leads(**n as usize);
        let unmet: Vec<u32> = known.iter().filter(asked).copied().collect();
        let with = self.plan.part(&unmet).with_unmet_modes();
        let mut taken = HashMap::new();
        for (there, (n, found)) in self.again(&with, &unmet, pieces)?.into_iter().enumerate() {
            let Some((_, finished, place)) = found else {
                self.of_resonances[n] = f64::INFINITY;
                continue;
            };
            self.of_resonances[n] = missed_resonances(&with, there as u32, &finished.measured);
            self.put(n, finished, *place);
            self.plan.take_resolution(n as u32, &with, there as u32, &mut taken);
        }
        Ok(())
    }

    /// Takes the state that another plan gives.
    fn put(&mut self, n: usize, finished: Finished, place: PeriodicState) {
        let other = &mut self.others[n];
        (other.finished, other.multiplier, other.steps) = (finished, place.floquet.multiplier, place.steps);
        self.places[n] = place;
    }

    fn aim(&self) -> f64 {
        self.plan.policy.aim * self.plan.run.accuracy
    }

    fn estimate(&self, n: usize) -> f64 {
        self.of_steps[n] + self.of_modes[n] + self.of_resonances[n]
    }

    /// Searches for the states of these instances with another plan, which has these instances only. Returns their distance
    /// from the known states. None if there is no such state, or the search was skipped.
    fn again(
        &mut self,
        plan: &Plan,
        instances: &[u32],
        pieces: &CheckpointedSearch,
    ) -> Result<Vec<RefinedOrbit>, EngineError> {
        let place = |(there, n): (usize, &u32)| {
            orbit::transfer_orbit((&self.plan, *n, &self.places[*n as usize]), plan, there as u32)
        };
        let places: Vec<SectionState> = instances.iter().enumerate().map(place).collect();
        let mut all = Vec::with_capacity(instances.len());
        for (there, (n, found)) in
            instances.iter().zip(pieces.solve_from_sections(plan, &places)?).enumerate()
        {
            let n = *n as usize;
            let Some((finished, place)) = found else {
                self.open[n] = true;
                all.push((n, None));
                continue;
            };
            let apart = scaled_difference(plan, there as u32, &self.others[n].finished, &finished);
            let another = SAME_ORBIT_SHARE.max(plan.policy.branches_apart * plan.run.accuracy);
            let same = |place| (apart <= another).then_some((apart, finished, place));
            all.push((n, place.and_then(same)));
        }
        Ok(all)
    }
}

/// Number of a state, distance from the known one, and the new result and orbit.
type RefinedOrbit = (usize, Option<(f64, Finished, Box<PeriodicState>)>);

/// Largest change with the steps, on the scales of accuracy, of what still counts as the same state.
const SAME_ORBIT_SHARE: f64 = 0.1;

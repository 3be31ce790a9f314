//! Error estimates of second states: with half of the steps, with a richer basis, and with more steps if necessary.

use super::RunResult;
use super::difference_scale::scaled_difference;
use super::energy_balance::missed_resonances;
use super::error_parts::ErrorParts;
use super::missed_compliance::{FoundMotion, truncation_error};
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
    let mut refining = SecondRefinement {
        known: numbers.iter().map(|i| ErrorParts::of_modes(run.truncation[*i as usize])).collect(),
        others: others.collect(),
        orbits: all.into_iter().map(|second| *second.orbit).collect(),
        open: vec![false; numbers.len()],
        plan,
    };
    if known.is_empty() {
        return Ok(refining.others);
    }
    refining.refine(&known, pieces)?;
    for &n in &known {
        let estimate = refining.known[n as usize].error();
        let other = &mut refining.others[n as usize];
        if refining.open[n as usize] {
            other.finished.status = Status::NotRun;
            continue;
        }
        other.estimate = estimate;
        if other.finished.status == Status::Ok && other.estimate > refining.plan.run.accuracy {
            other.finished.status = Status::AccuracyNotMet;
        }
    }
    Ok(refining.others)
}

/// Second states and their errors, by their number among those that have one.
struct SecondRefinement {
    plan: Plan,
    others: Vec<SecondOrbit>,
    orbits: Vec<PeriodicState>,
    known: Vec<ErrorParts>,
    /// Whether some of its work was skipped.
    open: Vec<bool>,
}

impl SecondRefinement {
    fn refine(&mut self, stepped: &[u32], pieces: &CheckpointedSearch) -> Result<(), EngineError> {
        let fewest = self.plan.policy.fewest_steps;
        let halved = |steps: u32| (steps / 2).max(fewest.min(steps));
        let coarse = self.plan.part(stepped).with_steps(halved);
        for (n, found) in self.again(&coarse, stepped, pieces)? {
            let i = n as u32;
            let own = FoundMotion::new(&self.others[n].finished.measured, None);
            self.known[n].of_resonances = missed_resonances(&self.plan, i, own);
            match found {
                Some((apart, ..)) => self.known[n].after_more_steps((&self.plan, i), apart, own),
                None => self.known[n].of_steps = f64::INFINITY,
            }
        }
        self.add_waiting_modes(stepped, pieces)?;
        let (poor, _) = self.plan.can_be_richer(stepped.to_vec());
        let rich = self.plan.part(&poor).with_richer_bases();
        let mut taken = HashMap::new();
        for (there, (n, found)) in (0..).zip(self.again(&rich, &poor, pieces)?) {
            let Some((apart, finished, place)) = found else {
                self.known[n].of_modes = f64::INFINITY;
                continue;
            };
            let measured = finished.measured;
            let richer = FoundMotion::new(&measured, None);
            self.known[n].of_modes = truncation_error(&rich, there, apart, richer);
            if self.known[n].error() > self.aim() {
                self.known[n].after_richer_basis((&rich, there), apart, richer);
                self.put(n, (finished, *place), (&rich, there), &mut taken);
            }
        }
        for _ in 0..self.plan.policy.doublings {
            let doubtful = |n: &&u32| {
                let (n, known) = (**n as usize, &self.known[**n as usize]);
                let leads = known.of_steps >= known.of_modes;
                let finer = self.plan.steps(n as u32) <= STEPS_MAX / 2;
                !self.open[n] && known.error() > self.aim() && leads && finer
            };
            let rough: Vec<u32> = stepped.iter().filter(doubtful).copied().collect();
            if rough.is_empty() {
                break;
            }
            let finer = self.plan.part(&rough).with_steps(|steps| 2 * steps);
            let mut taken = HashMap::new();
            for (there, (n, found)) in (0..).zip(self.again(&finer, &rough, pieces)?) {
                let Some((apart, finished, place)) = found else { continue };
                let found = FoundMotion::new(&finished.measured, None);
                self.known[n].after_more_steps((&finer, there), apart, found);
                self.put(n, (finished, *place), (&finer, there), &mut taken);
            }
        }
        Ok(())
    }

    /// Adds the resonant modes that wait where the measured force asks for them.
    fn add_waiting_modes(&mut self, stepped: &[u32], pieces: &CheckpointedSearch) -> Result<(), EngineError> {
        let asked = |n: &&u32| {
            let known = &self.known[**n as usize];
            let ok = self.others[**n as usize].finished.status == Status::Ok;
            ok && known.resonances_lead() && known.error() > self.aim()
        };
        let waiting: Vec<u32> = stepped.iter().filter(asked).copied().collect();
        let with = self.plan.part(&waiting).with_waiting_modes();
        let mut taken = HashMap::new();
        for (there, (n, found)) in (0..).zip(self.again(&with, &waiting, pieces)?) {
            let Some((apart, finished, place)) = found else {
                self.known[n].of_resonances = f64::INFINITY;
                continue;
            };
            let found = FoundMotion::new(&finished.measured, None);
            self.known[n].after_waiting_modes((&with, there), apart, found);
            self.put(n, (finished, *place), (&with, there), &mut taken);
        }
        Ok(())
    }

    /// Takes the state that another plan gives, with its steps and basis.
    fn put(
        &mut self,
        n: usize,
        (finished, orbit): (Finished, PeriodicState),
        (plan, there): (&Plan, u32),
        taken: &mut HashMap<u32, u32>,
    ) {
        let other = &mut self.others[n];
        (other.finished, other.multiplier, other.steps) = (finished, orbit.floquet.multiplier, orbit.steps);
        self.orbits[n] = orbit;
        self.plan.take_resolution(n as u32, plan, there, taken);
    }

    fn aim(&self) -> f64 {
        self.plan.policy.aim * self.plan.run.accuracy
    }

    /// Searches for the states of these instances with another plan, which has these instances only. Returns their distance
    /// from the known states. None if there is no such state, or the search was skipped.
    fn again(
        &mut self,
        plan: &Plan,
        instances: &[u32],
        pieces: &CheckpointedSearch,
    ) -> Result<Vec<RefinedOrbit>, EngineError> {
        let section = |(there, n): (usize, &u32)| {
            orbit::transfer_orbit((&self.plan, *n, &self.orbits[*n as usize]), plan, there as u32)
        };
        let sections: Vec<SectionState> = instances.iter().enumerate().map(section).collect();
        let mut all = Vec::with_capacity(instances.len());
        for (there, (n, found)) in
            instances.iter().zip(pieces.solve_from_sections(plan, &sections)?).enumerate()
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

//! The second periodic state of a bistable instance. Searches start from the lever at rest, then from second states of
//! neighbours in the sweep, then from gaps at which only the other branch is.

use super::chunk::ChunkJournal;
use super::difference_scale::scaled_difference;
use super::grid_adjacency::GridAdjacency;
use super::search_checkpoints::CheckpointedSearch;
use super::second_orbit::{SecondOrbits, SecondState};
use super::{RunResult, second_refinement};
use crate::engine::{Engine, EngineError, Finished, Progress};
use crate::kernel::Attraction;
use crate::observe::Status;
use crate::orbit::{self, Jacobian, PeriodicState};
use crate::plan::{Plan, SectionState};
use std::collections::BTreeMap;

/// Steps of a search along the gap. The last one is at the instance's own gap.
const GAP_STEPS: usize = 12;
/// Most instances of a grid that are searched along the gap. The others are then followed from them.
const ALONG_GAP: usize = 256;
/// Where such a search begins, in free amplitudes: beyond them, if attraction reaches so far.
const FAR: f64 = 1.05;
/// Otherwise where the tip just touches.
const GRAZING: f64 = 0.98;
/// Where it begins close to the surface, in gaps of the instance.
const CLOSE: f64 = 0.2;

/// Second states of the instances of a finished run. Searches first start from the lever at rest with the steps of the run.
/// Every instance without a second state is then searched again from those states of its neighbours, first or second, that
/// lie on another branch than its own. Each state so found is a neighbour for the next wave, until nothing is left to try.
/// What is still alone under a law with adhesion is searched along the gap; of a grid, some spread evenly over it.
///
/// `shape` has the lengths of the sweep's axes, the last running fastest. Neighbours are one apart along one axis. A list of
/// samples has an empty `shape` and no neighbours.
///
/// `keep` provides the searches of an earlier run and receives each new one. A stopped run returns what it knows; a state
/// that is not finished has the status not_run.
///
/// # Errors
/// Those of the engine.
pub fn second_orbits(
    run: &RunResult,
    shape: &[usize],
    keep: &dyn ChunkJournal,
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<SecondOrbits, EngineError> {
    progress.stage(&["branches"]);
    let plan: &Plan = &run.plan;
    let instances = candidates(plan, run.results.statuses());
    let pieces = CheckpointedSearch::new(keep, engine, progress);
    let tried = vec![0; plan.len()];
    let mut hunt = BranchSwitching { run, seconds: BTreeMap::new(), tried, incomplete: false };
    let mut all = SecondOrbits::default();
    match run.from_rest.is_empty() {
        true => {
            let found = pieces.solve_from_rest(&plan.part(&instances))?;
            for (&i, one) in instances.iter().zip(found) {
                match one {
                    Some((finished, place)) => _ = hunt.take(i, finished, place),
                    None => hunt.incomplete = true,
                }
            }
        }
        false => {
            for &i in &instances {
                if let Some(SecondState { finished, orbit: place }) = run.from_rest.get(i) {
                    hunt.take(i, finished, Some(place));
                }
            }
        }
    }
    all.from_rest = hunt.count();
    let neighbours = GridAdjacency::of(shape, plan.len());
    all.grid = neighbours.is_some();
    if let Some(neighbours) = &neighbours {
        hunt.follow(&instances, neighbours, &mut all, &pieces)?;
    }
    all.along_gap = hunt.along_gap(&instances, all.grid, &pieces)?;
    if let (Some(neighbours), true) = (&neighbours, all.along_gap > 0) {
        hunt.follow(&instances, neighbours, &mut all, &pieces)?;
    }
    all.orbits = second_refinement::estimated(run, hunt.seconds, &pieces)?;
    all.notes = pieces.notes.into_inner();
    all.notes.dedup();
    Ok(all)
}

/// The instances that may have a second state.
fn candidates(plan: &Plan, statuses: &[Status]) -> Vec<u32> {
    let counts = |i: &u32| plan.steps(*i) > 0 && statuses[*i as usize] != Status::NotRun;
    plan.instances().filter(counts).collect()
}

/// Results of the searches from the lever at rest, by instance of the run. With many instances they are most of the cost of
/// second states, and they do not depend on one another.
pub(super) fn from_rest(
    (plan, statuses): (&Plan, &[Status]),
    engine: &dyn Engine,
    progress: &Progress,
    notes: &mut Vec<String>,
) -> Result<Vec<Option<SecondState>>, EngineError> {
    let settled = orbit::solve_from_rest(plan, &candidates(plan, statuses), engine, progress)?;
    notes.extend(settled.outcome.notes);
    let state = |(finished, place): (Finished, Option<Box<PeriodicState>>)| {
        // The Jacobian is not needed again.
        let place = Box::new(PeriodicState { jacobian: Jacobian::Unknown, ..*place? });
        Some(SecondState { finished, orbit: place })
    };
    Ok(settled.outcome.results.into_iter().zip(settled.found).map(state).collect())
}

/// One of an instance's states.
#[derive(Clone, Copy, PartialEq, Eq)]
enum OrbitNumber {
    First,
    Second,
}

/// A search from the state of the neighbour on this side.
struct SwitchingTrial {
    instance: u32,
    side: u32,
    neighbour: u32,
    which: OrbitNumber,
}

/// Bit of a neighbour's state in the set of starts that an instance has tried.
fn trial_bit(side: u32, which: OrbitNumber) -> u64 {
    1 << (2 * side + u32::from(which == OrbitNumber::Second))
}

/// The second states so far.
struct BranchSwitching<'a> {
    run: &'a RunResult,
    seconds: BTreeMap<u32, SecondState>,
    /// For each instance, the neighbours' states from which it has been searched.
    tried: Vec<u64>,
    /// Whether a search was skipped. What would follow from it is then unknown.
    incomplete: bool,
}

impl BranchSwitching<'_> {
    fn count(&self) -> usize {
        self.seconds.len()
    }

    /// Keeps the state found for an instance if it differs from the first.
    fn take(&mut self, i: u32, finished: Finished, place: Option<Box<PeriodicState>>) -> bool {
        let Some(mut place) = place else { return false };
        let (plan, ours) = (&self.run.plan, self.run.results.get(i as usize));
        let apart =
            scaled_difference(plan, i, &ours, &finished) > plan.policy.branches_apart * plan.run.accuracy;
        // If the first run found no steady state, any state is a second one.
        let another = apart || !ours.status.is_steady();
        if another {
            // The Jacobian is not needed again.
            place.jacobian = Jacobian::Unknown;
            self.seconds.insert(i, SecondState { finished, orbit: place });
        }
        another
    }

    /// Follows second branches along the grid.
    fn follow(
        &mut self,
        instances: &[u32],
        neighbours: &GridAdjacency,
        all: &mut SecondOrbits,
        pieces: &CheckpointedSearch,
    ) -> Result<(), EngineError> {
        let mut may = vec![false; self.run.plan.len()];
        instances.iter().for_each(|i| may[*i as usize] = true);
        let mut look: Vec<u32> = instances.to_vec();
        while !look.is_empty() && !self.incomplete {
            let mut wave = Vec::new();
            for &i in look.iter().filter(|i| !self.seconds.contains_key(i)) {
                if let Some((side, j, which)) = self.candidate(i, neighbours, self.tried[i as usize]) {
                    self.tried[i as usize] |= trial_bit(side, which);
                    wave.push(SwitchingTrial { instance: i, side, neighbour: j, which });
                }
            }
            look = self.wave((&wave, neighbours), all, pieces)?;
            let next: Vec<u32> = look.iter().flat_map(|i| neighbours.adjacent(*i)).map(|(_, j)| j).collect();
            // Instances that found nothing may have other neighbours to try.
            look =
                wave.into_iter().map(|one| one.instance).chain(next).filter(|i| may[*i as usize]).collect();
            look.sort_unstable();
            look.dedup();
        }
        Ok(())
    }

    /// Searches from a gap at which only the other branch is, in steps to the instance's own: from far away where the first
    /// state is repulsive, else from close to the surface. Returns how many second states are found.
    fn along_gap(
        &mut self,
        instances: &[u32],
        grid: bool,
        pieces: &CheckpointedSearch,
    ) -> Result<usize, EngineError> {
        let plan = &self.run.plan;
        let alone = |i: &u32| {
            let adheres = plan.case(*i).contact.law.attraction() != Attraction::None;
            adheres && plan.case(*i).gap > 0.0 && !self.seconds.contains_key(i)
        };
        let open: Vec<u32> = instances.iter().copied().filter(alone).collect();
        let every = if grid { open.len().div_ceil(ALONG_GAP).max(1) } else { 1 };
        let mut numbers: Vec<u32> = open.into_iter().step_by(every).collect();
        let mut before: Option<(Plan, Vec<PeriodicState>)> = None;
        let mut found = 0;
        for step in 1..=GAP_STEPS {
            if numbers.is_empty() || self.incomplete {
                break;
            }
            let left = 1.0 - step as f64 / GAP_STEPS as f64;
            let gaps: Vec<f64> = numbers.iter().map(|i| self.gap_towards(*i, left)).collect();
            let part = plan.part(&numbers).with_gaps(&gaps);
            let place = |n: u32| match &before {
                Some((there, states)) => orbit::transfer_orbit((there, n, &states[n as usize]), &part, n),
                None => SectionState::free(&part, n),
            };
            let places: Vec<SectionState> = part.instances().map(place).collect();
            let (mut kept, mut states) = (Vec::new(), Vec::new());
            for (n, one) in pieces.solve_from_sections(&part, &places)?.into_iter().enumerate() {
                let Some((finished, state)) = one else {
                    self.incomplete = true;
                    continue;
                };
                if step == GAP_STEPS {
                    found += usize::from(self.take(numbers[n], finished, state));
                } else if let (true, Some(state)) = (finished.status.is_steady(), state) {
                    kept.push(n as u32);
                    states.push(*state);
                }
            }
            numbers = kept.iter().map(|n| numbers[*n as usize]).collect();
            before = Some((part.part(&kept), states));
        }
        Ok(found)
    }

    /// The gap when so large a share of the way along the gap is left.
    fn gap_towards(&self, i: u32, left: f64) -> f64 {
        let (plan, ours) = (&self.run.plan, self.run.results.get(i as usize));
        let case = plan.case(i);
        let free = plan.driven(i).free_amplitude();
        let from = match (
            ours.measured.force_mean < 0.0 && ours.status.is_steady(),
            case.contact.law.attraction(),
        ) {
            (true, _) => CLOSE * case.gap,
            (false, Attraction::Distant) => FAR * free.max(case.gap),
            (false, _) => GRAZING * free,
        };
        case.gap + left * (from - case.gap)
    }

    /// Searches from neighbours' states. Returns the instances that now have a second state.
    fn wave(
        &mut self,
        (wave, neighbours): (&[SwitchingTrial], &GridAdjacency),
        all: &mut SecondOrbits,
        pieces: &CheckpointedSearch,
    ) -> Result<Vec<u32>, EngineError> {
        let plan = &self.run.plan;
        let numbers: Vec<u32> = wave.iter().map(|one| one.instance).collect();
        let part = plan.part(&numbers);
        let place = |(n, one): (usize, &SwitchingTrial)| {
            let SwitchingTrial { side, neighbour: j, which, .. } = *one;
            let Some(state) = self.state(j, which) else { return SectionState::free(&part, n as u32) };
            let beyond = neighbours.adjacent(j).find(|(other, _)| *other == side);
            let both = beyond
                .into_iter()
                .flat_map(|(_, k)| [OrbitNumber::First, OrbitNumber::Second].map(|which| (k, which)));
            let before: Vec<_> = both.filter_map(|(k, which)| Some((k, self.state(k, which)?))).collect();
            orbit::transfer_orbit_corrected((plan, j, &state), &before, &part, n as u32)
        };
        let places: Vec<SectionState> = wave.iter().enumerate().map(place).collect();
        let mut found = Vec::new();
        for (&i, one) in numbers.iter().zip(pieces.solve_from_sections(&part, &places)?) {
            let Some((finished, place)) = one else {
                self.incomplete = true;
                continue;
            };
            all.tried += 1;
            if self.take(i, finished, place) {
                found.push(i);
            }
        }
        all.followed += found.len();
        Ok(found)
    }

    /// The first untried state of a neighbour that may lead to another state than the instance's first. The first number is
    /// the neighbour's side.
    fn candidate(&self, i: u32, neighbours: &GridAdjacency, tried: u64) -> Option<(u32, u32, OrbitNumber)> {
        neighbours.adjacent(i).find_map(|(side, j)| {
            [OrbitNumber::First, OrbitNumber::Second].into_iter().find_map(|which| {
                let open = tried & trial_bit(side, which) == 0 && self.is_on_other_branch(i, j, which);
                open.then_some((side, j, which))
            })
        })
    }

    fn state(&self, j: u32, which: OrbitNumber) -> Option<PeriodicState> {
        match which {
            OrbitNumber::First => self.run.found.get(j as usize),
            OrbitNumber::Second => self.seconds.get(&j).map(|second| (*second.orbit).clone()),
        }
    }

    fn has(&self, j: u32, which: OrbitNumber) -> bool {
        match which {
            OrbitNumber::First => self.run.found.has(j as usize),
            OrbitNumber::Second => self.seconds.contains_key(&j),
        }
    }

    fn result(&self, j: u32, which: OrbitNumber) -> Option<Finished> {
        match which {
            OrbitNumber::First => Some(self.run.results.get(j as usize)),
            OrbitNumber::Second => self.seconds.get(&j).map(|second| second.finished),
        }
    }

    /// Whether this state of a neighbour is on another branch than the instance's first. It is if the mean forces differ in
    /// sign, or if the neighbour's other state is nearer to the instance's first.
    fn is_on_other_branch(&self, i: u32, j: u32, which: OrbitNumber) -> bool {
        if !self.has(j, which) {
            return false;
        }
        let Some(theirs) = self.result(j, which) else { return false };
        let ours = self.run.results.get(i as usize);
        if !ours.status.is_steady() {
            return true;
        }
        let felt = |one: &Finished| one.measured.force_mean.partial_cmp(&0.0);
        if felt(&ours) != felt(&theirs) {
            return true;
        }
        let rest = match which {
            OrbitNumber::First => OrbitNumber::Second,
            OrbitNumber::Second => OrbitNumber::First,
        };
        self.result(j, rest)
            .is_some_and(|rest| fundamental_distance(&ours, &theirs) > fundamental_distance(&ours, &rest))
    }
}

/// Distance between the fundamentals of two motions, m.
fn fundamental_distance(a: &Finished, b: &Finished) -> f64 {
    let turn = (a.measured.phase - b.measured.phase).to_radians();
    let (a, b) = (a.measured.harmonics[0], b.measured.harmonics[0]);
    (a * a + b * b - 2.0 * a * b * turn.cos()).max(0.0).sqrt()
}

//! The second periodic state of a bistable instance: searched for from the lever at rest, then followed from the
//! neighbours in the sweep that have one.

use super::difference::difference;
use super::neighbours::Neighbours;
use super::other::{Others, Second};
use super::pieces::Pieces;
use super::portion::Keep;
use super::{Controlled, second};
use crate::engine::{Engine, EngineError, Finished, Progress};
use crate::observe::Status;
use crate::plan::{Plan, Station};
use crate::steady::{self, Linear, PeriodicState};
use std::collections::BTreeMap;

/// Second states of the instances of a finished run. First they are searched for from the lever at rest with the steps of
/// the run. Then every instance without one is searched again from its neighbours' states that continue another branch
/// than its own result is on: their second states, or their first ones. What is found so is a neighbour to the next,
/// wave by wave, until no wave has anything left to try.
///
/// `shape` are the lengths of the sweep's axes, the last running fastest: neighbours are one apart along one of them.
/// A list of samples has no neighbours (`shape` empty) and is left at the searches from rest.
///
/// What `keep` knows is not searched for again, and it is told of each search that ends. Of a run that is stopped, what is
/// known comes; a state that is not brought to its end is called not run.
///
/// # Errors
/// What the engine says.
pub fn others(
    run: &Controlled,
    shape: &[usize],
    keep: &dyn Keep,
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<Others, EngineError> {
    progress.stage(&["branches"]);
    let plan: &Plan = &run.plan;
    let instances = searched(plan, run.results.statuses());
    let pieces = Pieces::new(keep, engine, progress);
    let mut hunt = Hunt { run, seconds: BTreeMap::new(), open: false };
    let mut all = Others::default();
    match run.from_rest.is_empty() {
        true => {
            let found = pieces.beginning_at_rest(&plan.part(&instances))?;
            for (&i, one) in instances.iter().zip(found) {
                match one {
                    Some((finished, place)) => _ = hunt.take(i, finished, place),
                    None => hunt.open = true,
                }
            }
        }
        false => {
            for &i in &instances {
                if let Some(Second { finished, place }) = run.from_rest.get(i) {
                    hunt.take(i, finished, Some(place));
                }
            }
        }
    }
    all.from_rest = hunt.count();
    if let Some(neighbours) = Neighbours::of(shape, plan.len()) {
        all.grid = true;
        hunt.follow(&instances, &neighbours, &mut all, &pieces)?;
    }
    all.states = second::estimated(run, hunt.seconds, &pieces)?;
    all.notes = pieces.notes.into_inner();
    all.notes.dedup();
    Ok(all)
}

/// The instances that may have a second state.
fn searched(plan: &Plan, statuses: &[Status]) -> Vec<u32> {
    let counts = |i: &u32| plan.steps(*i) > 0 && statuses[*i as usize] != Status::NotRun;
    plan.instances().filter(counts).collect()
}

/// What searches from the lever at rest find, by instance of the run: for many instances they are the most of what second
/// states cost, and each is of its instance alone.
pub(super) fn from_rest(
    (plan, statuses): (&Plan, &[Status]),
    engine: &dyn Engine,
    progress: &Progress,
    notes: &mut Vec<String>,
) -> Result<Vec<Option<Second>>, EngineError> {
    let settled = steady::from_rest(plan, &searched(plan, statuses), engine, progress)?;
    notes.extend(settled.outcome.notes);
    let state = |(finished, place): (Finished, Option<Box<PeriodicState>>)| {
        // Nobody asks for the map's slope there again.
        let place = Box::new(PeriodicState { linear: Linear::Unknown, ..*place? });
        Some(Second { finished, place })
    };
    Ok(settled.outcome.results.into_iter().zip(settled.found).map(state).collect())
}

/// Which of an instance's states.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Which {
    First,
    Second,
}

/// A search from a neighbour's state, by the number of that neighbour's side.
struct Trial {
    instance: u32,
    side: u32,
    neighbour: u32,
    which: Which,
}

/// Its bit among the states of neighbours that an instance has been searched from.
fn bit(side: u32, which: Which) -> u64 {
    1 << (2 * side + u32::from(which == Which::Second))
}

/// The second states so far.
struct Hunt<'a> {
    run: &'a Controlled,
    seconds: BTreeMap<u32, Second>,
    /// Whether a search was left undone: what would follow from it is not known.
    open: bool,
}

impl Hunt<'_> {
    fn count(&self) -> usize {
        self.seconds.len()
    }

    /// Keeps what was found for an instance, if it is another state than the first.
    fn take(&mut self, i: u32, finished: Finished, place: Option<Box<PeriodicState>>) -> bool {
        let Some(mut place) = place else { return false };
        let (plan, ours) = (&self.run.plan, self.run.results.get(i as usize));
        let apart = difference(plan, i, &ours, &finished) > plan.policy.branches_apart * plan.run.accuracy;
        // Where the first run found no steady state at all, any is another.
        let another = apart || !ours.status.is_steady();
        if another {
            // Nobody asks for the map's slope there again.
            place.linear = Linear::Unknown;
            self.seconds.insert(i, Second { finished, place });
        }
        another
    }

    /// Follows second branches along the grid.
    fn follow(
        &mut self,
        instances: &[u32],
        neighbours: &Neighbours,
        all: &mut Others,
        pieces: &Pieces,
    ) -> Result<(), EngineError> {
        let mut may = vec![false; self.run.plan.len()];
        instances.iter().for_each(|i| may[*i as usize] = true);
        // Of each instance, which states of its neighbours it has been searched from.
        let mut tried = vec![0u64; self.run.plan.len()];
        let mut look: Vec<u32> = instances.to_vec();
        while !look.is_empty() && !self.open {
            let mut wave = Vec::new();
            for &i in look.iter().filter(|i| !self.seconds.contains_key(i)) {
                if let Some((side, j, which)) = self.candidate(i, neighbours, tried[i as usize]) {
                    tried[i as usize] |= bit(side, which);
                    wave.push(Trial { instance: i, side, neighbour: j, which });
                }
            }
            look = self.wave((&wave, neighbours), all, pieces)?;
            let next: Vec<u32> = look.iter().flat_map(|i| neighbours.around(*i)).map(|(_, j)| j).collect();
            // Who found nothing may have other neighbours to try.
            look =
                wave.into_iter().map(|one| one.instance).chain(next).filter(|i| may[*i as usize]).collect();
            look.sort_unstable();
            look.dedup();
        }
        Ok(())
    }

    /// Searches from neighbours' states; gives the instances that now have a second state.
    fn wave(
        &mut self,
        (wave, neighbours): (&[Trial], &Neighbours),
        all: &mut Others,
        pieces: &Pieces,
    ) -> Result<Vec<u32>, EngineError> {
        let plan = &self.run.plan;
        let numbers: Vec<u32> = wave.iter().map(|one| one.instance).collect();
        let part = plan.part(&numbers);
        let place = |(n, one): (usize, &Trial)| {
            let Trial { side, neighbour: j, which, .. } = *one;
            let Some(state) = self.state(j, which) else { return Station::free(&part, n as u32) };
            let beyond = neighbours.around(j).find(|(other, _)| *other == side);
            let both =
                beyond.into_iter().flat_map(|(_, k)| [Which::First, Which::Second].map(|which| (k, which)));
            let before: Vec<_> = both.filter_map(|(k, which)| Some((k, self.state(k, which)?))).collect();
            steady::carried_on((plan, j, &state), &before, &part, n as u32)
        };
        let places: Vec<Station> = wave.iter().enumerate().map(place).collect();
        let mut found = Vec::new();
        for (&i, one) in numbers.iter().zip(pieces.beginning_at(&part, &places)?) {
            let Some((finished, place)) = one else {
                self.open = true;
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

    /// The first of the neighbours' states from which this instance has not been searched and that may lead to another
    /// state than its first; the first number is its side.
    fn candidate(&self, i: u32, neighbours: &Neighbours, tried: u64) -> Option<(u32, u32, Which)> {
        neighbours.around(i).find_map(|(side, j)| {
            [Which::First, Which::Second].into_iter().find_map(|which| {
                let open = tried & bit(side, which) == 0 && self.leads_elsewhere(i, j, which);
                open.then_some((side, j, which))
            })
        })
    }

    fn state(&self, j: u32, which: Which) -> Option<PeriodicState> {
        match which {
            Which::First => self.run.found.get(j as usize),
            Which::Second => self.seconds.get(&j).map(|second| (*second.place).clone()),
        }
    }

    fn has(&self, j: u32, which: Which) -> bool {
        match which {
            Which::First => self.run.found.has(j as usize),
            Which::Second => self.seconds.contains_key(&j),
        }
    }

    fn result(&self, j: u32, which: Which) -> Option<Finished> {
        match which {
            Which::First => Some(self.run.results.get(j as usize)),
            Which::Second => self.seconds.get(&j).map(|second| second.finished),
        }
    }

    /// Whether this state of a neighbour is on another branch than the instance's first: it is pushed where that is
    /// pulled or free, or the other way round; or the neighbour's other state is nearer to it.
    fn leads_elsewhere(&self, i: u32, j: u32, which: Which) -> bool {
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
            Which::First => Which::Second,
            Which::Second => Which::First,
        };
        self.result(j, rest).is_some_and(|rest| far(&ours, &theirs) > far(&ours, &rest))
    }
}

/// How far the fundamentals of two motions are apart, m.
fn far(a: &Finished, b: &Finished) -> f64 {
    let turn = (a.measured.phase - b.measured.phase).to_radians();
    let (a, b) = (a.measured.harmonics[0], b.measured.harmonics[0]);
    (a * a + b * b - 2.0 * a * b * turn.cos()).max(0.0).sqrt()
}

//! What became of some instances of a run, as plain data apart from their plan: what a run writes down to go on from.

use super::choices::Choices;
use super::other::Second;
use super::{Arithmetic, Part};
use crate::engine::{Finished, Outcome};
use crate::periodic::Spectrum;
use crate::plan::{BasisRule, Fineness, Plan, Precision, Station};
use crate::steady::PeriodicState;
use std::ops::ControlFlow;

/// What became of the instances of a portion, in its order.
#[derive(Clone, Debug)]
pub struct Portion {
    /// Whether all that was to be done for it was; else what was not done is called not run.
    pub whole: bool,
    /// Whether its states were searched for.
    pub searched: bool,
    /// Whether its instances are points of curves.
    pub curves: bool,
    /// Whether it was searched from rest.
    pub from_rest: bool,
    pub instances: Vec<Ended>,
    /// What a user should know of how it went: one line each.
    pub notes: Vec<String>,
}

/// What became of one instance; see [`Part`].
#[derive(Clone, Debug)]
pub struct Ended {
    pub finished: Finished,
    pub estimate: f64,
    pub left_out: f64,
    pub periods: u32,
    pub jump: bool,
    /// Whether it began at its neighbours' states.
    pub neighbour_started: bool,
    pub precision: Precision,
    pub fineness: Fineness,
    pub state: Option<Box<Place>>,
    /// What the search from rest found.
    pub from_rest: Option<Box<(Finished, Place)>>,
}

/// A periodic state without the slope of its map.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    pub station: Station,
    pub spectrum: Spectrum,
    pub steps: u32,
    pub rule: BasisRule,
}

/// What is known of a run's portions before it begins, and who is told of each that ends.
pub trait Keep: Sync {
    /// In how many shares the run is done: these decide how it is divided.
    fn shares(&self) -> usize {
        1
    }

    /// Whether this run does one of them: what is asked of all instances together is left to who has all.
    fn partly(&self) -> bool {
        false
    }

    /// Whether this run is to do the portion of this number.
    fn wanted(&self, _number: usize) -> bool {
        true
    }

    /// What became of it, which has so many instances, in an earlier run. One that was not whole is shown and not gone on
    /// with.
    fn known(&self, _number: usize, _instances: usize) -> Option<Portion> {
        None
    }

    /// A portion has ended; a break ends the run.
    fn ended(&self, _number: usize, _portion: &dyn Fn() -> Portion) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}

/// Nothing is known, and nobody is told.
#[derive(Clone, Copy, Debug)]
pub struct InMemory;

impl Keep for InMemory {}

impl Place {
    fn of(state: &PeriodicState) -> Self {
        let PeriodicState { station, spectrum, steps, ref kept, .. } = *state;
        Self { station, spectrum, steps, rule: kept.rule }
    }

    /// As the state of an instance.
    fn state(self, plan: &Plan, instance: u32) -> Box<PeriodicState> {
        let Self { station, spectrum, steps, rule } = self;
        let kept = plan.basis_by(instance, rule);
        Box::new(PeriodicState { station, spectrum, steps, kept, slope: Box::default() })
    }
}

impl Portion {
    /// Of a run of some instances.
    pub(super) fn of(run: &Part, whole: bool) -> Self {
        let one = |i: u32| {
            let n = i as usize;
            let rest = run.from_rest.get(n).and_then(Option::as_ref);
            Ended {
                finished: run.outcome.results[n],
                estimate: run.estimates[n],
                left_out: run.left_out[n],
                periods: run.periods[n],
                jump: run.jumps.get(n).is_some_and(|jump| *jump),
                neighbour_started: run.neighbour_started.get(n).is_some_and(|begun| *begun),
                precision: run.arithmetic.of[n],
                fineness: run.plan.fineness(i),
                state: run
                    .found
                    .get(n)
                    .and_then(|state| state.as_deref())
                    .map(|state| Box::new(Place::of(state))),
                from_rest: rest.map(|rest| Box::new((rest.finished, Place::of(&rest.place)))),
            }
        };
        Self {
            whole,
            searched: !run.found.is_empty(),
            curves: !run.jumps.is_empty(),
            from_rest: !run.from_rest.is_empty(),
            instances: run.plan.instances().map(one).collect(),
            notes: run.outcome.notes.clone(),
        }
    }

    /// The run that it was, of these instances; none where they are not as many.
    pub(super) fn part(self, part: Plan, choices: &Choices) -> Option<Part> {
        let all = &self.instances;
        if all.len() != part.len() {
            return None;
        }
        let fineness: Vec<Fineness> = all.iter().map(|one| one.fineness).collect();
        let plan = part.with_fineness(&fineness);
        let found = match self.searched {
            true => {
                plan.instances().zip(all).map(|(i, one)| Some(one.state.as_ref()?.state(&plan, i))).collect()
            }
            false => Vec::new(),
        };
        let rest = |(i, one): (u32, &Ended)| {
            let (finished, place) = **one.from_rest.as_ref()?;
            Some(Second { finished, place: place.state(&plan, i) })
        };
        let from_rest = match self.from_rest {
            true => plan.instances().zip(all).map(rest).collect(),
            false => Vec::new(),
        };
        let jumps = if self.curves { all.iter().map(|one| one.jump).collect() } else { Vec::new() };
        let of = all.iter().map(|one| one.precision).collect();
        let results = all.iter().map(|one| one.finished).collect();
        Some(Part {
            outcome: Outcome { results, ends: Vec::new(), notes: self.notes },
            estimates: all.iter().map(|one| one.estimate).collect(),
            left_out: all.iter().map(|one| one.left_out).collect(),
            found,
            periods: all.iter().map(|one| one.periods).collect(),
            jumps,
            neighbour_started: match choices.neighbours {
                true => all.iter().map(|one| one.neighbour_started).collect(),
                false => Vec::new(),
            },
            from_rest,
            arithmetic: Arithmetic { of, ..choices.precision.arithmetic(0) },
            solved: Vec::new(),
            plan,
        })
    }
}

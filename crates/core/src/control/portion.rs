//! What became of some instances of a run, as plain data apart from their plan: what a run writes down to go on from.

use super::asked::{Allowance, Answer, Question};
use super::choices::Choices;
use super::other::Second;
use super::place::Place;
use super::{Arithmetic, Part};
use crate::engine::{Finished, Outcome};
use crate::plan::{Fineness, Plan, Precision};
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

/// What is known of a run before it begins, of its portions and of what is asked after them, and who is told of what ends.
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

    /// Whether what it is told outlasts the run: then it is told of pieces of the work.
    fn lasts(&self) -> bool {
        false
    }

    /// The answers that an earlier run has found, one for each question.
    fn recalled(&self, asked: &[Question]) -> Vec<Option<Answer>> {
        vec![None; asked.len()]
    }

    /// Questions that have been answered; a break ends the run.
    fn answered(&self, _all: &[(Question, Answer)]) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    /// The instances that an earlier run's audit has redone.
    fn redone(&self) -> Vec<u32> {
        Vec::new()
    }

    /// The numbers that answer a question of another kind, as an earlier run has found them.
    fn numbers(&self, _asked: &Question) -> Option<Vec<f64>> {
        None
    }

    /// Numbers that answer such a question; a break ends the run.
    fn numbered(&self, _asked: &Question, _numbers: &[f64]) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    /// What an earlier run's audit has spent.
    fn allowance(&self) -> Option<Allowance> {
        None
    }

    /// What the audit has spent so far; a break ends the run.
    fn spent(&self, _so_far: Allowance) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}

/// Nothing is known, and nobody is told.
#[derive(Clone, Copy, Debug)]
pub struct InMemory;

impl Keep for InMemory {}

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

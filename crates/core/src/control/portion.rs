//! What became of some instances of a run, as plain data apart from their plan: what a run writes down to go on from.

use super::Part;
use super::asked::{Allowance, Answer, Question};
use super::place::Place;
use crate::engine::Finished;
use crate::plan::{Fineness, Precision};
use std::ops::ControlFlow;
use std::sync::Arc;

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
    pub state: Option<Place>,
    /// What the search from rest found.
    pub from_rest: Option<Box<(Finished, Place)>>,
}

/// What is known of a run before it begins, of its portions and of what is asked after them, who is told of what ends, and
/// where portions are that have ended.
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

    /// A portion has ended, and is to be kept; a break ends the run.
    fn ended(&self, number: usize, portion: &Portion) -> ControlFlow<()>;

    /// The bytes of a portion that has ended in this run, or that was known before.
    ///
    /// # Errors
    /// In words, why they cannot be had.
    fn bytes(&self, number: usize) -> Result<Arc<Vec<u8>>, String>;

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
                state: run.found.get(n).and_then(|state| state.as_deref()).map(Place::of),
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

    /// Whether it is whole, or anything was measured of its instances: else there is nothing to keep.
    pub fn is_any(&self) -> bool {
        self.whole || self.instances.iter().any(|one| one.finished.measured.is_any())
    }
}

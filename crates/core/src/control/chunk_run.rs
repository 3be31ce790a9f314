//! Instances that are taken to their ends together, with all that this takes.

use super::{Arithmetic, orbit_pair, second_orbit};
use crate::engine::Outcome;
use crate::orbit::PeriodicState;
use crate::plan::Plan;

/// Some instances of a run, or all of a small one. See [`RunResult`](super::RunResult).
#[derive(Clone, Debug)]
pub struct ChunkRun {
    /// The plan that was carried out.
    pub plan: Plan,
    pub outcome: Outcome,
    /// Of each instance the error of its worst observable, on its scale; NaN where nothing was estimated.
    pub estimates: Vec<f64>,
    /// The part of it that modes left out have.
    pub truncation: Vec<f64>,
    /// Of each instance the periodic state that was found; empty where none was searched for.
    pub found: Vec<Option<Box<PeriodicState>>>,
    /// Of each instance the periods of its last run, those of the search among them.
    pub periods: Vec<u32>,
    /// Of each instance whether its curve's state was not reached continuously from the point before; empty without curves.
    pub jumps: Vec<bool>,
    /// Of each instance whether its search began at its neighbours' states and led to its result; empty where none did.
    pub neighbour_started: Vec<bool>,
    pub arithmetic: Arithmetic,
    /// Of each instance what others begin at; empty where none does.
    pub(super) solved: Vec<orbit_pair::OrbitPair>,
    /// Of each instance what the search from the lever at rest found; empty where it was not done.
    pub(super) from_rest: Vec<Option<second_orbit::SecondState>>,
}

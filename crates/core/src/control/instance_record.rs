//! What became of some instances of a run, as plain data apart from their plan: what a run writes down to go on from.

use super::compact_orbit::CompactOrbit;
use crate::engine::Finished;
use crate::plan::{Precision, Resolution};

/// What is said of a chunk as a whole.
#[derive(Clone, Debug)]
pub struct ChunkMeta {
    /// Whether all that was to be done for it was; else what was not done is called not run.
    pub whole: bool,
    /// Whether its states were searched for.
    pub searched: bool,
    /// Whether its instances are points of curves.
    pub curves: bool,
    /// Whether it was searched from rest.
    pub from_rest: bool,
    /// What a user should know of how it went: one line each.
    pub notes: Vec<String>,
}

/// What became of one instance; see [`Part`](super::ChunkRun).
#[derive(Clone, Debug)]
pub struct InstanceRecord {
    pub finished: Finished,
    pub estimate: f64,
    pub left_out: f64,
    pub periods: u32,
    pub jump: bool,
    /// Whether it began at its neighbours' states.
    pub neighbour_started: bool,
    pub precision: Precision,
    pub fineness: Resolution,
    pub state: Option<CompactOrbit>,
    /// What the search from rest found.
    pub from_rest: Option<Box<(Finished, CompactOrbit)>>,
}

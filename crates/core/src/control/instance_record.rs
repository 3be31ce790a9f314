//! Results of some instances as plain data without their plan. A run stores them to resume.

use super::compact_orbit::CompactOrbit;
use crate::engine::Finished;
use crate::plan::{Precision, Resolution};

/// Properties of a chunk as a whole.
#[derive(Clone, Debug)]
pub struct ChunkMeta {
    /// Whether all its work is done. If not, the instances that are left have the status not_run.
    pub whole: bool,
    /// Whether its states were searched for.
    pub searched: bool,
    /// Whether its instances are points of curves.
    pub curves: bool,
    /// Whether searches from rest ran.
    pub from_rest: bool,
    /// Messages for the user, one line each.
    pub notes: Vec<String>,
}

/// The result of one instance; see [`ChunkRun`](super::ChunkRun).
#[derive(Clone, Debug)]
pub struct InstanceRecord {
    pub finished: Finished,
    pub estimate: f64,
    pub left_out: f64,
    pub periods: u32,
    pub jump: bool,
    /// Whether its search started from its neighbours' states.
    pub neighbour_started: bool,
    pub precision: Precision,
    pub fineness: Resolution,
    pub state: Option<CompactOrbit>,
    /// Result of the search from rest.
    pub from_rest: Option<Box<(Finished, CompactOrbit)>>,
}

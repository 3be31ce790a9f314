//! Second periodic states beside those in the results.

use crate::engine::Finished;
use crate::orbit::PeriodicState;

/// A periodic state beside the one in the results.
#[derive(Clone, Copy, Debug)]
pub struct SecondOrbit {
    pub instance: u32,
    pub finished: Finished,
    /// Modulus of the largest multiplier of the period map.
    pub multiplier: f64,
    /// Error of the worst observable, on its scale. Infinite if it could not be determined; NaN if it was not estimated.
    pub estimate: f64,
    /// Steps per period of the measurement.
    pub steps: u32,
}

/// Second states, and how they were found.
#[derive(Clone, Debug, Default)]
pub struct SecondOrbits {
    /// Sorted by instance number.
    pub orbits: Vec<SecondOrbit>,
    /// Number of states that searches from rest found. The others were followed from neighbours.
    pub from_rest: usize,
    /// Number of searches from neighbours' states, and number of these that found another state.
    pub tried: usize,
    pub followed: usize,
    /// Number of states that searches along the gap found.
    pub along_gap: usize,
    /// Whether there were neighbours to follow.
    pub grid: bool,
    /// Messages for the user, one line each.
    pub notes: Vec<String>,
}

/// A second state, with its result and its orbit.
#[derive(Clone, Debug)]
pub(super) struct SecondState {
    pub finished: Finished,
    pub orbit: Box<PeriodicState>,
}

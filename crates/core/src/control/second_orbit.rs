//! Second periodic states beside those in the results.

use crate::engine::Finished;
use crate::orbit::PeriodicState;

/// A periodic state beside the one in the results.
#[derive(Clone, Copy, Debug)]
pub struct SecondOrbit {
    pub instance: u32,
    pub finished: Finished,
    /// Modulus of the period map's largest multiplier there.
    pub multiplier: f64,
    /// Error of its worst observable, on its scale: infinite where it could not be told; NaN where nobody asked.
    pub estimate: f64,
    /// Steps per period with which it was measured.
    pub steps: u32,
}

/// Second states, and how they were come by.
#[derive(Clone, Debug, Default)]
pub struct SecondOrbits {
    /// By instance number.
    pub orbits: Vec<SecondOrbit>,
    /// How many of them the searches from rest found; the rest were followed from neighbours.
    pub from_rest: usize,
    /// Searches from neighbours' states, and those that found another state.
    pub tried: usize,
    pub followed: usize,
    /// Whether there were neighbours to follow.
    pub grid: bool,
    /// What a user should know of how it went: one line each.
    pub notes: Vec<String>,
}

/// A state beside the first that was found, and where it is.
#[derive(Clone, Debug)]
pub(super) struct SecondState {
    pub finished: Finished,
    pub orbit: Box<PeriodicState>,
}

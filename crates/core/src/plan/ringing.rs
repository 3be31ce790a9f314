//! Modes that ring on from one contact to the next, and the modes that belong to an instrument's lever.

use crate::instrument::{Instrument, Mode};
use std::f64::consts::PI;

/// A mode is kept as it is if at least this share of its motion remains after a period of the drive.
const RING_SHARE: f64 = 1e-3;
/// The same share for modes of the lever that are faster than the contact.
pub(super) const LONG_RING_SHARE: f64 = 0.05;
/// Frequency of the fastest of them over the rate of the contact.
pub(super) const MAX_LEVER_MODE_RATIO: f64 = 20.0;
/// At least so many oscillators replace all other modes.
pub(super) const MIN_REDUCED_OSCILLATORS: usize = 4;
/// A mode belongs to the lever if its inverse mass exceeds this share of that of the lever's slowest.
const LEVER_MODE_SHARE: f64 = 0.05;

/// Share of a mode's motion that remains after a period of the drive at `omega` (rad/s).
pub(super) fn left(mode: &Mode, omega: f64) -> f64 {
    (-PI * mode.omega / (omega * mode.quality_factor)).exp()
}

/// Tells the lever's modes from a rod's, which hardly move the tip.
pub(super) struct LeverModes {
    /// Least inverse mass of a lever mode, 1/kg.
    least: f64,
    /// Angular frequency of the drive, rad/s.
    omega: f64,
}

impl LeverModes {
    /// Compares with the slowest mode that moves the tip as a lever's does; `omega` is of the drive.
    pub fn of(instrument: &Instrument, omega: f64) -> Self {
        let weights = || instrument.modes.iter().map(|mode| mode.inverse_mass().abs());
        let largest = weights().fold(0.0, f64::max);
        let slowest = weights().find(|one| *one > LEVER_MODE_SHARE * largest).unwrap_or(0.0);
        Self { least: LEVER_MODE_SHARE * slowest, omega }
    }

    pub fn own(&self, mode: &Mode) -> bool {
        mode.inverse_mass().abs() > self.least
    }

    /// Whether a mode moves the tip as much as a lever's once it has accumulated the effect of contact after contact: its
    /// inverse mass over the share of its motion that it loses in a period of the drive.
    pub fn gathers(&self, mode: &Mode) -> bool {
        mode.inverse_mass().abs() / (1.0 - left(mode, self.omega)) > self.least
    }
}

/// The modes among `moved` that are kept as they are among `count` oscillators. These are the lever's that are slower than the
/// contact and ring on to the next one, and, as far as there is room, faster ones that ring for long, because a contact meets
/// their phase again. A rod may have many modes, which hardly move the tip: they are left to the reduction, unless they are
/// nearly undamped.
pub(super) fn ringing(
    instrument: &Instrument,
    omega: f64,
    rate: f64,
    moved: &[usize],
    count: usize,
) -> Vec<usize> {
    let mode = |k: usize| &instrument.modes[k];
    let most = count.min(moved.len()).saturating_sub(2).max(1);
    let levers = LeverModes::of(instrument, omega);
    let levers = || moved.iter().copied().filter(|k| levers.gathers(mode(*k)));
    let slower = |k: &usize| mode(*k).omega <= rate && left(mode(*k), omega) >= RING_SHARE;
    let mut kept: Vec<usize> = levers().filter(slower).take(most.min(count.div_ceil(2))).collect();
    if kept.is_empty() {
        kept.extend(moved.first());
    }
    let room = most.min(count.saturating_sub(MIN_REDUCED_OSCILLATORS)).saturating_sub(kept.len());
    let long =
        |k: &usize| mode(*k).omega <= MAX_LEVER_MODE_RATIO * rate && left(mode(*k), omega) >= LONG_RING_SHARE;
    let more: Vec<usize> = levers().filter(|k| long(k) && !kept.contains(k)).take(room).collect();
    kept.extend(more);
    kept
}

//! Sums over the measured periods of a run, and how the fundamental moves from period to period.

use super::constants::{FAR, TWO, ZERO};
use super::{Lane, Tally};
use crate::observe::{HARMONICS, Wants};

/// Closed once a period, in the kernel's own precision, so that a shader can keep it where it runs.
#[derive(Clone, Copy, Debug)]
pub struct Ledger<L> {
    /// Fourier sums of the last period's fundamental.
    pub last_cosine: L,
    pub last_sine: L,
    /// The fundamental's latest changes from period to period, newest first, and the largest one into a
    /// measured period: observables stand for all of them. Kernel units of length.
    pub changes: [L; 4],
    pub largest: L,
    /// Sums and extremes of the measured periods' tallies.
    pub cosine: [L; HARMONICS],
    pub sine: [L; HARMONICS],
    pub deepest: L,
    pub highest: L,
    pub held: L,
    pub time: L,
    pub begun: L,
    pub ended: L,
    pub apart: L,
    pub impulse: L,
    pub work: L,
    pub virial: L,
}

impl<L: Lane> Ledger<L> {
    /// Before the first period: there was free flight.
    pub fn new() -> Self {
        let zero = L::splat(ZERO);
        Self {
            last_cosine: zero,
            last_sine: zero,
            changes: [zero; 4],
            largest: zero,
            cosine: [zero; HARMONICS],
            sine: [zero; HARMONICS],
            deepest: L::splat(-FAR),
            highest: L::splat(FAR),
            held: L::splat(FAR),
            time: zero,
            begun: zero,
            ended: zero,
            apart: zero,
            impulse: zero,
            work: zero,
            virial: zero,
        }
    }

    /// Several instances' side by side.
    pub fn from_lanes<'a>(ledger: impl Fn(usize) -> &'a Ledger<f64>) -> Self {
        let lanes = |value: fn(&Ledger<f64>) -> f64| L::from_lanes(|i| value(ledger(i)));
        Self {
            last_cosine: lanes(|one| one.last_cosine),
            last_sine: lanes(|one| one.last_sine),
            changes: std::array::from_fn(|n| L::from_lanes(|i| ledger(i).changes[n])),
            largest: lanes(|one| one.largest),
            cosine: std::array::from_fn(|n| L::from_lanes(|i| ledger(i).cosine[n])),
            sine: std::array::from_fn(|n| L::from_lanes(|i| ledger(i).sine[n])),
            deepest: lanes(|one| one.deepest),
            highest: lanes(|one| one.highest),
            held: lanes(|one| one.held),
            time: lanes(|one| one.time),
            begun: lanes(|one| one.begun),
            ended: lanes(|one| one.ended),
            apart: lanes(|one| one.apart),
            impulse: lanes(|one| one.impulse),
            work: lanes(|one| one.work),
            virial: lanes(|one| one.virial),
        }
    }

    /// One instance's, in f64.
    pub fn lane(&self, lane: usize) -> Ledger<f64> {
        let all = |values: &[L; HARMONICS]| values.map(|value| value.lane(lane));
        Ledger {
            last_cosine: self.last_cosine.lane(lane),
            last_sine: self.last_sine.lane(lane),
            changes: self.changes.map(|value| value.lane(lane)),
            largest: self.largest.lane(lane),
            cosine: all(&self.cosine),
            sine: all(&self.sine),
            deepest: self.deepest.lane(lane),
            highest: self.highest.lane(lane),
            held: self.held.lane(lane),
            time: self.time.lane(lane),
            begun: self.begun.lane(lane),
            ended: self.ended.lane(lane),
            apart: self.apart.lane(lane),
            impulse: self.impulse.lane(lane),
            work: self.work.lane(lane),
            virial: self.virial.lane(lane),
        }
    }

    /// Takes in one period of `steps` steps; `wants` is none where it is not measured.
    #[inline(always)]
    pub fn close(&mut self, tally: &Tally<L>, steps: usize, wants: Option<Wants>) {
        let cosine = tally.cosine[0] - self.last_cosine;
        let sine = tally.sine[0] - self.last_sine;
        let change = L::splat(TWO) / L::splat(steps as f64) * cosine.mul_add(cosine, sine * sine).sqrt();
        self.last_cosine = tally.cosine[0];
        self.last_sine = tally.sine[0];
        self.changes = [change, self.changes[0], self.changes[1], self.changes[2]];
        let Some(wants) = wants else { return };
        self.largest = self.largest.max(change);
        for n in 0..wants.harmonics {
            self.cosine[n] = self.cosine[n] + tally.cosine[n];
            self.sine[n] = self.sine[n] + tally.sine[n];
        }
        if wants.extremes {
            self.deepest = self.deepest.max(tally.deepest);
            self.highest = self.highest.min(tally.highest);
            self.held = self.held.min(tally.held);
        }
        if wants.contact {
            self.time = self.time + tally.time;
            self.begun = self.begun + tally.begun;
            self.ended = self.ended + tally.ended;
            self.apart = self.apart.max(tally.apart);
        }
        if wants.energy {
            self.impulse = self.impulse + tally.impulse;
            self.work = self.work + tally.work;
            self.virial = self.virial + tally.virial;
        }
    }
}

impl<L: Lane> Default for Ledger<L> {
    fn default() -> Self {
        Self::new()
    }
}

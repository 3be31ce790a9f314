//! Sums over the measured periods of a run, and how the fundamental moves from period to period.

use super::constants::{TWO, ZERO};
use super::tally::Tally;
use super::{HARMONICS, Lane, PeriodSums, Wants};

/// Closed once a period, in the kernel's own precision, so that a shader can keep it where it runs.
#[derive(Clone, Copy, Debug)]
pub struct RunSums<L> {
    /// Fourier sums of the last period's fundamental.
    pub last_cosine: L,
    pub last_sine: L,
    /// The fundamental's latest changes from period to period, newest first, and the largest one into a
    /// measured period: observables stand for all of them. Kernel units of length.
    pub changes: [L; 4],
    pub largest: L,
    /// Of the measured periods together.
    pub cosine: [L; HARMONICS],
    pub sine: [L; HARMONICS],
    pub sums: PeriodSums<L>,
}

impl<L: Lane> RunSums<L> {
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
            sums: PeriodSums::new(),
        }
    }

    /// All numbers, one after the other.
    pub fn numbers(&self) -> impl Iterator<Item = &L> {
        let Self { last_cosine, last_sine, changes, largest, cosine, sine, sums } = self;
        let single = [last_cosine, last_sine, largest].into_iter().chain(sums.numbers());
        single.chain(changes).chain(cosine).chain(sine)
    }

    /// Their places, in the same order.
    pub fn places(&mut self) -> impl Iterator<Item = &mut L> {
        let Self { last_cosine, last_sine, changes, largest, cosine, sine, sums } = self;
        let single = [last_cosine, last_sine, largest].into_iter().chain(sums.places());
        single.chain(changes).chain(cosine).chain(sine)
    }

    /// Takes these numbers in the same order.
    pub fn fill(&mut self, mut numbers: impl Iterator<Item = L>) {
        // From inside: a chain that is advanced from outside tests at each number which of its parts is next.
        self.places().for_each(|place| {
            if let Some(number) = numbers.next() {
                *place = number;
            }
        });
    }

    /// Takes in one period of `steps` steps; `wants` is none where it is not measured.
    #[inline(always)]
    pub(crate) fn close(&mut self, tally: &Tally<L>, steps: L, wants: Option<Wants>) {
        let cosine = tally.cosine[0] - self.last_cosine;
        let sine = tally.sine[0] - self.last_sine;
        let change = L::splat(TWO) / steps * cosine.mul_add(cosine, sine * sine).sqrt();
        self.last_cosine = tally.cosine[0];
        self.last_sine = tally.sine[0];
        self.changes = [change, self.changes[0], self.changes[1], self.changes[2]];
        let Some(wants) = wants else { return };
        self.largest = self.largest.max(change);
        for n in 0..wants.harmonics {
            self.cosine[n] = self.cosine[n] + tally.cosine[n];
            self.sine[n] = self.sine[n] + tally.sine[n];
        }
        self.sums.join(&tally.sums, wants);
    }
}

impl<L: Lane> Default for RunSums<L> {
    fn default() -> Self {
        Self::new()
    }
}

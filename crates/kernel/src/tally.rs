//! Sums and extremes over the steps of a period, from which the observables follow.

use super::constants::{EIGHT, FAR, ONE, ZERO};
use super::step::{Sample, Wave};
use super::{HARMONICS, Lane, Wants};

/// The body for each harmonic above the first, written out: an index that is only known when it runs would
/// keep every sum in memory.
macro_rules! each_harmonic {
    ($($index:literal)*, $n:ident => $body:block) => {
        $({
            let $n = $index;
            $body
        })*
    };
}

/// Over one period, kernel units.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tally<L> {
    /// Sums of the travel beyond the steady free one times cosine and sine, by harmonic.
    pub cosine: [L; HARMONICS],
    pub sine: [L; HARMONICS],
    /// Largest and smallest indentation, and the smallest while in contact.
    pub deepest: L,
    pub highest: L,
    pub held: L,
    /// Steps in contact, contacts begun, contacts ended, 1 if ever out of contact.
    pub time: L,
    pub begun: L,
    pub ended: L,
    pub apart: L,
    /// Sum of impulses, of their work, of their virial.
    pub impulse: L,
    pub work: L,
    pub virial: L,
    /// The last two samples of indentation and contact, carried into the next period.
    last: [L; 2],
    touched: L,
}

impl<L: Lane> Tally<L> {
    /// Between two periods, from the indentation at the last two samples and contact at the last one.
    pub fn resume(last: [L; 2], touching: L) -> Self {
        let mut tally = Self {
            cosine: [L::splat(ZERO); HARMONICS],
            sine: [L::splat(ZERO); HARMONICS],
            deepest: L::splat(ZERO),
            highest: L::splat(ZERO),
            held: L::splat(ZERO),
            time: L::splat(ZERO),
            begun: L::splat(ZERO),
            ended: L::splat(ZERO),
            apart: L::splat(ZERO),
            impulse: L::splat(ZERO),
            work: L::splat(ZERO),
            virial: L::splat(ZERO),
            last,
            touched: touching,
        };
        tally.next_period();
        tally
    }

    /// Indentation at the last two samples, and contact at the last one.
    #[inline(always)]
    pub fn carried(&self) -> [L; 3] {
        [self.last[0], self.last[1], self.touched]
    }

    /// Empties the sums for the next period; what links samples across its start is kept.
    #[inline(always)]
    pub fn next_period(&mut self) {
        let zero = L::splat(ZERO);
        self.cosine = [zero; HARMONICS];
        self.sine = [zero; HARMONICS];
        self.deepest = L::splat(-FAR);
        self.highest = L::splat(FAR);
        self.held = L::splat(FAR);
        self.time = zero;
        self.begun = zero;
        self.ended = zero;
        self.apart = zero;
        self.impulse = zero;
        self.work = zero;
        self.virial = zero;
    }

    #[inline(always)]
    pub(super) fn add(
        &mut self,
        sample: &Sample<L>,
        waves: &[Vec<Wave<L::Element>>],
        index: usize,
        wants: Wants,
    ) {
        self.add_harmonic(sample, waves[0][index], 0);
        if wants.harmonics > 1 {
            self.add_harmonics(sample, waves, index, wants);
        }
        if wants.extremes {
            self.add_extremes(sample);
        }
        if wants.contact {
            self.add_contact(sample);
        }
        if wants.energy {
            self.impulse = self.impulse + sample.kick.impulse;
            self.work = self.work + sample.work;
            self.virial = self.virial + sample.virial;
        }
        // Kept up before the measured part too: its first sample needs its predecessors.
        self.last = [self.last[1], sample.indentation];
        self.touched = sample.kick.touching;
    }

    #[inline(always)]
    fn add_harmonic(&mut self, sample: &Sample<L>, wave: Wave<L::Element>, n: usize) {
        let (cosine, sine) = (L::broadcast(wave.cosine), L::broadcast(wave.sine));
        self.cosine[n] = sample.beyond.mul_add(cosine, self.cosine[n]);
        self.sine[n] = sample.beyond.mul_add(sine, self.sine[n]);
    }

    /// Harmonics above the first.
    #[inline(always)]
    fn add_harmonics(
        &mut self,
        sample: &Sample<L>,
        waves: &[Vec<Wave<L::Element>>],
        index: usize,
        wants: Wants,
    ) {
        each_harmonic!(1 2 3 4 5 6 7 8 9, n => {
            if n < wants.harmonics {
                self.add_harmonic(sample, waves[n][index], n);
            }
        });
    }

    #[inline(always)]
    fn add_contact(&mut self, sample: &Sample<L>) {
        let (one, zero) = (L::splat(ONE), L::splat(ZERO));
        let before = zero.less(self.touched);
        let now = zero.less(sample.kick.touching);
        // Elsewhere nothing would be added.
        if L::any(L::either(L::either(before, now), zero.less(sample.kick.contact))) {
            self.time = self.time + sample.kick.contact;
            self.begun = self.begun + L::select(L::both(now, L::not(before)), one, zero);
            self.ended = self.ended + L::select(L::both(before, L::not(now)), one, zero);
        }
        self.apart = L::select(now, self.apart, one);
    }

    /// The middle of the last three samples, moved to the top of their parabola where it is one.
    #[inline(always)]
    fn add_extremes(&mut self, sample: &Sample<L>) {
        let zero = L::splat(ZERO);
        let [first, middle] = self.last;
        let next = sample.indentation;
        let turns = ((middle - first) * (next - middle)).less(zero);
        let mut value = middle;
        if L::any(turns) {
            let slope = next - first;
            let bend = (next - middle) - (middle - first);
            // `bend` is zero only where nothing turns.
            let top = middle - slope * slope / (L::splat(EIGHT) * bend);
            value = L::select(turns, top, middle);
        }
        self.deepest = self.deepest.max(value);
        self.highest = self.highest.min(value);
        let held = L::select(zero.less(self.touched), value, self.held);
        self.held = self.held.min(held);
    }
}

//! Sums and extremes over the steps of a period, from which the observables follow.

use super::Lane;
use super::step::{Sample, Wave};
use crate::observe::{HARMONICS, Wants};

/// Over one period, kernel units.
#[derive(Clone, Copy, Debug)]
pub struct Tally<L> {
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
    /// Sum of impulses, of impulse times speed, of impulse times travel.
    pub impulse: L,
    pub work: L,
    pub virial: L,
    /// The last two samples of indentation and contact, carried into the next period.
    last: [L; 2],
    touched: L,
}

/// Beyond any indentation, within f32.
const FAR: f64 = 1e30;

impl<L: Lane> Tally<L> {
    /// Before the first period: as if the tip had rested at that indentation.
    pub fn start(indentation: L, touching: L) -> Self {
        let mut tally = Self {
            cosine: [L::splat(0.0); HARMONICS],
            sine: [L::splat(0.0); HARMONICS],
            deepest: L::splat(0.0),
            highest: L::splat(0.0),
            held: L::splat(0.0),
            time: L::splat(0.0),
            begun: L::splat(0.0),
            ended: L::splat(0.0),
            apart: L::splat(0.0),
            impulse: L::splat(0.0),
            work: L::splat(0.0),
            virial: L::splat(0.0),
            last: [indentation; 2],
            touched: touching,
        };
        tally.next_period();
        tally
    }

    /// Empties the sums for the next period; what links samples across its start is kept.
    pub fn next_period(&mut self) {
        let zero = L::splat(0.0);
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
        for (harmonic, row) in waves.iter().enumerate().take(wants.harmonics) {
            let wave = row[index];
            let (cosine, sine) = (L::broadcast(wave.cosine), L::broadcast(wave.sine));
            self.cosine[harmonic] = sample.beyond.mul_add(cosine, self.cosine[harmonic]);
            self.sine[harmonic] = sample.beyond.mul_add(sine, self.sine[harmonic]);
        }
        if wants.extremes {
            self.add_extremes(sample);
        }
        if wants.contact {
            let (one, zero) = (L::splat(1.0), L::splat(0.0));
            let before = zero.less(self.touched);
            let now = zero.less(sample.kick.touching);
            self.time = self.time + sample.kick.contact;
            self.begun = self.begun + L::select(L::both(now, L::not(before)), one, zero);
            self.ended = self.ended + L::select(L::both(before, L::not(now)), one, zero);
            self.apart = L::select(now, self.apart, one);
        }
        if wants.energy {
            let impulse = sample.kick.impulse;
            self.impulse = self.impulse + impulse;
            self.work = impulse.mul_add(sample.speed, self.work);
            self.virial = impulse.mul_add(sample.centred, self.virial);
        }
        // Kept up before the measured part too: its first sample needs its predecessors.
        self.last = [self.last[1], sample.indentation];
        self.touched = sample.kick.touching;
    }

    /// The middle of the last three samples, moved to the top of their parabola where it is one.
    #[inline(always)]
    fn add_extremes(&mut self, sample: &Sample<L>) {
        let zero = L::splat(0.0);
        let [first, middle] = self.last;
        let next = sample.indentation;
        let turns = ((middle - first) * (next - middle)).less(zero);
        let slope = next - first;
        let bend = (next - middle) - (middle - first);
        // `bend` is zero only where nothing turns.
        let top = middle - slope * slope / (L::splat(8.0) * bend);
        let value = L::select(turns, top, middle);
        self.deepest = self.deepest.max(value);
        self.highest = self.highest.min(value);
        let held = L::select(zero.less(self.touched), value, self.held);
        self.held = self.held.min(held);
    }
}

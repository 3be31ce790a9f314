//! What each step adds to the sums of a period, from which the observables follow. `sums.rs` lists them.

use super::constants::{EIGHT, ONE, ZERO};
use super::sample::{Sample, Wave};
use super::{HARMONICS, Lane, PeriodSums, Wants};

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
    /// The sums of the list.
    pub sums: PeriodSums<L>,
    /// The last two samples of indentation and contact, carried into the next period.
    last: [L; 2],
    touched: L,
}

impl<L: Lane> Tally<L> {
    /// Between two periods, from the indentation at the last two samples and contact at the last one.
    pub fn resume(last: [L; 2], touching: L) -> Self {
        let zero = [L::splat(ZERO); HARMONICS];
        Self { cosine: zero, sine: zero, sums: PeriodSums::new(), last, touched: touching }
    }

    /// Indentation at the last two samples, and contact at the last one.
    #[inline(always)]
    pub fn carried(&self) -> [L; 3] {
        [self.last[0], self.last[1], self.touched]
    }

    /// Takes the other one's numbers where the mask says so, with so many harmonics.
    #[inline(always)]
    pub fn choose(&mut self, mask: L::Mask, other: &Self, harmonics: usize) {
        self.choose_harmonic(mask, other, 0);
        if harmonics > 1 {
            each_harmonic!(1 2 3 4 5 6 7 8 9, n => { self.choose_harmonic(mask, other, n) });
        }
        for n in 0..2 {
            self.last[n] = L::select(mask, other.last[n], self.last[n]);
        }
        self.touched = L::select(mask, other.touched, self.touched);
        self.sums.choose(mask, &other.sums);
    }

    #[inline(always)]
    fn choose_harmonic(&mut self, mask: L::Mask, other: &Self, n: usize) {
        self.cosine[n] = L::select(mask, other.cosine[n], self.cosine[n]);
        self.sine[n] = L::select(mask, other.sine[n], self.sine[n]);
    }

    /// Takes in a flight that begins at a sample: by harmonic the sums of travel times cosine and sine of the phase since then.
    /// `before` is about the indentation at its last sample. Those that matter, above zero, it has none of.
    #[inline(always)]
    pub fn fly(
        &mut self,
        sums: &[[L; 2]; HARMONICS],
        (waves, begin): (&[Vec<Wave<L::Element>>], usize),
        harmonics: usize,
        before: L,
    ) {
        self.fly_harmonic(sums[0], waves[0][begin], 0);
        if harmonics > 1 {
            each_harmonic!(1 2 3 4 5 6 7 8 9, n => {
                if n < harmonics {
                    self.fly_harmonic(sums[n], waves[n][begin], n);
                }
            });
        }
        self.sums.deepest = self.sums.deepest.max(before);
        self.sums.highest = self.sums.highest.min(before);
        self.sums.apart = L::splat(ONE);
        // Two equal samples: nothing turns at the next one, which is out of contact too.
        self.last = [before; 2];
    }

    #[inline(always)]
    fn fly_harmonic(&mut self, [real, imaginary]: [L; 2], wave: Wave<L::Element>, n: usize) {
        let (cosine, sine) = (L::broadcast(wave.cosine), L::broadcast(wave.sine));
        self.cosine[n] = self.cosine[n] + (cosine * real - sine * imaginary);
        self.sine[n] = self.sine[n] + (sine * real + cosine * imaginary);
    }

    /// Empties the sums for the next period; what links samples across its start is kept.
    #[inline(always)]
    pub fn next_period(&mut self) {
        let zero = L::splat(ZERO);
        self.cosine = [zero; HARMONICS];
        self.sine = [zero; HARMONICS];
        self.sums = PeriodSums::new();
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
        if wants.forces {
            self.add_forces(sample);
        }
        if wants.contact {
            self.add_contact(sample);
        }
        if wants.energy {
            self.add_energy(sample);
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
        let sums = &mut self.sums;
        let before = zero.less(self.touched);
        let now = zero.less(sample.kick.touching);
        // Elsewhere nothing would be added.
        if L::any(L::either(L::either(before, now), zero.less(sample.kick.contact))) {
            sums.time = sums.time + sample.kick.contact;
            sums.begun = sums.begun + L::select(L::both(now, L::not(before)), one, zero);
            sums.ended = sums.ended + L::select(L::both(before, L::not(now)), one, zero);
        }
        sums.apart = L::select(now, sums.apart, one);
    }

    #[inline(always)]
    fn add_forces(&mut self, sample: &Sample<L>) {
        let sums = &mut self.sums;
        sums.strongest = sums.strongest.max(sample.most);
        sums.weakest = sums.weakest.min(sample.least);
    }

    #[inline(always)]
    fn add_energy(&mut self, sample: &Sample<L>) {
        let sums = &mut self.sums;
        sums.impulse = sums.impulse + sample.kick.impulse;
        sums.work = sums.work + sample.work;
        sums.virial = sums.virial + sample.virial;
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
        let sums = &mut self.sums;
        sums.deepest = sums.deepest.max(value);
        sums.highest = sums.highest.min(value);
        let held = L::select(zero.less(self.touched), value, sums.held);
        sums.held = sums.held.min(held);
    }
}

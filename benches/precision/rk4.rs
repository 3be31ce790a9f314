//! The classical Runge-Kutta method, vectorised by hand: what a careful engineer would write for this problem.
//!
//! It integrates the deviation from free motion too, with the free motion from a table at whole and half steps,
//! instances side by side in registers, neighbours in the order of their gaps, fused multiply-add, and the contact
//! left out where no lane is near it. JKR's memory changes between steps.

use crate::answer::{Answer, Place, peak};
use crate::lanes::{Lanes, WIDTH};
use crate::law::{Hertz, Law};
use crate::problem::{MODES, Reduced, Sample};
use std::f64::consts::TAU;

/// Registers in flight.
const FLIGHT: usize = 2;
/// Instances side by side.
const SIDE: usize = FLIGHT * WIDTH;

/// Every instance of the problem at `steps` steps per period.
pub fn run(reduced: &Reduced, steps: u32) -> Vec<Answer> {
    match reduced.law.as_str() {
        "hertz" => ensemble::<Hertz<FLIGHT>>(reduced, steps),
        "dmt" => ensemble::<crate::law::Dmt<FLIGHT>>(reduced, steps),
        _ => ensemble::<crate::law::Jkr<FLIGHT>>(reduced, steps),
    }
}

fn ensemble<L: Law<FLIGHT>>(reduced: &Reduced, steps: u32) -> Vec<Answer> {
    let count = reduced.samples.len();
    let mut order: Vec<usize> = (0..count).collect();
    order.sort_by(|a, b| reduced.samples[*a].gap.total_cmp(&reduced.samples[*b].gap));
    let wave = |half: u32| (TAU * f64::from(half) / f64::from(2 * steps)).sin_cos();
    let table: Vec<(f64, f64)> = (0..=2 * steps).map(wave).collect();
    let mut answers = vec![Answer { cosine: 0.0, sine: 0.0, force_max: 0.0, loss: 0.0 }; count];
    for pack in order.chunks(SIDE) {
        let samples: [&Sample; SIDE] = std::array::from_fn(|i| &reduced.samples[pack[i.min(pack.len() - 1)]]);
        let mut walk = Walk::<L>::new(reduced, &samples, steps);
        for _ in reduced.measure..reduced.periods {
            period::<L, false>(&mut walk, &table);
        }
        walk.begin_measuring();
        for _ in 0..reduced.measure {
            period::<L, true>(&mut walk, &table);
        }
        for (lane, instance) in pack.iter().enumerate() {
            answers[*instance] = walk.answer(lane, reduced, steps);
        }
    }
    answers
}

#[derive(Clone, Copy)]
struct Walk<L> {
    law: L,
    gap: Lanes<FLIGHT>,
    stiffness: [f64; MODES],
    loss: [f64; MODES],
    share: [f64; MODES],
    h: f64,
    x: [Lanes<FLIGHT>; MODES],
    v: [Lanes<FLIGHT>; MODES],
    /// 1 in contact, for a law with a memory.
    touching: Lanes<FLIGHT>,
    cosine: Lanes<FLIGHT>,
    sine: Lanes<FLIGHT>,
    work: Lanes<FLIGHT>,
    highest: Lanes<FLIGHT>,
    deepest: [f64; SIDE],
    /// Whether it was ever apart while measured.
    apart: [bool; SIDE],
}

/// What a stage sees: accelerations, force, indentation.
struct Stage {
    rates: [Lanes<FLIGHT>; MODES],
    force: Lanes<FLIGHT>,
    indentation: Lanes<FLIGHT>,
}

impl<L: Law<FLIGHT>> Walk<L> {
    fn new(reduced: &Reduced, samples: &[&Sample; SIDE], steps: u32) -> Self {
        let zero = Lanes::splat(0.0);
        Self {
            law: L::new(|i| samples[i]),
            gap: Lanes::from_lanes(|i| samples[i].gap),
            stiffness: reduced.stiffness,
            loss: reduced.loss,
            share: reduced.share,
            h: TAU / f64::from(steps),
            x: [zero; MODES],
            v: [zero; MODES],
            touching: zero,
            cosine: zero,
            sine: zero,
            work: zero,
            highest: zero,
            deepest: [f64::NEG_INFINITY; SIDE],
            apart: [false; SIDE],
        }
    }

    fn begin_measuring(&mut self) {
        self.highest = Lanes::splat(f64::INFINITY);
    }

    #[inline(always)]
    fn stage(&self, x: &[Lanes<FLIGHT>; MODES], v: &[Lanes<FLIGHT>; MODES], free: f64) -> Stage {
        let indentation = Lanes::splat(-free) - self.gap - (x[0] + x[1] + x[2]);
        let force = self.law.force(indentation, self.touching);
        let mut rates = *x;
        for k in 0..MODES {
            let pull = x[k].scaled(-self.stiffness[k], v[k] * Lanes::splat(-self.loss[k]));
            rates[k] = force.scaled(self.share[k], pull);
        }
        Stage { rates, force, indentation }
    }

    /// One step; `waves` are sine and cosine at its beginning, middle and end.
    #[inline(always)]
    fn step<const MEASURE: bool>(&mut self, waves: &[(f64, f64)]) {
        let (x, v, h) = (self.x, self.v, self.h);
        let (mut at, mut rate) = (x, v);
        let first = self.stage(&x, &v, waves[0].1);
        for k in 0..MODES {
            at[k] = v[k].scaled(0.5 * h, x[k]);
            rate[k] = first.rates[k].scaled(0.5 * h, v[k]);
        }
        let second_rate = rate;
        let second = self.stage(&at, &rate, waves[1].1);
        for k in 0..MODES {
            at[k] = second_rate[k].scaled(0.5 * h, x[k]);
            rate[k] = second.rates[k].scaled(0.5 * h, v[k]);
        }
        let third_rate = rate;
        let third = self.stage(&at, &rate, waves[1].1);
        for k in 0..MODES {
            at[k] = third_rate[k].scaled(h, x[k]);
            rate[k] = third.rates[k].scaled(h, v[k]);
        }
        let fourth = self.stage(&at, &rate, waves[2].1);
        for k in 0..MODES {
            let sum = first.rates[k] + second.rates[k] + third.rates[k];
            self.x[k] = sum.scaled(h * h / 6.0, v[k].scaled(h, x[k]));
            let middle = (second.rates[k] + third.rates[k]).scaled(2.0, first.rates[k] + fourth.rates[k]);
            self.v[k] = middle.scaled(h / 6.0, v[k]);
        }
        if MEASURE {
            let beyond = x[0] + x[1] + x[2];
            self.cosine = beyond.scaled(waves[0].1, self.cosine);
            self.sine = beyond.scaled(waves[0].0, self.sine);
            let power = |stage: &Stage, v: &[Lanes<FLIGHT>; MODES], wave: (f64, f64)| {
                stage.force * (v[0] + v[1] + v[2] - Lanes::splat(wave.0))
            };
            if L::MEMORY {
                let middle = power(&second, &second_rate, waves[1]) + power(&third, &third_rate, waves[1]);
                let ends = power(&first, &v, waves[0]) + power(&fourth, &rate, waves[2]);
                self.work = middle.scaled(2.0, ends).scaled(h / 6.0, self.work);
            }
            self.highest = self.highest.min(first.indentation);
            self.see_peak(&first, &v, waves);
        }
        if L::MEMORY {
            let next = Lanes::splat(-waves[2].1) - self.gap - (self.x[0] + self.x[1] + self.x[2]);
            self.touching = self.law.next(next, self.touching);
        }
    }

    /// Where a lane turned within the step, the peak of the quintic through both ends.
    #[inline(always)]
    fn see_peak(&mut self, first: &Stage, v: &[Lanes<FLIGHT>; MODES], waves: &[(f64, f64)]) {
        let before = Lanes::splat(waves[0].0) - (v[0] + v[1] + v[2]);
        let after = Lanes::splat(waves[2].0) - (self.v[0] + self.v[1] + self.v[2]);
        let turned = before.max(Lanes::splat(0.0)) * (Lanes::splat(0.0) - after).max(Lanes::splat(0.0));
        if turned.any() {
            self.peaks(first, before, after, waves);
        }
        if L::MEMORY {
            for (lane, apart) in self.apart.iter_mut().enumerate() {
                *apart |= self.touching.lane(lane) == 0.0;
            }
        }
    }

    #[inline(never)]
    fn peaks(&mut self, first: &Stage, before: Lanes<FLIGHT>, after: Lanes<FLIGHT>, waves: &[(f64, f64)]) {
        let last = self.stage(&self.x, &self.v, waves[2].1);
        let bend = |stage: &Stage, wave: (f64, f64)| {
            Lanes::splat(wave.1) - (stage.rates[0] + stage.rates[1] + stage.rates[2])
        };
        let (from, to) = (bend(first, waves[0]), bend(&last, waves[2]));
        for lane in 0..SIDE {
            if before.lane(lane) > 0.0 && after.lane(lane) < 0.0 {
                let begin: Place = [first.indentation.lane(lane), before.lane(lane), from.lane(lane)];
                let end: Place = [last.indentation.lane(lane), after.lane(lane), to.lane(lane)];
                self.deepest[lane] = self.deepest[lane].max(peak(self.h, &begin, &end));
            }
        }
    }

    fn answer(&self, lane: usize, reduced: &Reduced, steps: u32) -> Answer {
        let samples = f64::from(reduced.measure) * f64::from(steps);
        let deepest = self.deepest[lane];
        let far = self.law.force_at(lane, self.highest.lane(lane), false);
        let near = self.law.force_at(lane, deepest, true);
        Answer {
            cosine: 1.0 + 2.0 * self.cosine.lane(lane) / samples,
            sine: 2.0 * self.sine.lane(lane) / samples,
            force_max: if L::MEMORY && !self.apart[lane] { near } else { near.max(far) },
            loss: -self.work.lane(lane) / f64::from(reduced.measure),
        }
    }
}

/// One drive period.
#[multiversion::multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+fma", "x86_64+avx2+fma"))]
fn period<L: Law<FLIGHT>, const MEASURE: bool>(walk: &mut Walk<L>, table: &[(f64, f64)]) {
    // A copy of its own stays in registers.
    let mut local = *walk;
    for waves in table.windows(3).step_by(2) {
        local.step::<MEASURE>(waves);
    }
    *walk = local;
}

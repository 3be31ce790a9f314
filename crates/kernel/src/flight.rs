//! Free flight: a block of steps at once where nothing can touch the sample.
//!
//! Out of contact each mode only turns and decays, so its state after many steps and its part of the harmonics' sums are
//! linear in its state before them. A bound on the path tells beforehand whether a block is free. The bits of an instance do
//! not depend on those beside it: each decides for itself.

use super::constants::{HALF, ZERO};
use super::contact::Interaction;
use super::sample::Wave;
use super::step::{Case, Free, State};
use super::tally::Tally;
use super::{FlowMode, HARMONICS, Lane, increments};
use std::f64::consts::TAU;

/// Fewest steps per period for which a test of each block costs less than it saves.
const MIN_FLIGHT_STEPS: u32 = 256;

/// A mode is bounded by its curve where it turns by less than this in a block (rad), else by its amplitude.
const MAX_CURVE_ANGLE: f64 = 1.0;

/// Fields of [`Flight`] that each mode has: the flow's increments over a block; whether the mode's travel counts as it is (1 or 0);
/// its change over the block by a unit of u; by a unit of |x| + |u|, what the height may be lower by.
const M00: usize = 0;
const M01: usize = 1;
const M11: usize = 2;
const NEAR: usize = 3;
const DRIFT: usize = 4;
const LOWER: usize = 5;
/// Behind them, by harmonic, sums of the travel times cosine and sine of the phase since the block's start: by a unit of x, then of u.
const HARMONIC: usize = 6;
const HARMONIC_FIELDS: usize = 4;

/// What free flight depends on of a lever under a drive, for steps of one length.
#[derive(Clone, Debug, PartialEq)]
pub struct Flight {
    /// Of each mode, field after field: what makes the bound and the flow, then the sums of each harmonic.
    pub fields: Vec<f64>,
}

/// The fields of lanes of instances, and the steps in a block.
#[derive(Clone, Copy, Debug)]
pub struct Flights<'a, E> {
    pub fields: &'a [E],
    pub block: usize,
}

/// Steps in a block at so many steps per period; none where blocks do not pay.
pub fn flight_block(steps: u32) -> Option<usize> {
    (steps >= MIN_FLIGHT_STEPS).then(|| 1 << (steps.ilog2() / 2))
}

impl Flight {
    /// Of modes for steps of this length (s), `steps` of them in a period of the drive and `block` in a block, with sums of so many
    /// harmonics; filled up to `count` with modes that stand still.
    pub fn new(
        modes: &[FlowMode],
        (length, steps): (f64, u32),
        (block, harmonics): (usize, usize),
        count: usize,
    ) -> Self {
        let phase = |harmonic: usize, n: usize| TAU * (harmonic * n) as f64 / f64::from(steps);
        let wave = |harmonic| (0..block).map(move |n| phase(harmonic, n).sin_cos()).collect();
        let waves: Vec<Vec<(f64, f64)>> = (1..=harmonics).map(wave).collect();
        let mut rows: Vec<_> = modes.iter().map(|mode| row(mode, length, block, &waves)).collect();
        rows.resize(count, vec![0.0; HARMONIC + HARMONIC_FIELDS * harmonics]);
        let fields = 0..HARMONIC + HARMONIC_FIELDS * harmonics;
        Self { fields: fields.flat_map(|field| rows.iter().map(move |row| row[field])).collect() }
    }
}

/// The fields of one mode, from sines and cosines by harmonic of the phase since the block's start. The mode's amplitude is at most
/// |x| + |u| and only shrinks.
fn row(mode: &FlowMode, length: f64, block: usize, waves: &[Vec<(f64, f64)>]) -> Vec<f64> {
    let angle = mode.omega * length;
    let ahead = block as f64 * angle;
    // The acceleration is at most so much, by the square of the angle and the amplitude.
    let bend = 1.0 + 2.0 * mode.damping;
    let curved = ahead * bend < MAX_CURVE_ANGLE;
    let lower = if curved { 0.5 * ahead * ahead * bend } else { 1.0 };
    // How far the path of one step reaches, by its speed and acceleration.
    let reach = angle + angle * angle * bend;
    let [near, drift] = if curved { [1.0, ahead] } else { [0.0; 2] };
    let [m00, m01, _, m11] = increments(ahead, mode.damping);
    let mut fields = vec![m00, m01, m11, near, drift, lower + reach];
    let (mut by_x, mut by_u) = (vec![1.0], vec![0.0]);
    let (mut from_x, mut from_u) = ([1.0, 0.0], [0.0, 1.0]);
    let [xx, xu, ux, uu] = increments(angle, mode.damping);
    let flown = |[x, u]: [f64; 2]| [x + (xx * x + xu * u), u + (ux * x + uu * u)];
    for _ in 1..block {
        (from_x, from_u) = (flown(from_x), flown(from_u));
        by_x.push(from_x[0]);
        by_u.push(from_u[0]);
    }
    for waves in waves {
        let sum = |by: &[f64], part: fn(&(f64, f64)) -> f64| -> f64 {
            by.iter().zip(waves).map(|(travel, wave)| travel * part(wave)).sum()
        };
        for by in [&by_x, &by_u] {
            fields.extend([sum(by, |wave| wave.1), sum(by, |wave| wave.0)]);
        }
    }
    fields
}

impl<E: Copy> Flights<'_, E> {
    /// A field of mode `k` of `modes`.
    #[inline(always)]
    fn field<L: Lane<Element = E>>(&self, field: usize, k: usize, modes: usize) -> L {
        L::load(&self.fields[(field * modes + k) * L::WIDTH..])
    }

    /// Which instances cannot touch the sample in the block that begins at `wave`: their height is above zero wherever the bound
    /// lets the path go.
    #[inline(always)]
    pub(crate) fn free<L: Lane<Element = E>, I: Interaction<L>, const M: usize>(
        &self,
        case: &Case<L, I, M>,
        state: &State<L, M>,
        wave: Wave<E>,
    ) -> L::Mask {
        let Free { cosine, sine, rate } = case.free;
        let (zero, modes) = (L::splat(ZERO), case.flow.count);
        let ahead = L::splat(self.block as f64) * rate;
        // The steady free motion, bounded as a slow mode is.
        let [steady, speed] = case.free.at(wave);
        let mut height = case.gap + steady;
        let mut drift = ahead * speed;
        let mut lower = (cosine.abs() + sine.abs()) * (L::splat(HALF) * ahead * ahead + rate + rate * rate);
        for k in 0..modes {
            let (x, u) = (state.x[k], state.u[k]);
            height = self.field::<L>(NEAR, k, modes).mul_add(x, height);
            drift = self.field::<L>(DRIFT, k, modes).mul_add(u, drift);
            lower = self.field::<L>(LOWER, k, modes).mul_add(x.abs() + u.abs(), lower);
        }
        let apart = zero.less(height + drift.min(zero) - lower);
        L::both(apart, L::not(zero.less(state.touching)))
    }

    /// Flies through the block that begins at a sample, with sums of so many harmonics.
    #[inline(always)]
    pub(crate) fn fly<L: Lane<Element = E>, I: Interaction<L>, const M: usize>(
        &self,
        case: &Case<L, I, M>,
        state: &mut State<L, M>,
        (waves, begin): (&[Vec<Wave<E>>], usize),
        harmonics: usize,
        tally: &mut Tally<L>,
    ) {
        let modes = case.flow.count;
        let mut sums = [[L::splat(ZERO); 2]; HARMONICS];
        let [steady, turned] = case.free.at(waves[0][(begin + self.block) % waves[0].len()]);
        let (mut height, mut speed) = (case.gap + steady, case.free.rate * turned);
        for k in 0..modes {
            let (x, u) = (state.x[k], state.u[k]);
            for (n, [real, imaginary]) in sums.iter_mut().enumerate().take(harmonics) {
                let at = HARMONIC + HARMONIC_FIELDS * n;
                let of_x = self.field::<L>(at, k, modes).mul_add(x, *real);
                *real = self.field::<L>(at + 2, k, modes).mul_add(u, of_x);
                let of_x = self.field::<L>(at + 1, k, modes).mul_add(x, *imaginary);
                *imaginary = self.field::<L>(at + 3, k, modes).mul_add(u, of_x);
            }
            let m01 = self.field::<L>(M01, k, modes);
            state.x[k] = m01.mul_add(u, self.field::<L>(M00, k, modes).mul_add(x, x));
            state.u[k] = self.field::<L>(M11, k, modes).mul_add(u, (-m01).mul_add(x, u));
            height = height + state.x[k];
            speed = case.flow.rate[k].mul_add(state.u[k], speed);
        }
        tally.fly(&sums, (waves, begin), harmonics, speed - height);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::Jkr;
    use crate::period::period;
    use crate::{Lever, Pack, Span, Wants};

    type Eight = Pack<f64, 8, false>;

    /// Not a whole number of blocks.
    const STEPS: usize = 520;

    fn modes() -> [FlowMode; 3] {
        let mode = |ratio: f64, damping, share| FlowMode {
            omega: ratio * TAU / STEPS as f64,
            damping,
            share,
            fast_angle: f64::INFINITY,
        };
        [mode(1.02, 0.005, 0.3), mode(6.3, 0.001, 0.3), mode(60.0, 1e-3, 0.4)]
    }

    /// Gaps from far away, where all blocks are free, to pressed in.
    const GAPS: [f64; 8] = [60.0, 24.0, 21.0, 18.0, 10.0, 2.0, -6.0, -60.0];

    /// Three periods of instances with these gaps, with flights or without: by instance the last period's sums and the state at its
    /// end, and how many blocks of the next period are free. None of these has a kick.
    fn passed(gaps: [f64; 8], flying: bool) -> Vec<(Vec<f64>, usize)> {
        let (lever, block) = (Lever::new(&modes(), 1.0, 3), flight_block(STEPS as u32).unwrap());
        let flight = Flight::new(&modes(), (1.0, STEPS as u32), (block, 3), 3);
        let spread = |numbers: &[f64]| -> Vec<f64> { numbers.iter().flat_map(|n| [*n; 8]).collect() };
        let mut constants = spread(&lever.motion);
        constants.extend(spread(&[20.0, 3.0, TAU / STEPS as f64]).into_iter().chain(gaps));
        constants.extend(spread(&[2e-3, 8.0]).into_iter().chain(spread(&lever.energy)));
        let case: Case<Eight, Jkr<Eight>, 3> = Case::load(3, &constants);
        let wave = |harmonic: usize, n: usize| {
            let angle = TAU * (n as f64 + 0.5) * harmonic as f64 / STEPS as f64;
            Wave { cosine: angle.cos(), sine: angle.sin() }
        };
        let waves = (1..=3).map(|harmonic| (0..STEPS).map(|n| wave(harmonic, n)).collect());
        let waves: Vec<Vec<_>> = waves.collect();
        let fields = spread(&flight.fields);
        let flights = Flights { fields: &fields, block };
        let span = Span {
            waves: &waves,
            decay: None,
            wants: Wants { energy: true, harmonics: 3, ..Wants::EXTREMES },
            flights: flying.then_some(flights),
            measured: true,
            periods: 1,
        };
        let zero = Eight::splat(0.0);
        let mut state = State { x: [Eight::splat(0.1); 3], u: [zero; 3], touching: zero };
        let mut tally = Tally::resume([Eight::splat(-30.0); 2], zero);
        for _ in 0..3 {
            tally.next_period();
            period(&case, &mut state, &span, None, &mut tally);
        }
        let sums = &tally.sums;
        let deepest = sums.deepest.max(zero);
        let numbers = [sums.time, deepest, sums.begun, sums.apart, sums.impulse, sums.work, sums.virial]
            .into_iter()
            .chain(tally.cosine[..3].iter().chain(&tally.sine[..3]).copied())
            .chain(state.x.into_iter().chain(state.u).chain([state.touching]));
        let numbers: Vec<Eight> = numbers.collect();
        let mut free = [0; 8];
        let mut there = state;
        for waves in waves[0].chunks_exact(block) {
            let mask = flights.free(&case, &there, waves[0]);
            let ones = Eight::select(mask, Eight::splat(1.0), zero);
            (0..8).for_each(|lane| free[lane] += ones.lane(lane) as usize);
            for wave in waves {
                let (_, kick) = case.kicked(&mut there, *wave);
                let kicked = Eight::select(mask, kick.impulse.abs() + kick.touching, zero);
                assert!((0..8).all(|lane| kicked.lane(lane) == 0.0), "a kick in a free block");
            }
        }
        let lane = |lane: usize| (numbers.iter().map(|number| number.lane(lane)).collect(), free[lane]);
        (0..8).map(lane).collect()
    }

    /// Truth: the same period step by step.
    #[test]
    fn flights_end_where_steps_end() {
        let (flown, stepped) = (passed(GAPS, true), passed(GAPS, false));
        let blocks: Vec<usize> = stepped.iter().map(|(_, blocks)| *blocks).collect();
        assert!(blocks[0] == STEPS / 16 && blocks[4..].iter().all(|n| (1..32).contains(n)), "{blocks:?}");
        assert!(stepped[4..].iter().all(|(numbers, _)| numbers[0] > 0.0), "these touch");
        for ((one, other), gap) in flown.iter().zip(&stepped).zip(GAPS) {
            for (n, (a, b)) in one.0.iter().zip(&other.0).enumerate() {
                assert!((a - b).abs() < 1e-10 * b.abs().max(1.0), "gap {gap}, number {n}: {a}, stepped {b}");
            }
        }
    }

    /// Truth: instances do not know of each other.
    #[test]
    fn an_instance_flies_alike_beside_any_others() {
        let together = passed(GAPS, true);
        for (lane, gap) in GAPS.into_iter().enumerate() {
            let alone = passed([gap; 8], true);
            let bits = |numbers: &[f64]| numbers.iter().map(|n| n.to_bits()).collect::<Vec<_>>();
            assert_eq!(bits(&alone[0].0), bits(&together[lane].0), "gap {gap}");
        }
    }
}

//! Any number of modes on any sample, stepped slowly along a curve as an experiment does: gap or drive move a little every
//! period, then the motion is left until it settles. Classical Runge-Kutta steps, shorter the nearer the surface is, and
//! cut where contact begins or ends.

use super::follow::Motion;
use super::laws::Law;
use std::f64::consts::{PI, TAU};

/// Most modes.
const MODES: usize = 2;

/// A mode that moves the tip by as much as itself.
#[derive(Clone, Copy, Debug, Default)]
pub struct Mode {
    /// N/m; Hz
    pub stiffness: f64,
    pub frequency: f64,
    pub quality: f64,
}

/// What moves along a curve.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// m
    pub gap: f64,
    /// Frequency (Hz) and amplitude (N) of the force that drives the tip.
    pub frequency: f64,
    pub force: f64,
}

/// A lever on its sample, and where it is.
#[derive(Clone, Copy, Debug)]
pub struct Sweeper {
    pub modes: [Mode; MODES],
    pub law: Law,
    pub at: Place,
    /// Length to which motions are compared: the largest free amplitude, m.
    pub scale: f64,
    /// Travel and rate of each mode where the drive's phase is zero.
    place: [f64; 2 * MODES],
    touching: bool,
}

/// Periods in which gap and drive move to their next values, those between two looks, and most looks.
const RAMP: u32 = 1000;
const LOOK: u32 = 64;
const LOOKS: usize = 60;
/// Change between two looks, in units of the scale, below which it has settled.
const SETTLED: f64 = 1e-6;
/// Steps per period of the fastest mode far from the surface; how much of the distance to it, and of the attraction's
/// reach, one goes.
const STEPS: f64 = 150.0;
const SHARE: f64 = 0.05;
const REACH: f64 = 3e-10;
/// Share of a step to which contact's beginning and end are met.
const MEETS: f64 = 1e-9;

impl Sweeper {
    /// Without a sample's force, steady; `scale` is its amplitude there.
    pub fn free(modes: &[Mode], law: Law, at: Place) -> Self {
        let mut all = [Mode::default(); MODES];
        all[..modes.len()].copy_from_slice(modes);
        let mut one = Self { modes: all, law, at, scale: 0.0, place: [0.0; 2 * MODES], touching: false };
        let mut sum = (0.0, 0.0);
        for (k, mode) in modes.iter().enumerate() {
            let w = at.frequency / mode.frequency;
            let (stiff, damped) = (1.0 - w * w, w / mode.quality);
            let size = at.force / mode.stiffness / (stiff * stiff + damped * damped);
            // z = Im((re + i im) e^(i phase))
            let (re, im) = (size * stiff, -size * damped);
            (one.place[k], one.place[MODES + k]) = (im, re);
            sum = (sum.0 + re, sum.1 + im);
        }
        one.scale = f64::hypot(sum.0, sum.1);
        one
    }

    /// Moves there and settles; none where it does not settle.
    pub fn go(&mut self, to: Place) -> Option<Motion> {
        let from = self.at;
        for n in 1..=RAMP {
            let mix = |a: f64, b: f64| a + (b - a) * f64::from(n) / f64::from(RAMP);
            self.at = Place {
                gap: mix(from.gap, to.gap),
                frequency: mix(from.frequency, to.frequency),
                force: mix(from.force, to.force),
            };
            self.period();
        }
        let mut last = self.period();
        for _ in 0..LOOKS {
            (1..LOOK).for_each(|_| _ = self.period());
            let now = self.period();
            if now.apart(&last) < SETTLED * self.scale {
                return Some(now);
            }
            last = now;
        }
        None
    }

    /// Goes on by one period and measures it.
    fn period(&mut self) -> Motion {
        match self.modes[1].stiffness > 0.0 {
            true => self.period_of::<2>(),
            false => self.period_of::<1>(),
        }
    }

    fn period_of<const N: usize>(&mut self) -> Motion {
        let equation = Equation::<N>::new(self);
        let mut y = State {
            z: std::array::from_fn(|k| self.place[k]),
            v: std::array::from_fn(|k| self.place[MODES + k]),
            sums: [0.0; 2],
        };
        let mut phase = 0.0;
        while phase < TAU {
            let delta = equation.delta(&y);
            let distance = delta.abs().min((delta - equation.release).abs()) + REACH;
            let speed: f64 = y.v.iter().sum();
            let h = equation.longest.min(SHARE * distance / speed.abs().max(1e-30)).min(TAU - phase);
            let begin = Begin { y, wave: phase.sin_cos(), touching: self.touching };
            let whole = equation.stepped(&begin, h);
            let (h, next) =
                if equation.past(&begin, &whole) > 0.0 { equation.cut(&begin, h) } else { (h, whole) };
            if equation.past(&begin, &next) > 0.0 {
                self.touching = !self.touching;
            }
            y = next;
            phase = if h == TAU - phase { TAU } else { phase + h };
        }
        self.place[..N].copy_from_slice(&y.z);
        self.place[MODES..MODES + N].copy_from_slice(&y.v);
        let (sine, cosine) = (y.sums[0] / PI, y.sums[1] / PI);
        Motion { amplitude: sine.hypot(cosine), phase: (-cosine).atan2(sine).to_degrees().rem_euclid(360.0) }
    }
}

/// Travel and rate (per radian of the drive) of each mode, and the fundamental's two integrals.
#[derive(Clone, Copy)]
struct State<const N: usize> {
    z: [f64; N],
    v: [f64; N],
    sums: [f64; 2],
}

impl<const N: usize> State<N> {
    const ZERO: Self = Self { z: [0.0; N], v: [0.0; N], sums: [0.0; 2] };

    // Loops, not iterators with closures: without link-time optimization each element of those is a call.
    #[inline]
    fn plus(&self, h: f64, k: &Self) -> Self {
        let mut sum = *self;
        for n in 0..N {
            sum.z[n] += h * k.z[n];
            sum.v[n] += h * k.v[n];
        }
        sum.sums[0] += h * k.sums[0];
        sum.sums[1] += h * k.sums[1];
        sum
    }
}

/// Where a step begins.
struct Begin<const N: usize> {
    y: State<N>,
    /// Sine and cosine of the drive's phase.
    wave: (f64, f64),
    touching: bool,
}

/// What stays the same for a period: of each mode the square of its frequency, that over the stiffness, and its damping.
struct Equation<const N: usize> {
    squares: [f64; N],
    gives: [f64; N],
    damping: [f64; N],
    gap: f64,
    force: f64,
    law: Law,
    fold: f64,
    release: f64,
    /// The longest step, and sine and cosine of half of it.
    longest: f64,
    half: (f64, f64),
}

impl<const N: usize> Equation<N> {
    fn new(of: &Sweeper) -> Self {
        let fastest = of.modes.iter().map(|mode| mode.frequency).fold(of.at.frequency, f64::max);
        let longest = TAU / STEPS * of.at.frequency / fastest;
        let squares = std::array::from_fn(|k| (of.modes[k].frequency / of.at.frequency).powi(2));
        Self {
            squares,
            gives: std::array::from_fn(|k| squares[k] / of.modes[k].stiffness),
            damping: std::array::from_fn(|k| squares[k].sqrt() / of.modes[k].quality),
            gap: of.at.gap,
            force: of.at.force,
            law: of.law,
            fold: of.law.fold(),
            release: of.law.release(),
            longest,
            half: (0.5 * longest).sin_cos(),
        }
    }

    #[inline]
    fn delta(&self, y: &State<N>) -> f64 {
        let mut travel = 0.0;
        for k in 0..N {
            travel += y.z[k];
        }
        -(self.gap + travel)
    }

    /// How far the tip is past the place where contact begins or ends; negative before it.
    fn past(&self, begin: &Begin<N>, y: &State<N>) -> f64 {
        if begin.touching { self.release - self.delta(y) } else { self.delta(y) }
    }

    /// The shortest step after which contact has changed: between the nearest ones known, where a straight line meets that
    /// place, and every third time in the middle.
    fn cut(&self, begin: &Begin<N>, h: f64) -> (f64, State<N>) {
        let (mut before, mut after) = (0.0, h);
        let mut last = self.stepped(begin, h);
        let (mut short, mut over) = (self.past(begin, &begin.y), self.past(begin, &last));
        for n in 1.. {
            if after - before <= MEETS * h {
                break;
            }
            let line = before + (after - before) * short / (short - over);
            let middle = 0.5 * (before + after);
            let least = 0.4 * MEETS * h;
            let at = if n % 3 == 0 || !line.is_finite() {
                middle
            } else {
                line.clamp(before + least, after - least)
            };
            let there = self.stepped(begin, at);
            match self.past(begin, &there) {
                past if past > 0.0 => (after, over, last) = (at, past, there),
                past => (before, short) = (at, past),
            }
        }
        (after, last)
    }

    fn stepped(&self, begin: &Begin<N>, h: f64) -> State<N> {
        let Begin { y, wave, touching } = begin;
        let half = if h == self.longest { self.half } else { (0.5 * h).sin_cos() };
        let middle = turned(*wave, half);
        let a = self.rates(*wave, y, *touching);
        let b = self.rates(middle, &y.plus(0.5 * h, &a), *touching);
        let c = self.rates(middle, &y.plus(0.5 * h, &b), *touching);
        let d = self.rates(turned(middle, half), &y.plus(h, &c), *touching);
        y.plus(h / 6.0, &a).plus(h / 3.0, &b).plus(h / 3.0, &c).plus(h / 6.0, &d)
    }

    /// Rates per radian of the drive, by its sine and cosine.
    #[inline]
    fn rates(&self, (sine, cosine): (f64, f64), y: &State<N>, touching: bool) -> State<N> {
        let force = self.force * sine + self.law.force_from(self.fold, self.delta(y), touching);
        let mut rates = State::ZERO;
        let mut travel = 0.0;
        for k in 0..N {
            travel += y.z[k];
            rates.z[k] = y.v[k];
            rates.v[k] = self.gives[k] * force - self.squares[k] * y.z[k] - self.damping[k] * y.v[k];
        }
        rates.sums = [travel * sine, travel * cosine];
        rates
    }
}

/// Sine and cosine of the sum of two angles, by those of each.
#[inline]
fn turned((sine, cosine): (f64, f64), by: (f64, f64)) -> (f64, f64) {
    (sine * by.1 + cosine * by.0, cosine * by.1 - sine * by.0)
}

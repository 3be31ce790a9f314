//! Any number of modes on any sample, stepped slowly along a curve as an experiment does: gap or drive move a little every
//! period, then the motion is left until it settles. Classical Runge-Kutta steps, shorter the nearer the surface is, and
//! cut where contact begins or ends.

use super::follow::Motion;
use super::laws::Law;
use std::f64::consts::{PI, TAU};

/// Most modes.
const MODES: usize = 2;
/// Travel and rate (per radian of the drive) of each mode, then the fundamental's two integrals.
type State = [f64; 2 * MODES + 2];

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
        let mut y: State = [0.0; 2 * MODES + 2];
        y[..2 * MODES].copy_from_slice(&self.place);
        let fastest = self.modes.iter().map(|mode| mode.frequency).fold(self.at.frequency, f64::max);
        let longest = TAU / STEPS * self.at.frequency / fastest;
        let mut phase = 0.0;
        while phase < TAU {
            let distance = self.delta(&y).abs().min((self.delta(&y) - self.law.release()).abs()) + REACH;
            let speed: f64 = y[MODES..2 * MODES].iter().sum();
            let h = longest.min(SHARE * distance / speed.abs().max(1e-30)).min(TAU - phase);
            let whole = self.stepped(phase, &y, h);
            let (h, next) = if self.changes(&whole) { self.cut(phase, &y, h) } else { (h, whole) };
            if self.changes(&next) {
                self.touching = !self.touching;
            }
            y = next;
            phase = if h == TAU - phase { TAU } else { phase + h };
        }
        self.place.copy_from_slice(&y[..2 * MODES]);
        let (sine, cosine) = (y[2 * MODES] / PI, y[2 * MODES + 1] / PI);
        Motion { amplitude: sine.hypot(cosine), phase: (-cosine).atan2(sine).to_degrees().rem_euclid(360.0) }
    }

    fn delta(&self, y: &State) -> f64 {
        -(self.at.gap + y[..MODES].iter().sum::<f64>())
    }

    /// Whether contact begins or ends by there.
    fn changes(&self, y: &State) -> bool {
        match self.touching {
            true => self.delta(y) < self.law.release(),
            false => self.delta(y) > 0.0,
        }
    }

    /// The shortest step after which contact has changed.
    fn cut(&self, phase: f64, y: &State, h: f64) -> (f64, State) {
        let (mut before, mut after) = (0.0, h);
        while after - before > MEETS * h {
            let middle = 0.5 * (before + after);
            match self.changes(&self.stepped(phase, y, middle)) {
                true => after = middle,
                false => before = middle,
            }
        }
        (after, self.stepped(phase, y, after))
    }

    fn stepped(&self, phase: f64, y: &State, h: f64) -> State {
        let next = |k: &State, h: f64| std::array::from_fn(|n| y[n] + h * k[n]);
        let a = self.rates(phase, y);
        let b = self.rates(phase + 0.5 * h, &next(&a, 0.5 * h));
        let c = self.rates(phase + 0.5 * h, &next(&b, 0.5 * h));
        let d = self.rates(phase + h, &next(&c, h));
        std::array::from_fn(|n| y[n] + h / 6.0 * (a[n] + 2.0 * (b[n] + c[n]) + d[n]))
    }

    /// Rates per radian of the drive.
    fn rates(&self, phase: f64, y: &State) -> State {
        let mut rates: State = [0.0; 2 * MODES + 2];
        let (sine, cosine) = phase.sin_cos();
        let force = self.at.force * sine + self.law.force(self.delta(y), self.touching);
        for (k, mode) in self.modes.iter().enumerate().filter(|(_, mode)| mode.stiffness > 0.0) {
            let w = mode.frequency / self.at.frequency;
            let (z, v) = (y[k], y[MODES + k]);
            rates[k] = v;
            rates[MODES + k] = w * w * (force / mode.stiffness - z) - w / mode.quality * v;
        }
        let travel: f64 = y[..MODES].iter().sum();
        (rates[2 * MODES], rates[2 * MODES + 1]) = (travel * sine, travel * cosine);
        rates
    }
}

//! One mode on a sample without memory, followed from gap to gap as an experiment does: the state is carried along while
//! the gap moves slowly, then left until it settles. Classical Runge-Kutta steps, shorter the nearer the surface is.

use super::laws::Law;
use std::f64::consts::TAU;

/// A lever of one mode driven at its tip, and where it is.
#[derive(Clone, Copy, Debug)]
pub struct Follower {
    /// N/m
    pub stiffness: f64,
    pub quality: f64,
    /// Tip amplitude without a sample, m.
    pub free: f64,
    pub law: Law,
    /// m
    pub gap: f64,
    /// Travel and its rate per radian of the drive's phase, where that is zero; m.
    pub place: [f64; 2],
    /// So many times shorter steps than [`STEPS`] and [`SHARE`] say.
    pub finer: f64,
}

/// A settled motion: the fundamental's amplitude (m), and its lag behind the drive (degrees, 0 to 360).
#[derive(Clone, Copy, Debug)]
pub struct Motion {
    pub amplitude: f64,
    pub phase: f64,
}

impl Motion {
    /// How far the fundamentals of two motions are apart, m.
    pub fn apart(&self, other: &Self) -> f64 {
        let point = |one: &Self| {
            let (sine, cosine) = one.phase.to_radians().sin_cos();
            (one.amplitude * cosine, one.amplitude * sine)
        };
        let (a, b) = (point(self), point(other));
        (a.0 - b.0).hypot(a.1 - b.1)
    }
}

/// Periods in which the gap moves to its next value, those between two looks, and most looks.
const RAMP: u32 = 200;
const LOOK: u32 = 64;
const LOOKS: usize = 60;
/// Change between two looks, in units of the free amplitude, below which it has settled.
const SETTLED: f64 = 3e-6;
/// Steps per period far from the surface, and how much of the distance to it, and of the attraction's reach, one goes.
const STEPS: f64 = 200.0;
const SHARE: f64 = 0.15;
const REACH: f64 = 3e-10;

impl Follower {
    /// Without a sample's force, steady, at the frequency at which that swings widest.
    pub fn free(stiffness: f64, quality: f64, free: f64, law: Law, gap: f64) -> Self {
        let mut one = Self { stiffness, quality, free, law, gap, place: [0.0; 2], finer: 1.0 };
        let lag = one.drive().atan2(quality * (1.0 - one.drive().powi(2)));
        one.start(&Motion { amplitude: free, phase: lag.to_degrees() });
        one
    }

    /// Puts it where this motion's fundamental is.
    pub fn start(&mut self, motion: &Motion) {
        let (sine, cosine) = motion.phase.to_radians().sin_cos();
        self.place = [-motion.amplitude * sine, motion.amplitude * cosine];
    }

    /// The drive's angular frequency over the mode's: where the free lever swings widest.
    fn drive(&self) -> f64 {
        (1.0 - 0.5 / (self.quality * self.quality)).sqrt()
    }

    /// Moves the gap there and settles; none where it does not settle.
    pub fn go(&mut self, gap: f64) -> Option<Motion> {
        let from = self.gap;
        for n in 1..=RAMP {
            self.gap = from + (gap - from) * f64::from(n) / f64::from(RAMP);
            self.period();
        }
        self.settle()
    }

    /// Waits until the motion repeats; none where it does not.
    pub fn settle(&mut self) -> Option<Motion> {
        let mut last = self.period();
        for _ in 0..LOOKS {
            (1..LOOK).for_each(|_| _ = self.period());
            let now = self.period();
            if now.apart(&last) < SETTLED * self.free {
                return Some(now);
            }
            last = now;
        }
        None
    }

    /// Goes on by one period and measures it.
    fn period(&mut self) -> Motion {
        let mut y = [self.place[0], self.place[1], 0.0, 0.0];
        let mut phase = 0.0;
        while phase < TAU {
            let distance = (self.gap + y[0]).abs() + REACH;
            let h = (TAU / STEPS).min(SHARE * distance / y[1].abs().max(1e-30)) / self.finer;
            let h = h.min(TAU - phase);
            let next = |k: &[f64; 4], h: f64| std::array::from_fn(|n| y[n] + h * k[n]);
            let a = self.rates(phase, &y);
            let b = self.rates(phase + 0.5 * h, &next(&a, 0.5 * h));
            let c = self.rates(phase + 0.5 * h, &next(&b, 0.5 * h));
            let d = self.rates(phase + h, &next(&c, h));
            y = std::array::from_fn(|n| y[n] + h / 6.0 * (a[n] + 2.0 * (b[n] + c[n]) + d[n]));
            phase = if h == TAU - phase { TAU } else { phase + h };
        }
        self.place = [y[0], y[1]];
        // z = A sin(phase - lag)
        let (sine, cosine) = (y[2] / std::f64::consts::PI, y[3] / std::f64::consts::PI);
        let phase = (-cosine).atan2(sine).to_degrees().rem_euclid(360.0);
        Motion { amplitude: sine.hypot(cosine), phase }
    }

    /// Rates per radian of travel, its rate, and the fundamental's two integrals.
    fn rates(&self, phase: f64, y: &[f64; 4]) -> [f64; 4] {
        let (z, v) = (y[0], y[1]);
        let delta = -(self.gap + z);
        let force = self.law.force(delta, delta > 0.0) / self.stiffness;
        let (sine, cosine) = phase.sin_cos();
        let w = self.drive();
        // Of the free lever's response at that frequency.
        let push = self.free * (1.0 - w * w).hypot(w / self.quality) * sine;
        [v, (push + force - z) / (w * w) - v / (w * self.quality), z * sine, z * cosine]
    }
}

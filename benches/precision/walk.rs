//! What the libraries' right-hand sides and step callbacks share: one instance's equations, what is measured of an
//! accepted step, and where JKR's memory changes.

use crate::answer::{Answer, Place, peak, quintic};
use crate::law::jkr;
use crate::problem::{MODES, Reduced, Sample};
use std::f64::consts::TAU;

/// Unknowns: travel and rate of each mode.
pub const STATE: usize = 2 * MODES;
/// While measuring also the integrals of deviation times cosine and sine, and of the force's power.
pub const MEASURING: usize = STATE + 3;

/// One instance's equations.
#[derive(Clone, Copy)]
pub struct Equations<'a> {
    pub reduced: &'a Reduced,
    pub sample: &'a Sample,
    pub law: Kind,
}

impl<'a> Equations<'a> {
    pub fn of(reduced: &'a Reduced, instance: usize) -> Self {
        Self { reduced, sample: &reduced.samples[instance], law: Kind::of(&reduced.law) }
    }

    /// The angle at which measuring begins, and at which it ends.
    pub fn span(&self) -> (f64, f64) {
        let periods = |count: u32| TAU * f64::from(count);
        (periods(self.reduced.periods - self.reduced.measure), periods(self.reduced.periods))
    }

    /// Rates of a state of [`STATE`] or [`MEASURING`] unknowns.
    #[inline]
    pub fn rates(&self, theta: f64, y: &[f64], touching: bool, out: &mut [f64]) {
        let (sine, cosine) = theta.sin_cos();
        let beyond = y[0] + y[1] + y[2];
        let force = self.sample.force(self.law, -(self.sample.gap + cosine + beyond), touching);
        let r = self.reduced;
        for k in 0..MODES {
            out[k] = y[MODES + k];
            out[MODES + k] = r.share[k] * force - r.loss[k] * y[MODES + k] - r.stiffness[k] * y[k];
        }
        if out.len() == MEASURING {
            out[STATE] = beyond * cosine;
            out[STATE + 1] = beyond * sine;
            out[STATE + 2] = force * (y[3] + y[4] + y[5] - sine);
        }
    }

    /// The indentation where state and rates are these.
    pub fn place(&self, theta: f64, y: &[f64], rates: &[f64]) -> Place {
        let (sine, cosine) = theta.sin_cos();
        [
            -(self.sample.gap + cosine + y[0] + y[1] + y[2]),
            sine - (y[3] + y[4] + y[5]),
            cosine - (rates[3] + rates[4] + rates[5]),
        ]
    }

    pub fn answer(&self, y: &[f64], force_max: f64) -> Answer {
        let measure = f64::from(self.reduced.measure);
        let scale = 2.0 / (TAU * measure);
        Answer {
            cosine: 1.0 + scale * y[STATE],
            sine: scale * y[STATE + 1],
            force_max,
            loss: -y[STATE + 2] / measure,
        }
    }
}

/// What the accepted steps of one instance came to.
#[derive(Clone, Copy)]
pub struct Seen {
    pub touching: bool,
    pub measuring: bool,
    pub force_max: f64,
    pub steps: u64,
}

impl Seen {
    pub fn new() -> Self {
        Self { touching: false, measuring: false, force_max: f64::NEG_INFINITY, steps: 0 }
    }

    /// Takes in an accepted step between two places `h` apart.
    pub fn step(&mut self, equations: &Equations, h: f64, from: &Place, to: &Place) {
        self.steps += 1;
        if self.measuring {
            let deepest = peak(h, from, to);
            for delta in [deepest, to[0]] {
                let force = equations.sample.force(equations.law, delta, self.touching);
                self.force_max = self.force_max.max(force);
            }
        }
    }

    /// Where JKR's memory changes first in a step, as a share of it, by the quintic between its ends.
    pub fn crossing(&self, equations: &Equations, h: f64, from: &Place, to: &Place) -> Option<f64> {
        if equations.law != Kind::Jkr {
            return None;
        }
        let level = equations.sample.level(self.touching);
        let beyond = |delta: f64| if self.touching { delta < level } else { delta > level };
        let path = quintic(h, from, to);
        // A contact shorter than a step shows at the turning point.
        let top = if from[1] > 0.0 && to[1] < 0.0 { root(0.0, 1.0, |u| path(u).1) } else { 1.0 };
        let end = [top, 1.0].into_iter().find(|u| beyond(path(*u).0))?;
        Some(root(0.0, end, |u| path(u).0 - level))
    }
}

/// A root between `a` and `b`, by bisection.
fn root(mut a: f64, mut b: f64, function: impl Fn(f64) -> f64) -> f64 {
    let sign = function(b) > 0.0;
    for _ in 0..52 {
        let middle = 0.5 * (a + b);
        if (function(middle) > 0.0) == sign { b = middle } else { a = middle }
    }
    b
}

impl Sample {
    /// Force on the tip under a law by its name.
    pub fn force(&self, law: Kind, indentation: f64, touching: bool) -> f64 {
        let hertz = |d: f64| if d > 0.0 { self.hertz * d * d.sqrt() } else { 0.0 };
        match law {
            Kind::Hertz => hertz(indentation),
            Kind::Dmt => {
                let share = self.decay / (self.decay - indentation.min(0.0));
                hertz(indentation) - self.adhesion * share * share
            }
            Kind::Jkr if touching => jkr(self.pull, self.unit, indentation),
            Kind::Jkr => 0.0,
        }
    }

    /// Where JKR's memory changes.
    pub fn level(&self, touching: bool) -> f64 {
        if touching { -3.0 * self.unit } else { 0.0 }
    }
}

/// Which law.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    Hertz,
    Dmt,
    Jkr,
}

impl Kind {
    pub fn of(name: &str) -> Self {
        match name {
            "hertz" => Self::Hertz,
            "dmt" => Self::Dmt,
            _ => Self::Jkr,
        }
    }
}

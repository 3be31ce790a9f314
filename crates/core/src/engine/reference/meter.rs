//! Measures a period from its steps and their continuous extensions.

use super::dop853::Dense;
use super::system::System;
use crate::kernel::{PeriodSums, RunSums};
use crate::observe::{HARMONICS, Wants};
use crate::periodic::{highest, root};

/// Gauss-Legendre points and weights on 0 to 1, eight and four of them.
const GAUSS_8: [(f64, f64); 8] = [
    (0.019_855_071_751_231_856, 0.050_614_268_145_188_13),
    (0.101_666_761_293_186_64, 0.111_190_517_226_687_24),
    (0.237_233_795_041_835_5, 0.156_853_322_938_943_64),
    (0.408_282_678_752_175_1, 0.181_341_891_689_181),
    (0.591_717_321_247_825, 0.181_341_891_689_181),
    (0.762_766_204_958_164_5, 0.156_853_322_938_943_64),
    (0.898_333_238_706_813_4, 0.111_190_517_226_687_24),
    (0.980_144_928_248_768_1, 0.050_614_268_145_188_13),
];
const GAUSS_4: [(f64, f64); 4] = [
    (0.069_431_844_202_973_7, 0.173_927_422_568_726_9),
    (0.330_009_478_207_571_9, 0.326_072_577_431_273_05),
    (0.669_990_521_792_428_1, 0.326_072_577_431_273_05),
    (0.930_568_155_797_026_3, 0.173_927_422_568_726_9),
];
/// Parts of a step in each of which a viscous contact may begin or end once, and a force has one extreme.
const PIECES: usize = 8;

/// Steps (rad) shorter than this use four points.
const SHORT_STEP: f64 = 0.05;

/// A step with its continuous extensions.
#[derive(Clone, Copy)]
pub(super) struct DenseStep {
    pub theta: f64,
    pub h: f64,
    /// Tip travel beyond the free one, m, and its rate, m per rad.
    pub travel: Dense,
    pub rate: Dense,
    /// The law's memory, m; nothing if it has none.
    pub memory: Option<[Dense; 2]>,
}

impl DenseStep {
    /// Indentation (m) and its rate (m per rad) at the share `u` of the step.
    pub fn indentation(&self, system: &System, u: f64) -> (f64, f64) {
        system.indentation(self.theta + u * self.h, self.travel.at(u), self.rate.at(u))
    }

    fn memory(&self, u: f64) -> [f64; 2] {
        self.memory.as_ref().map_or([0.0; 2], |memory| [memory[0].at(u), memory[1].at(u)])
    }
}

/// Sums and extremes; those of harmonics over one period, the others since the measured part began.
#[derive(Clone, Debug)]
pub(super) struct Meter {
    /// Integrals of the travel beyond the steady free one times cosine and sine, this period.
    pub cosine: [f64; HARMONICS],
    pub sine: [f64; HARMONICS],
    /// In SI units; a total over steps is an integral over the phase, rad.
    pub sums: PeriodSums<f64>,
    pub touched: bool,
    /// Whether a viscous sample presses on the tip; unknown before the first step.
    pressed: Option<bool>,
    harmonics: usize,
}

impl Meter {
    pub fn new(wants: Wants) -> Self {
        Self {
            cosine: [0.0; HARMONICS],
            sine: [0.0; HARMONICS],
            sums: RunSums::new().sums,
            touched: false,
            pressed: None,
            harmonics: wants.harmonics.max(1),
        }
    }

    /// Records an indentation passed at a rate (m per rad), the law's memory being this.
    pub fn see(&mut self, system: &System, delta: f64, rate: impl FnOnce() -> f64, memory: [f64; 2]) {
        let force = system.force.at(delta, || rate() * system.omega, memory, system.branch);
        self.sums.deepest = self.sums.deepest.max(delta);
        self.sums.weakest = self.sums.weakest.min(force);
        self.sums.strongest = self.sums.strongest.max(force);
    }

    /// Adds a step with turning points at the shares `turns` of it; `first` and `last` are the indentations at its ends.
    pub fn pass(&mut self, system: &System, piece: &DenseStep, turns: &[f64], first: f64, last: f64) {
        self.add_waves(system, piece);
        let mut before = first;
        let inside = turns.iter().map(|u| (piece.indentation(system, *u).0, *u));
        for (delta, u) in inside.chain([(last, 1.0)]) {
            self.see(system, delta, || piece.indentation(system, u).1, piece.memory(u));
            if let (true, Some(pull)) = (system.branch.touching, system.force.law.form().deepest_pull())
                && (before - pull) * (delta - pull) < 0.0
            {
                // The law ignores the rate.
                self.see(system, pull, || 0.0, [0.0; 2]);
            }
            before = delta;
        }
        if system.force.turns_anywhere(system.branch) {
            self.see_extremes(system, piece);
        }
        if system.force.viscous {
            self.pass_viscous(system, piece);
        } else if system.branch.touching {
            self.sums.time += piece.h;
        }
        self.touched |= system.branch.touching;
        self.part(!system.branch.touching);
    }

    /// Records the extreme forces within a step where they need not be at the extremes of the indentation.
    fn see_extremes(&mut self, system: &System, piece: &DenseStep) {
        let share = |n: usize| n as f64 / PIECES as f64;
        let force = |u: f64| {
            let (delta, rate) = piece.indentation(system, u);
            system.force.at(delta, || rate * system.omega, piece.memory(u), system.branch)
        };
        for n in 0..PIECES {
            let (from, to) = (share(n), share(n + 1));
            let middle = 0.5 * (from + to);
            for sign in [1.0, -1.0] {
                let top = |u: f64| sign * force(u);
                if top(middle) > top(from).max(top(to)) - 0.25 * (top(from) - top(to)).abs() {
                    let extreme = force(highest(from, to, top));
                    self.sums.weakest = self.sums.weakest.min(extreme);
                    self.sums.strongest = self.sums.strongest.max(extreme);
                }
            }
        }
    }

    /// Adds the contact of a step under a law that depends on the rate.
    fn pass_viscous(&mut self, system: &System, piece: &DenseStep) {
        if !system.branch.touching {
            self.pressed = Some(false);
            return;
        }
        let share = |n: usize| n as f64 / PIECES as f64;
        let pressing = |u: f64| {
            let (delta, rate) = piece.indentation(system, u);
            system.force.law.form().pressing(delta, rate * system.omega, piece.memory(u))
        };
        for n in 0..PIECES {
            let (from, to) = (share(n), share(n + 1));
            let (before, after) = (pressing(from) > 0.0, pressing(to) > 0.0);
            self.part(!(before && after));
            let change = if before == after { to } else { root(from, to, pressing) };
            self.sums.time += piece.h * if before { change - from } else { to - change };
            self.sums.begun += f64::from(u8::from(after && !self.pressed.unwrap_or(before)));
            self.pressed = Some(after);
        }
    }

    /// Notes whether some of it was out of contact.
    fn part(&mut self, parted: bool) {
        self.sums.apart = self.sums.apart.max(f64::from(u8::from(parted)));
    }

    fn add_waves(&mut self, system: &System, piece: &DenseStep) {
        let rule: &[(f64, f64)] = if piece.h < SHORT_STEP { &GAUSS_4 } else { &GAUSS_8 };
        for (u, weight) in rule {
            let theta = piece.theta + u * piece.h;
            let beyond = piece.travel.at(*u) + system.transient(theta).0;
            let (sine, cosine) = theta.sin_cos();
            let (mut s, mut c) = (sine * beyond * weight * piece.h, cosine * beyond * weight * piece.h);
            for n in 0..self.harmonics {
                self.cosine[n] += c;
                self.sine[n] += s;
                (c, s) = (c * cosine - s * sine, s * cosine + c * sine);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quadrature_is_exact_for_polynomials_of_its_degree() {
        let check = |rule: &[(f64, f64)]| {
            for power in 0..2 * rule.len() as i32 {
                let sum: f64 = rule.iter().map(|(u, weight)| weight * u.powi(power)).sum();
                assert!((sum * f64::from(power + 1) - 1.0).abs() < 1e-14, "{power}: {sum}");
            }
        };
        check(&GAUSS_4);
        check(&GAUSS_8);
    }
}

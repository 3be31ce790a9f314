//! Step control, and the location of contact events.

use super::Work;
use super::dop853::Dop853;
use super::meter::{DenseStep, Meter};
use super::system::System;
use crate::periodic::root;
use std::f64::consts::TAU;

/// Longest step, rad: the tenth harmonic turns by 4 in it, which eight points sum to rounding.
const MAX_STEP_PHASE: f64 = 0.4;
/// Radians that harmonic and fastest transient together may turn in a step.
const MAX_TRANSIENT_TURN: f64 = 5.0;
/// Shortest step, rad: here rounding alone may exceed a tolerance, and the step is accepted.
const MIN_STEP_PHASE: f64 = 1e-13;
/// First step to try, at the start and after each contact event.
const FIRST_STEP_PHASE: f64 = 1e-3;
/// Pieces of a step, each of which is checked for a turning point of the tip.
const EVENT_PIECES: usize = 8;
/// Exponents of Hairer's step control with a memory of the last error.
const PI_BETA: f64 = 0.04;
const PI_ALPHA: f64 = 0.125 - 0.75 * PI_BETA;

/// The integration of an instance.
pub(super) struct Integrator {
    pub system: System,
    pub work: Work,
    /// State at the present angle.
    pub y: Vec<f64>,
    stepper: Dop853,
    tolerance: f64,
    /// Allowed error of each unknown in a step.
    allowed: Vec<f64>,
    /// Scales of length (m) and force (N) for errors.
    length: f64,
    force: f64,
    /// Next step to try.
    h: f64,
    longest: f64,
    /// Error of the last accepted step.
    before: f64,
}

/// The course of a step: turning points as shares of it, and the first change of contact.
struct StepCourse {
    turns: Vec<f64>,
    crossing: Option<f64>,
}

impl Integrator {
    pub fn new(system: System, tolerance: f64) -> Self {
        let most = system.remembered() + 3;
        let length = system.length();
        Self {
            // A force that bends the instrument by a thousandth of the swing; soon the largest one met.
            force: 1e-3 * length / system.flexibility().abs().max(f64::MIN_POSITIVE),
            longest: MAX_STEP_PHASE.min(MAX_TRANSIENT_TURN / (10.0 + system.fastest_transient)),
            y: vec![0.0; most],
            stepper: Dop853::new(most),
            allowed: vec![0.0; most],
            work: Work::default(),
            tolerance,
            length,
            h: FIRST_STEP_PHASE,
            before: 1e-4,
            system,
        }
    }

    /// Integrates period `number`; false once the state is not finite.
    pub fn period(&mut self, number: u32, mut meter: Option<&mut Meter>) -> bool {
        self.system.begin_period(number);
        let size = self.system.size();
        let mut theta = 0.0;
        self.begin(theta, meter.as_deref_mut());
        while theta < TAU {
            self.allow();
            let most = self.h.min(self.longest);
            let left = TAU - theta;
            // Two halves rather than a step and a splinter.
            let cut = left < 2.0 * most;
            let last = left <= most;
            let h = if last {
                left
            } else if cut {
                0.5 * left
            } else {
                most
            };
            let Some(h) = self.accepted(theta, h, last || cut) else { return false };
            let whole = last && h == left;
            let course = self.course(theta, h, meter.is_some());
            let (h, crossed) = match course.crossing {
                None => (h, false),
                Some(u) => (self.land(theta, u * h, h), true),
            };
            if let Some(meter) = meter.as_deref_mut()
                && h > 0.0
            {
                self.measure(theta, h, meter, course, crossed);
            }
            if h > 0.0 {
                self.y[..size].copy_from_slice(&self.stepper.end[..size]);
                theta = if whole && !crossed { TAU } else { theta + h };
                self.grow(theta);
            }
            if crossed {
                self.switch(theta, meter.as_deref_mut());
            } else {
                let (first, rest) = self.stepper.k.split_at_mut(1);
                std::mem::swap(&mut first[0], &mut rest[11]);
                self.stepper.seen[0] = self.stepper.seen[12];
            }
        }
        self.work.evaluations = self.stepper.evaluations;
        // A number beyond f32 counts as not finite, as in the other engines.
        self.y[..size].iter().all(|value| (*value as f32).is_finite())
    }

    /// Computes the rates at `theta`, and records the indentation there.
    fn begin(&mut self, theta: f64, meter: Option<&mut Meter>) {
        let size = self.system.size();
        self.stepper.begin(&mut self.system, theta, &self.y[..size]);
        if let Some(meter) = meter {
            meter.touched |= self.system.branch.touching;
            let (system, y) = (&self.system, &self.y);
            let rate = || system.indentation_of(theta, y).1;
            meter.see(system, self.stepper.seen[0], rate, system.memory_of(y));
        }
    }

    /// Changes the contact here.
    fn switch(&mut self, theta: f64, mut meter: Option<&mut Meter>) {
        self.work.events += 1;
        let delta = self.system.indentation_of(theta, &self.y).0;
        let before = self.system.past();
        if let Some((_, branch)) = self.system.change(delta) {
            self.system.branch = branch;
        }
        if let Some(meter) = meter.as_deref_mut() {
            // A viscous contact is counted by its force.
            let counts = self.system.past() && !before && !self.system.force.viscous;
            meter.sums.begun += f64::from(u8::from(counts));
        }
        self.h = FIRST_STEP_PHASE.min(self.longest);
        self.before = 1e-4;
        self.begin(theta, meter);
    }

    /// Sets the allowed errors of a step: `tolerance` times the largest travel, force and energy so far.
    fn allow(&mut self) {
        let n = self.system.modes();
        let unit = self.tolerance * self.length;
        for k in 0..n {
            self.allowed[k] = unit;
            self.allowed[n + k] = unit * self.system.pace(k);
        }
        let (force, integrals) = (self.tolerance * self.force, self.system.remembered());
        self.allowed[2 * n..integrals].fill(unit);
        self.allowed[integrals..integrals + 3].copy_from_slice(&[
            force,
            force * self.length,
            force * self.length,
        ]);
    }

    /// Tries steps from `h` down until one is accepted; `None` if the state is not finite.
    fn accepted(&mut self, theta: f64, mut h: f64, cut: bool) -> Option<f64> {
        let size = self.system.size();
        let mut cut = cut;
        loop {
            self.stepper.step(&mut self.system, theta, &self.y[..size], h);
            let error = self.stepper.error(&self.allowed[..size], h);
            if error <= 1.0 || (h <= MIN_STEP_PHASE && error.is_finite()) {
                let growth = 0.9 * error.max(1e-12).powf(-PI_ALPHA) * self.before.powf(PI_BETA);
                let next = h * growth.clamp(0.3, 6.0);
                self.work.accepted += 1;
                self.before = error.max(1e-4);
                // A shortened step says little about the next one.
                self.h = if cut { self.h.max(next) } else { next };
                return Some(h);
            }
            self.work.rejected += 1;
            if h <= MIN_STEP_PHASE {
                return None;
            }
            let shrink = if error.is_finite() { (0.9 * error.powf(-0.125)).clamp(0.1, 0.8) } else { 0.1 };
            h = (h * shrink).max(MIN_STEP_PHASE);
            self.h = h;
            cut = false;
        }
    }

    /// Distance of the indentation from the change of contact, positive before it, m.
    fn room(&self, delta: f64) -> Option<f64> {
        self.system.change(delta).map(|(room, _)| room)
    }

    /// The course of the last step. Nothing is searched for if its stages are far from any change.
    fn course(&mut self, theta: f64, h: f64, measuring: bool) -> StepCourse {
        let mut course = StepCourse { turns: Vec::new(), crossing: None };
        let seen = self.stepper.seen;
        let (least, most) =
            seen.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), d| (a.min(*d), b.max(*d)));
        let spread = most - least;
        let near = match (self.room(least), self.room(most)) {
            (Some(a), Some(b)) => a.min(b) <= spread,
            _ => false,
        };
        if !(near || measuring) {
            return course;
        }
        let piece = self.piece(theta, h);
        let at = |u: f64| piece.indentation(&self.system, u);
        let mut before = (0.0, at(0.0).1);
        for index in 1..=EVENT_PIECES {
            let u = index as f64 / EVENT_PIECES as f64;
            let (delta, rate) = at(u);
            if before.1 * rate < 0.0 {
                let turn = root(before.0, u, |u| at(u).1);
                self.look(&piece, turn, at(turn).0, &mut course);
                course.turns.push(turn);
            }
            self.look(&piece, u, delta, &mut course);
            if course.crossing.is_some() {
                break;
            }
            before = (u, rate);
        }
        course
    }

    /// Records the crossing if the indentation is past the change at `u`, the first such place of the step.
    fn look(&self, piece: &DenseStep, u: f64, delta: f64, course: &mut StepCourse) {
        let Some(room) = self.room(delta) else { return };
        if room >= 0.0 || course.crossing.is_some() {
            return;
        }
        let from = course
            .turns
            .last()
            .copied()
            .unwrap_or(0.0)
            .max(((u * EVENT_PIECES as f64).ceil() - 1.0) / EVENT_PIECES as f64);
        let beyond = |u: f64| self.room(piece.indentation(&self.system, u).0).unwrap_or(f64::INFINITY);
        course.crossing = Some(if beyond(from) <= 0.0 { from } else { root(from, u, beyond) });
    }

    /// The continuous extension of the last step.
    fn piece(&mut self, theta: f64, h: f64) -> DenseStep {
        let (n, size) = (self.system.modes(), self.system.size());
        self.stepper.extend(&mut self.system, theta, &self.y[..size], h);
        let travel = self.stepper.dense(&self.y, 0..n, h);
        let rate = self.stepper.dense(&self.y, n..2 * n, h);
        let memory = self
            .system
            .force
            .remembers
            .then(|| [0, 1].map(|m| self.stepper.dense(&self.y, 2 * n + m..2 * n + m + 1, h)));
        DenseStep { theta, h, travel, rate, memory }
    }

    /// Makes the step end at the change of contact, by Newton's method on its length from the continuous extension's estimate.
    /// The event is then as accurate as the step, not only as its extension.
    fn land(&mut self, theta: f64, guess: f64, longest: f64) -> f64 {
        let size = self.system.size();
        let mut h = guess;
        let mut last = f64::INFINITY;
        for round in 0..6 {
            if h <= 0.0 {
                return 0.0;
            }
            self.stepper.step(&mut self.system, theta, &self.y[..size], h);
            let (delta, rate) = self.system.indentation_of(theta + h, &self.stepper.end);
            let Some((room, branch)) = self.system.change(delta) else { return h };
            // Inward the branch behind has one more of contact and what remembers.
            let slope = if branch > self.system.branch { -rate } else { rate };
            let shift = -room / slope;
            // Newton's method fails close to a graze, where the extension's estimate stays.
            if !(shift.abs() < last && shift.abs() > 1e-16 + 2.0 * f64::EPSILON * h) {
                break;
            }
            let next = h + shift;
            if round == 5 || !(next > 0.0 && next <= 1.01 * longest) || shift.abs() > 0.01 * longest {
                break;
            }
            (h, last) = (next, shift.abs());
        }
        h
    }

    fn measure(&mut self, theta: f64, h: f64, meter: &mut Meter, mut course: StepCourse, crossed: bool) {
        let end = self.stepper.seen[12];
        // A step that was repeated up to a crossing has an extension of its own.
        let piece = self.piece(theta, h);
        if crossed {
            course.turns.clear();
            let at = |u: f64| piece.indentation(&self.system, u).1;
            for index in 0..EVENT_PIECES {
                let [from, to] = [index, index + 1].map(|i| i as f64 / EVENT_PIECES as f64);
                if at(from) * at(to) < 0.0 {
                    course.turns.push(root(from, to, at));
                }
            }
        }
        let first = self.stepper.seen[0];
        meter.pass(&self.system, &piece, &course.turns, first, end);
    }

    /// Raises the scales to the values met.
    fn grow(&mut self, theta: f64) {
        let n = self.system.modes();
        let travel: f64 = self.y[..n].iter().sum();
        let rate = || self.system.indentation_of(theta, &self.y).1 * self.system.omega;
        let force = self.system.force.at(
            self.stepper.seen[12],
            rate,
            self.system.memory_of(&self.y),
            self.system.branch,
        );
        self.length = self.length.max(travel.abs());
        self.force = self.force.max(force.abs());
    }
}

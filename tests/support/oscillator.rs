//! Modal oscillators tapping on a sample, with every kink and jump located and the integration
//! restarted there.
//!
//! `x_k'' + (w_k/Q_k) x_k' + w_k^2 x_k = b_k f + g_k sin(w t)`, tip travel `z = sum c_k x_k + base sin(w t)`,
//! indentation `delta = -(gap + z)`. The variable of integration is the drive's phase `w t`, counted
//! afresh in each period, so that it loses no digits in long runs.

use super::extrapolation::{ESTIMATE_ORDER, Extrapolation, locate};
use super::laws::Law;
use super::measure::Meter;
pub use super::measure::{Options, Outcome};
use std::f64::consts::{FRAC_PI_2, TAU};

#[derive(Clone, Copy, Debug)]
pub struct Mode {
    /// rad/s
    pub omega: f64,
    /// May be infinite.
    pub quality: f64,
    /// Tip travel per coordinate.
    pub c: f64,
    /// Modal force per tip force.
    pub b: f64,
    /// Amplitude of the modal drive.
    pub g: f64,
}

#[derive(Clone, Debug)]
pub struct System {
    pub modes: Vec<Mode>,
    /// rad/s
    pub drive: f64,
    /// m
    pub base: f64,
    /// m
    pub gap: f64,
    pub law: Law,
}

/// Where the system is. `x` holds each mode's coordinate and its rate per radian of drive phase.
#[derive(Clone, Debug)]
pub struct State {
    /// Drive phase, rad.
    pub phase: f64,
    pub x: Vec<f64>,
    pub touch: bool,
    /// Whether a force that remembers acts.
    pub acts: bool,
    step: f64,
    /// Largest tip travel (or rate per radian) so far: what tolerances refer to.
    scale: f64,
}

/// What a mode's acceleration consists of, per radian of the drive's phase.
struct ModeRates {
    travel: f64,
    force: f64,
    push: f64,
    damping: f64,
    square: f64,
}

/// The equation of motion, with what stays the same worked out.
struct Equation<'a> {
    system: &'a System,
    fold: f64,
    modes: Vec<ModeRates>,
}

impl Equation<'_> {
    /// Rates per radian: the modes', then the integrals of the measured quantities.
    fn rates(&self, phase: f64, y: &[f64], touch: bool, harmonics: Option<usize>, out: &mut [f64]) {
        let n = 2 * self.modes.len();
        let system = self.system;
        let (push, cosine) = phase.sin_cos();
        let (mut z, mut rate) = (system.base * push, system.base * cosine);
        // Indices, not chunks side by side: without link-time optimization each step of those is a call.
        for (k, mode) in self.modes.iter().enumerate() {
            z += mode.travel * y[2 * k];
            rate += mode.travel * y[2 * k + 1];
        }
        let force = system.law.force_from(self.fold, -(system.gap + z), touch);
        for (k, mode) in self.modes.iter().enumerate() {
            let (x, v) = (y[2 * k], y[2 * k + 1]);
            out[2 * k] = v;
            out[2 * k + 1] = mode.force * force + mode.push * push - mode.damping * v - mode.square * x;
        }
        if let Some(harmonics) = harmonics {
            out[n..n + 4].copy_from_slice(&[z, force, force * z, -force * rate]);
            for h in 0..harmonics {
                let (sine, cosine) = ((h + 1) as f64 * phase).sin_cos();
                out[n + 4 + 2 * h] = z * sine;
                out[n + 5 + 2 * h] = z * cosine;
            }
        }
    }
}

impl System {
    /// One mode of stiffness `k` (N/m) and resonance `omega` (rad/s), driven by `force` (N) on the tip.
    pub fn one_mode(k: f64, omega: f64, quality: f64, force: f64, gap: f64, law: Law) -> Self {
        let inverse_mass = omega * omega / k;
        let mode = Mode { omega, quality, c: 1.0, b: inverse_mass, g: force * inverse_mass };
        Self { modes: vec![mode], drive: omega, base: 0.0, gap, law }
    }

    /// The free steady state at drive phase `phase`.
    pub fn free_at(&self, phase: f64) -> State {
        let mut x = Vec::new();
        for mode in &self.modes {
            // response to sin: x = Im(g exp(i phase)/(w_k^2 - w^2 + i w w_k/Q))
            let (re, im) = (mode.omega.powi(2) - self.drive.powi(2), self.drive * mode.omega / mode.quality);
            let gain = if mode.g == 0.0 { 0.0 } else { mode.g / re.hypot(im) };
            let lag = im.atan2(re);
            x.extend([gain * (phase - lag).sin(), gain * (phase - lag).cos()]);
        }
        self.state(phase, x)
    }

    /// The free steady state where the tip is farthest from the sample.
    pub fn free_at_top(&self) -> State {
        let state = self.free_at(0.0);
        let (z, rate) = self.travel(0.0, &state.x);
        // z = A sin(phase - lag): at 0 it is -A sin(lag) with the rate A cos(lag)
        self.free_at((-z).atan2(rate) + FRAC_PI_2)
    }

    /// Any state; `x` holds coordinate and rate per radian of each mode.
    pub fn state(&self, phase: f64, x: Vec<f64>) -> State {
        let (z, rate) = self.travel(phase, &x);
        let free: f64 = self
            .modes
            .iter()
            .filter(|mode| mode.g != 0.0)
            .map(|mode| {
                let detune = mode.omega.powi(2) - self.drive.powi(2);
                let gain = mode.c * mode.g / detune.hypot(self.drive * mode.omega / mode.quality);
                if gain.is_finite() { gain.abs() } else { 0.0 }
            })
            .sum();
        let scale = z.abs().max(rate.abs()).max(free).max(self.base.abs()).max(1e-15);
        let delta = -(self.gap + z);
        State { phase, x, touch: delta > 0.0, acts: self.law.room(delta) < 0.0, step: 0.01, scale }
    }

    /// Tip travel and its rate per radian of drive phase.
    pub fn travel(&self, phase: f64, x: &[f64]) -> (f64, f64) {
        let mut z = self.base * phase.sin();
        let mut rate = self.base * phase.cos();
        for (mode, pair) in self.modes.iter().zip(x.chunks_exact(2)) {
            z += mode.c * pair[0];
            rate += mode.c * pair[1];
        }
        (z, rate)
    }

    /// Indentation, m.
    pub fn indentation(&self, phase: f64, x: &[f64]) -> f64 {
        -(self.gap + self.travel(phase, x).0)
    }

    fn equation(&self) -> Equation<'_> {
        let unit = 1.0 / (self.drive * self.drive);
        let modes = self.modes.iter().map(|mode| ModeRates {
            travel: mode.c,
            force: mode.b * unit,
            push: mode.g * unit,
            damping: mode.omega / mode.quality / self.drive,
            square: mode.omega * mode.omega * unit,
        });
        Equation { system: self, fold: self.law.fold(), modes: modes.collect() }
    }

    /// Goes on by `span` radians of drive phase.
    pub fn advance(&self, state: &mut State, span: f64, tolerance: f64) {
        let mut tool = Extrapolation::new(state.x.len());
        self.integrate(state, span, tolerance, &mut tool, None);
    }

    /// Settles, then measures.
    pub fn run(&self, state: &mut State, options: &Options) -> Outcome {
        let n = state.x.len();
        let mut tool = Extrapolation::new(n);
        for _ in 0..options.settle {
            self.integrate(state, TAU, options.tolerance, &mut tool, None);
        }
        let mut meter = Meter {
            harmonics: options.harmonics,
            force: (f64::INFINITY, f64::NEG_INFINITY),
            deepest: f64::NAN,
            contact: 0.0,
            contacts: 0,
        };
        let mut wide = Extrapolation::new(n + 4 + 2 * options.harmonics);
        state.x.resize(n + 4 + 2 * options.harmonics, 0.0);
        for _ in 0..options.measure {
            self.integrate(state, TAU, options.tolerance, &mut wide, Some(&mut meter));
        }
        let sums = state.x.split_off(n);
        let periods = options.measure as f64;
        let mean = |i: usize| sums[i] / (TAU * periods);
        let harmonics: Vec<(f64, f64)> = (0..options.harmonics)
            .map(|h| {
                let (sine, cosine) = (2.0 * mean(4 + 2 * h), 2.0 * mean(5 + 2 * h));
                (sine.hypot(cosine), (-cosine).atan2(sine).to_degrees().rem_euclid(360.0))
            })
            .collect();
        let (amplitude, phase) = harmonics.first().copied().unwrap_or((f64::NAN, f64::NAN));
        Outcome {
            amplitude,
            phase,
            harmonics,
            offset: mean(0),
            force_mean: mean(1),
            virial: mean(2),
            loss: sums[3] / periods,
            force_min: meter.force.0,
            force_max: meter.force.1,
            indentation_max: meter.deepest,
            contact_share: meter.contact / (TAU * periods),
            contacts: meter.contacts as f64 / periods,
            evaluations: tool.evaluations + wide.evaluations,
        }
    }

    fn integrate(
        &self,
        state: &mut State,
        span: f64,
        tolerance: f64,
        tool: &mut Extrapolation,
        mut meter: Option<&mut Meter>,
    ) {
        let harmonics = meter.as_ref().map(|meter| meter.harmonics);
        let mut system = System { law: self.law.acting(state.acts), ..self.clone() };
        let start = state.phase;
        let (mut end, mut error) = (state.x.clone(), state.x.clone());
        let mut gone = 0.0;
        let mut rises = system.rising(start, state, tool);
        if let Some(meter) = &mut meter {
            meter.see(&system, state);
        }
        while gone < span {
            let equation = system.equation();
            let touch = state.touch;
            let phase = start + gone;
            let x = std::mem::take(&mut state.x);
            let mut go = |h: f64, end: &mut [f64], error: &mut [f64]| {
                let mut rhs =
                    |t: f64, y: &[f64], out: &mut [f64]| equation.rates(t, y, touch, harmonics, out);
                tool.step(&mut rhs, (phase, &x), h, end, error);
            };
            // the measured integrals are not under error control: short steps for the highest harmonic
            let most = harmonics.map_or(f64::INFINITY, |n| 1.5 / n.max(2) as f64);
            state.step = state.step.min(most);
            let last = state.step >= span - gone;
            let mut h = if last { span - gone } else { state.step };
            let mut refused = false;
            let factor = loop {
                go(h, &mut end, &mut error);
                let size = self.error(&error, tolerance * state.scale);
                assert!(size.is_finite() || h > 1e-15, "the step vanishes at phase {phase} of {self:?}");
                let factor = (0.8 * size.powf(-1.0 / f64::from(ESTIMATE_ORDER + 1))).clamp(0.1, 3.0);
                // next to a fold rounding alone may exceed a tolerance on so short a step
                if size <= 1.0 || h < 1e-13 {
                    break factor;
                }
                refused = true;
                h *= factor.min(0.7);
            };
            // a step cut short by the span's end says little about the next one
            state.step = if last && !refused { state.step.max(h * factor) } else { h * factor };
            // Turning point first: between turning points the indentation is monotonic, so that its
            // crossings show in its ends.
            let rate = |h: f64, end: &[f64]| self.travel(phase + h, end).1;
            let turned = (rate(h, &end) > 0.0) != rises && rate(h, &end) != 0.0;
            if turned {
                h = locate(h, |h| {
                    go(h, &mut end, &mut error);
                    rate(h, &end) * if rises { 1.0 } else { -1.0 }
                });
            }
            let level = if touch { self.law.release() } else { 0.0 };
            let side = if touch { 1.0 } else { -1.0 };
            let contact = |h: f64, end: &[f64]| side * (system.indentation(phase + h, end) - level);
            let neck = |h: f64, end: &[f64]| system.law.room(system.indentation(phase + h, end));
            let beyond = |h: f64, end: &[f64]| contact(h, end).min(neck(h, end));
            let crossed = beyond(h, &end) < 0.0;
            if crossed {
                h = locate(h, |h| {
                    go(h, &mut end, &mut error);
                    beyond(h, &end)
                });
            }
            if let Some(meter) = &mut meter {
                meter.pass(&system, (phase, &x), (phase + h, &end), touch, h);
            }
            // A neck may form at touch: both change at once.
            let (room, way) = (neck(h, &end), contact(h, &end));
            let [changes, touches] = [crossed && room <= way, crossed && way <= room];
            state.x = x;
            state.x.copy_from_slice(&end);
            gone = if h == span - gone { span } else { gone + h };
            state.phase = start + gone;
            let (z, speed) = self.travel(state.phase, &state.x);
            state.scale = state.scale.max(z.abs()).max(speed.abs());
            if crossed {
                state.touch ^= touches;
                state.acts ^= changes;
                system.law = system.law.acting(state.acts);
                state.step = state.step.min(1e-3);
                if let Some(meter) = &mut meter {
                    // Where a force remembers, the program counts how often it begins.
                    let begun = if system.law.remembers() { changes && state.acts } else { state.touch };
                    meter.contacts += usize::from(begun);
                    meter.see(&system, state);
                }
                // a jump of the force leaves position and speed alone; only at rest it decides the turn
                rises = if speed == 0.0 { system.rising(state.phase, state, tool) } else { speed > 0.0 };
            } else if turned {
                rises = !rises;
            }
        }
        // the drive's phase counts afresh: same sine, no digits lost
        if span == TAU {
            state.phase = start;
        }
    }

    /// Whether the tip rises, at rest by its acceleration.
    fn rising(&self, phase: f64, state: &State, tool: &mut Extrapolation) -> bool {
        let (_, speed) = self.travel(phase, &state.x);
        if speed != 0.0 {
            return speed > 0.0;
        }
        let mut out = vec![0.0; state.x.len()];
        self.equation().rates(phase, &state.x, state.touch, None, &mut out);
        tool.evaluations += 1;
        let bend: f64 = self.modes.iter().enumerate().map(|(k, mode)| mode.c * out[2 * k + 1]).sum();
        bend - self.base * phase.sin() > 0.0
    }

    /// Largest error in units of what is allowed, in terms of tip travel.
    fn error(&self, error: &[f64], allowed: f64) -> f64 {
        let mut worst: f64 = 0.0;
        for (mode, pair) in self.modes.iter().zip(error.chunks_exact(2)) {
            let faster = (mode.omega / self.drive).max(1.0);
            let size = mode.c.abs() * pair[0].abs().max(pair[1].abs() / faster) / allowed;
            // NaN must not pass for small
            worst = if size.is_nan() { f64::INFINITY } else { worst.max(size) };
        }
        worst
    }
}

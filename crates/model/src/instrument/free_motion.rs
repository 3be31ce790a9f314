//! Motion without a sample: the steady state and, from rest, the decay of what is missing from it.
//!
//! From rest the whole instrument stands still, `W = W_t = 0` for x > 0, until the drive
//! `level sin(omega t)` sets in at t = 0: each modal coordinate starts at 0, so its transient
//! starts at minus its steady value and rate. A rigid base moves at once, at the rate
//! `Y omega`, and the lever, still at rest, moves against it: the relative rates start at
//! `-Gamma_k Y omega`. Modes listed by the user make the tip start at `Y omega (1 - sum of their
//! drives)`: at rest if the first alone is driven, by 1.

use nalgebra::Complex;
use std::f64::consts::TAU;
use std::sync::Arc;

use super::instrument_error::InstrumentError;
use super::{FreeMotion, Instrument, Mode, check_positive};
use crate::scene::{DriveLevel, DriveOn};

/// Steps of a table between exact values: rounding grows by one unit a step.
const ANCHOR: usize = 32;
/// A transient is over once it has decayed by this many e-folds (to 1e-26).
const OVER: f64 = 60.0;

/// Whose travel is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MotionPlace {
    Tip,
    Top,
}

impl MotionPlace {
    fn share(self, mode: &Mode) -> f64 {
        match self {
            MotionPlace::Tip => mode.tip,
            MotionPlace::Top => mode.top,
        }
    }
}

impl Instrument {
    /// The motion without a sample under a sine drive of `level` at `frequency_hz`.
    ///
    /// [`DriveLevel::FreeAmplitude`] scales the drive so that the tip's amplitude is as asked.
    ///
    /// # Errors
    /// A level of a kind that does not drive this instrument, numbers that are not finite, an
    /// undamped mode driven exactly at its frequency, an amplitude asked of a tip at rest.
    pub fn free_motion(&self, level: DriveLevel, frequency_hz: f64) -> Result<FreeMotion, InstrumentError> {
        self.at_level(&self.unit_motion(frequency_hz)?, level)
    }

    /// The motion without a sample under a sine drive of level 1 at `frequency_hz`.
    ///
    /// # Errors
    /// A frequency that is not positive, an undamped mode driven exactly at its frequency.
    pub fn unit_motion(&self, frequency_hz: f64) -> Result<FreeMotion, InstrumentError> {
        check_positive("the drive's frequency", frequency_hz)?;
        let omega = TAU * frequency_hz;
        let unit_modes: Arc<[Complex<f64>]> = self.modal_response(omega)?.into();
        let sum = |place: MotionPlace, base: f64| {
            let moves = |(m, z): (&Mode, &Complex<f64>)| z * place.share(m);
            self.modes.iter().zip(&*unit_modes).map(moves).sum::<Complex<f64>>() + base
        };
        let base = if self.moving_base { 1.0 } else { 0.0 };
        let (tip, top) = (sum(MotionPlace::Tip, base), sum(MotionPlace::Top, base));
        let compliance = self.follows(MotionPlace::Tip, omega);
        let pushed = self.follows(MotionPlace::Top, omega);
        Ok(FreeMotion {
            omega,
            level: 1.0,
            tip,
            amplitude: tip.norm(),
            angle: tip.arg(),
            top,
            // Nothing divided by nothing would be no number.
            top_per_tip: if pushed.norm() == 0.0 { pushed } else { pushed / compliance },
            bending: self.bending(),
            compliance,
            first_mode: self.first_mode(),
            unit_modes,
        })
    }

    /// The motion at another level, from `unit`, this instrument's motion of level 1 ([`Instrument::unit_motion`]).
    ///
    /// # Errors
    /// As [`Instrument::free_motion`].
    pub fn at_level(&self, unit: &FreeMotion, level: DriveLevel) -> Result<FreeMotion, InstrumentError> {
        debug_assert_eq!(unit.level, 1.0);
        let level = self.level(level, unit.amplitude, unit.omega / TAU)?;
        let reach = unit.amplitude.max(unit.top.norm()) * level.abs();
        if !reach.is_finite() {
            return Err(InstrumentError::OutOfRange { what: "free travel", value: reach });
        }
        let (tip, top) = (unit.tip * level, unit.top * level);
        Ok(FreeMotion { level, tip, amplitude: tip.norm(), angle: tip.arg(), top, ..unit.clone() })
    }

    /// How far a place moves under a force on the tip at `omega` (rad/s), all modes, m/N.
    pub fn follows(&self, place: MotionPlace, omega: f64) -> Complex<f64> {
        let moves = |mode: &Mode| mode.receptance(omega).0 * (place.share(mode) * mode.force);
        self.modes.iter().map(moves).sum()
    }

    /// See [`FreeMotion::first_mode`].
    fn first_mode(&self) -> (f64, f64) {
        let omega = TAU * self.lever_frequency;
        let off = |mode: &&Mode| (mode.omega - omega).abs();
        let moves = self.modes.iter().filter(|mode| mode.inverse_mass() > 0.0);
        let nearest = moves.min_by(|a, b| off(a).total_cmp(&off(b)));
        nearest.map_or((f64::NAN, f64::NAN), |mode| {
            (mode.omega / TAU, mode.omega * mode.omega / mode.inverse_mass())
        })
    }

    /// How far a steady force on the tip moves the tip against the rod's top, m/N: one over the lever's static stiffness.
    pub fn bending(&self) -> f64 {
        let share = |mode: &Mode| (mode.tip - mode.top) * mode.force / (mode.omega * mode.omega);
        self.modes.iter().map(share).sum()
    }

    /// The drive's level in its own unit; `tip` is the free tip's amplitude per unit level.
    fn level(&self, level: DriveLevel, tip: f64, frequency_hz: f64) -> Result<f64, InstrumentError> {
        let (driven_by, remedy) = match (self.moving_base, self.on) {
            (true, _) => ("the motion of a rigid base", "base_amplitude or free_amplitude"),
            (false, DriveOn::Actuator) => ("the rod's voltage", "voltage or free_amplitude"),
            (false, DriveOn::Tip) => ("a force on the tip", "force or free_amplitude"),
        };
        let (given, value, fits) = match level {
            DriveLevel::Voltage(v) => ("a voltage", v, !self.moving_base && self.on == DriveOn::Actuator),
            DriveLevel::Force(f) => ("a force", f, !self.moving_base && self.on == DriveOn::Tip),
            DriveLevel::BaseAmplitude(a) => ("a base amplitude", a, self.moving_base),
            DriveLevel::FreeAmplitude(a) => ("a free amplitude", a, true),
        };
        if !fits {
            return Err(InstrumentError::WrongDrive { given, driven_by, remedy });
        }
        if !value.is_finite() {
            return Err(InstrumentError::BadValue { what: "the drive's level", value, expected: "finite" });
        }
        let DriveLevel::FreeAmplitude(asked) = level else { return Ok(value) };
        let scaled = asked / tip;
        if tip > 0.0 && scaled.is_finite() {
            Ok(scaled)
        } else {
            Err(InstrumentError::NoTipMotion { frequency_hz, asked })
        }
    }
}

impl FreeMotion {
    /// Phasor of a modal coordinate.
    pub fn mode(&self, k: usize) -> Complex<f64> {
        self.unit_modes[k] * self.level
    }

    /// Initial value and rate of a mode's free decaying part when the run starts from rest. `instrument` is the one this motion
    /// came from.
    pub fn transient(&self, instrument: &Instrument, k: usize) -> [f64; 2] {
        let z = self.mode(k);
        let kick =
            if instrument.moving_base { instrument.modes[k].drive * self.level * self.omega } else { 0.0 };
        [-z.im, kick - self.omega * z.re]
    }

    /// The tip against the rod's top, or a rigid base, where the fundamental of the tip's travel is `tip`: what a beam of
    /// light on the lever sees. What the tip does beside its free motion comes from forces on it alone, and the
    /// instrument is linear, so the top follows from the tip.
    pub fn deflection(&self, tip: Complex<f64>) -> Complex<f64> {
        tip - self.top - self.top_per_tip * (tip - self.tip)
    }

    /// By how much (Hz) the force of the sample shifts the resonance of the lever's first mode, where the fundamental of
    /// the tip's travel is `tip`: `(f/f0)^2 = 1 - 2 <f z>/(k A^2)`, f being the force's fundamental and z the tip's
    /// (Giessibl, Phys. Rev. B 56 (1997) 16010; Sader & Jarvis, Appl. Phys. Lett. 84 (2004) 1801).
    pub fn frequency_shift(&self, tip: Complex<f64>) -> f64 {
        let force = (tip - self.tip) / self.compliance;
        let virial = 0.5 * (force.re * tip.re + force.im * tip.im);
        let (frequency, stiffness) = self.first_mode;
        let share = 2.0 * virial / (stiffness * tip.norm_sqr());
        // As a quotient, so that a small shift keeps its digits.
        -frequency * share / (1.0 + (1.0 - share).sqrt())
    }

    /// Steady travel (m) and speed (m/s) of the tip at time `t` (s).
    pub fn tip_at(&self, t: f64) -> (f64, f64) {
        self.steady(self.tip, t)
    }

    /// Steady travel (m) and speed (m/s) of the rod's top, or of a rigid base, at time `t` (s).
    pub fn top_at(&self, t: f64) -> (f64, f64) {
        self.steady(self.top, t)
    }

    fn steady(&self, phasor: Complex<f64>, t: f64) -> (f64, f64) {
        let turned = phasor * Complex::from_polar(1.0, self.omega * t);
        (turned.im, self.omega * turned.re)
    }

    /// Travel and speed of the tip at `t >= 0` after a start from rest, the steady motion of all
    /// modes plus the transients of those not in `skip` (modes beyond its end are not skipped).
    ///
    /// `instrument` is the one this motion came from.
    pub fn tip_from_rest(&self, instrument: &Instrument, t: f64, skip: &[bool]) -> (f64, f64) {
        add(self.tip_at(t), self.transient_at(instrument, MotionPlace::Tip, t, skip))
    }

    /// Like [`FreeMotion::tip_from_rest`] for the rod's top.
    pub fn top_from_rest(&self, instrument: &Instrument, t: f64, skip: &[bool]) -> (f64, f64) {
        add(self.top_at(t), self.transient_at(instrument, MotionPlace::Top, t, skip))
    }

    /// Travel and speed at `t` of the decaying part of a start from rest alone, without `skip`'s modes.
    pub fn transient_at(
        &self,
        instrument: &Instrument,
        place: MotionPlace,
        t: f64,
        skip: &[bool],
    ) -> (f64, f64) {
        self.parts(instrument, place, skip).fold((0.0, 0.0), |sum, (mode, share, start)| {
            let [q, rate] = turn(&mode.propagator(t), start);
            add(sum, (share * q, share * rate))
        })
    }

    /// [`FreeMotion::transient_at`] at the `count` times `(first + n) step`: `[travel, speed]` each.
    ///
    /// Each mode is carried from one time to the next by its exact propagator and taken afresh
    /// every 32 steps, which keeps the table within some 1e-14 of the transient's largest value. It is taken
    /// afresh at the same times wherever a table begins: tables that overlap have the same bits.
    pub fn transient_table(
        &self,
        instrument: &Instrument,
        place: MotionPlace,
        skip: &[bool],
        first: f64,
        step: f64,
        count: usize,
    ) -> Vec<[f64; 2]> {
        let mut table = vec![[0.0; 2]; count];
        for (mode, share, start) in self.parts(instrument, place, skip) {
            let onward = mode.propagator(step);
            let decay = mode.slowest_decay();
            let start = [share * start[0], share * start[1]];
            let mut lead = (first.ceil() as i64 - 1).rem_euclid(ANCHOR as i64) as usize;
            let mut at = 0;
            while at < count {
                let t = (first + at as f64 - lead as f64) * step;
                if decay * t > OVER {
                    break;
                }
                // Before the start a heavily damped mode grows beyond all numbers.
                let (t, since) = if t < 0.0 { ((first + at as f64) * step, 0) } else { (t, lead) };
                let mut state = turn(&mode.propagator(t), start);
                if !state.iter().all(|value| value.is_finite()) {
                    state = start;
                }
                (0..since).for_each(|_| state = turn(&onward, state));
                let end = count.min(at + ANCHOR - lead);
                for row in &mut table[at..end] {
                    row[0] += state[0];
                    row[1] += state[1];
                    state = turn(&onward, state);
                }
                (at, lead) = (end, 0);
            }
        }
        table
    }

    /// The modes that have a transient at `place`, with their share there and their start.
    fn parts<'a>(
        &'a self,
        instrument: &'a Instrument,
        place: MotionPlace,
        skip: &'a [bool],
    ) -> impl Iterator<Item = (&'a Mode, f64, [f64; 2])> {
        instrument.modes.iter().enumerate().filter_map(move |(k, mode)| {
            let (share, start) = (place.share(mode), self.transient(instrument, k));
            let skipped = skip.get(k).copied().unwrap_or(false);
            (!skipped && share != 0.0 && start != [0.0, 0.0]).then_some((mode, share, start))
        })
    }
}

impl Mode {
    /// Carries `[q, q']` of the free mode over `t`: exact, whatever the damping.
    pub fn propagator(&self, t: f64) -> [[f64; 2]; 2] {
        let half = 0.5 * self.inverse_q();
        let gamma = self.omega * half;
        // Decay times cosine and sine over frequency; hyperbolic beyond Q = 1/2.
        let (c, s) = if half < 1.0 {
            let turning = self.omega * (1.0 - half * half).sqrt();
            let decay = (-gamma * t).exp();
            (decay * (turning * t).cos(), decay * (turning * t).sin() / turning)
        } else {
            let split = self.omega * (half * half - 1.0).sqrt();
            if (split * t).abs() < 1.0 {
                let decay = (-gamma * t).exp();
                let over = if split > 0.0 { (split * t).sinh() / split } else { t };
                (decay * (split * t).cosh(), decay * over)
            } else {
                let slow = (-self.slowest_decay() * t).exp();
                let fast = (-(gamma + split) * t).exp();
                (0.5 * (slow + fast), 0.5 * (slow - fast) / split)
            }
        };
        [[c + gamma * s, s], [-self.omega * self.omega * s, c - gamma * s]]
    }

    /// Rate (1/s) at which the slower part of the free motion decays.
    fn slowest_decay(&self) -> f64 {
        let half = 0.5 * self.inverse_q();
        if half <= 1.0 { self.omega * half } else { self.omega / (half + (half * half - 1.0).sqrt()) }
    }
}

fn turn(m: &[[f64; 2]; 2], v: [f64; 2]) -> [f64; 2] {
    [m[0][0] * v[0] + m[0][1] * v[1], m[1][0] * v[0] + m[1][1] * v[1]]
}

fn add(a: (f64, f64), b: (f64, f64)) -> (f64, f64) {
    (a.0 + b.0, a.1 + b.1)
}

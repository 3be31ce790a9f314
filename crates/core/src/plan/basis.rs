//! Which modes the tip force needs.
//!
//! A mode matters to the stepped motion only if the tip force moves the tip by it: c_k b_k / omega_k^2 is its share of the
//! tip's static flexibility. The modes that are left out act, at frequencies below their own, as one more spring. It is kept
//! as one residual oscillator with that flexibility (a residual attachment mode in the sense of MacNeal 1971 and Rubin 1975).
//! Its frequency is that of the mode with the largest part of it, so that it rings as that one does. With the inertia of all
//! of them it would ring too fast, which shows in the largest force of short contacts (tests/hard/rod_damped.toml).
//!
//! What no oscillator has by then is mostly that of a rod's many slow modes, a share of 1e-5 or so each. Contacts are too short
//! for them, but the mean force bends them. If that matters, one static oscillator, far slower than the drive, has their
//! flexibility, so that the static response to a contact force is exact.
//!
//! This does not suffice where a contact is very short, as a soft lever's on a stiff sample. The rate of the contact then
//! chooses the oscillators: the modes that ring on between contacts, and for the rest a rational Krylov reduction of what the
//! tip feels of it (`compliance.rs`).

use super::BasisRule;
use super::compliance::{MAX_RATE_RATIO, compliance, reduced};
use super::oscillator::KeptMode;
use super::resonant_modes::{LOW_HARMONIC, Resonance, resonances};
use super::ringing::{
    LONG_RING_SHARE, LeverModes, MAX_LEVER_MODE_RATIO, MIN_REDUCED_OSCILLATORS, left, ringing,
};
use crate::instrument::{Instrument, Mode};
use crate::kernel::{FAST_ANGLE, FlowMode, MODES_MAX, WRITTEN_OUT, own_answer};
use nalgebra::Complex;

/// Bases of more modes than for this share of the requested accuracy are not tried; the contact's rate chooses oscillators
/// instead.
pub(crate) const RICHEST_ACCURACY_SHARE: f64 = 0.1;

/// Allowed error of the compliance at the contact's rate, as a share of the accuracy; the bound is wider beyond that rate, see
/// [`ReducedBasis::wrong`]. Below the accuracy `COARSE_ACCURACY` the share falls with the accuracy's square root: without that
/// one in a hundred of 450 random levers on Hertzian samples, asked for 1e-4, had a largest force that was 1e-4 to 3e-4 off.
const COMPLIANCE_TOL_SHARE: f64 = 0.75;
const COARSE_ACCURACY: f64 = 1e-3;

/// Oscillators for an accuracy of 1e-3: per mode slower than the contact, and more; exponent of growth with the accuracy. From
/// the largest force of levers of 0.05 and 0.5 N/m on stiff samples (`cargo bench --bench accuracy -- --part basis`).
const OSCILLATORS_PER_MODE: f64 = 1.3;
const OSCILLATORS_BESIDE: f64 = 4.0;
const OSCILLATOR_GROWTH: f64 = 0.12;

/// A contact's basis has a static oscillator if the others lack more than this share of the flexibility.
const MIN_STATIC_SHARE: f64 = 1e-6;

/// A contact's basis takes no more of the modes that waited than so many, those that answer most.
const MAX_JOINING_MODES: usize = 6;

/// Modes faster than the contact by more than this are not kept as they are.
const MAX_MODE_RATE_RATIO: f64 = 64.0;

/// The oscillators that replace an instrument under a force on its tip, largest share of the flexibility first.
#[derive(Clone, Debug, PartialEq)]
pub struct ReducedBasis {
    pub modes: Vec<KeptMode>,
    /// The tip's static flexibility, all modes, m/N.
    pub flexibility: f64,
    /// The share of it that no kept oscillator has.
    pub residual_share: f64,
    /// Travel of the tip per force at the drive's frequency that the oscillators lack, m/N.
    pub missed_response: Complex<f64>,
    /// Whether one residual oscillator replaces the faster modes.
    pub residual_kept: bool,
    /// Faint modes that a harmonic of the force moves: they wait until the measured force tells that they matter.
    pub waiting: Vec<Resonance>,
    /// The rule that chose them.
    pub rule: BasisRule,
    /// The reason for the choice, in words.
    pub reason: String,
}

/// What modes are chosen for.
#[derive(Clone, Copy, Debug)]
pub struct ModeDemand {
    /// Accuracy of this basis, and that of the run.
    pub accuracy: f64,
    pub asked: f64,
    /// Whether it has the faint resonant modes, those whose share no basis on trial has.
    pub resonant: bool,
    /// Whether the run may ask for more modes later.
    pub refined: bool,
}

/// Most steps per period the rule gives; a scene may ask for more.
pub const STEPS_MAX: u32 = 65_536;
/// Largest phase, rad, that a kept oscillator may turn through in one step.
pub(super) const ANGLE_MAX: f64 = 1.2;

/// The fastest oscillator (rad/s) that so many steps a period of a drive of angular frequency `omega` can step.
fn fastest_stepped(omega: f64, steps: f64) -> f64 {
    omega * steps * ANGLE_MAX / std::f64::consts::TAU
}

/// Describes a basis for contacts of the rate `rate` (rad/s): the number of exact modes and that of the oscillators made.
fn reduction_reason(exact: usize, made: usize, rate: f64) -> String {
    let plural = if exact == 1 { "" } else { "s" };
    let megahertz = rate / std::f64::consts::TAU / 1e6;
    format!("{exact} mode{plural} and {made} oscillators for contacts of {megahertz:.4} MHz")
}

impl ReducedBasis {
    /// Oscillators alone, of an instrument of this flexibility (m/N), of which they lack this share.
    fn of(
        modes: Vec<KeptMode>,
        (flexibility, residual_share): (f64, f64),
        rule: BasisRule,
        reason: String,
    ) -> Self {
        Self {
            modes,
            flexibility,
            residual_share,
            missed_response: Complex::ZERO,
            residual_kept: false,
            waiting: Vec::new(),
            rule,
            reason,
        }
    }

    /// Chooses modes for a drive of angular frequency `omega`, in order of their share, until the remainder is below three
    /// times `accuracy`. The remainder becomes a residual oscillator if it is above a tenth of `accuracy` and slow enough to
    /// be stepped with `steps_max` steps a period. Adds modes that a harmonic of the drive meets if a hard contact needs them and
    /// no trial of bases can tell: those met head-on, and the faint ones if `resonant`, which otherwise wait. `count` overrides
    /// all this: exactly so many modes, nothing for the rest.
    pub fn choose(
        instrument: &Instrument,
        omega: f64,
        ModeDemand { accuracy, asked, resonant, refined }: ModeDemand,
        count: Option<usize>,
        steps_max: f64,
    ) -> Self {
        let fastest = fastest_stepped(omega, steps_max);
        let mut kept = Self::by_share(instrument, accuracy, count, (fastest, steps_max));
        if resonant {
            kept.rule = kept.rule.with_resonant_modes();
        }
        if let Some(count) = count {
            kept.reason = format!("{count} modes, as the scene says");
            return kept.with_missed_response(instrument, omega);
        }
        let has = |basis: &Self, k: usize| basis.modes.iter().any(|mode| mode.index == Some(k));
        let mut met = resonances(&instrument.modes, omega, (asked, refined), kept.fastest());
        met.retain(|one| instrument.modes[one.mode].omega <= fastest && !has(&kept, one.mode));
        if !met.is_empty() {
            // Trials show whether modes of a larger basis are needed. But hardly any member of their sample has a mode that a
            // harmonic meets head-on.
            let richest =
                Self::by_share(instrument, RICHEST_ACCURACY_SHARE * asked, None, (fastest, steps_max));
            met.retain(|one| !has(&richest, one.mode) || one.is_head_on());
            kept.waiting.extend(met.extract_if(.., |one| !resonant && !has(&richest, one.mode)));
        }
        let met: Vec<usize> = met.iter().map(|one| one.mode).collect();
        let slow = kept.fastest();
        kept.add_residual(instrument, &met, accuracy, fastest);
        kept.add_met(instrument, &met);
        kept.add_static_of_slow(instrument, (omega, slow), accuracy);
        let frequency = |one: &Resonance| instrument.modes[one.mode].omega / std::f64::consts::TAU / 1e3;
        let waiting: Vec<String> = kept.waiting.iter().map(|one| format!("{:.4}", frequency(one))).collect();
        if !waiting.is_empty() {
            kept.note(format!(
                "harmonics of the force move faint modes at {} kHz: they join where the measured force asks for them",
                waiting.join(", ")
            ));
        }
        kept.with_missed_response(instrument, omega)
    }

    /// Modes in order of their share until the remainder is below three times `accuracy`, or `count` of them. None but the
    /// first is faster than `fastest` (rad/s), which `steps_max` steps a period can step.
    fn by_share(
        instrument: &Instrument,
        accuracy: f64,
        count: Option<usize>,
        (fastest, steps_max): (f64, f64),
    ) -> Self {
        let share = |k: usize| {
            let mode = &instrument.modes[k];
            mode.inverse_mass() / (mode.omega * mode.omega)
        };
        let flexibility: f64 = (0..instrument.modes.len()).map(share).sum();
        let mut order: Vec<usize> = (0..instrument.modes.len()).collect();
        order.sort_by(|a, b| share(*b).abs().total_cmp(&share(*a).abs()).then(a.cmp(b)));

        let mut modes = Vec::new();
        let mut left = 1.0;
        let wanted = count.unwrap_or(WRITTEN_OUT - 1).min(MODES_MAX);
        let mut reason = String::new();
        for &k in &order {
            let done = match count {
                Some(_) => false,
                None => left <= 3.0 * accuracy,
            };
            if modes.len() == wanted || done || share(k) == 0.0 {
                break;
            }
            if count.is_none() && !modes.is_empty() && instrument.modes[k].omega > fastest {
                reason = format!(
                    "mode at {:.4} kHz left out: too fast for {steps_max} steps a period",
                    instrument.modes[k].omega / std::f64::consts::TAU / 1e3
                );
                break;
            }
            left -= share(k) / flexibility;
            modes.push(KeptMode::of(instrument, k));
        }
        let rule = BasisRule::shares(accuracy);
        Self::of(modes, (flexibility, left), rule, reason)
    }

    /// The oscillators of a [`BasisRule::Contact`] under a drive of angular frequency `omega` (rad/s): exactly the modes that
    /// ring on from one contact to the next and are slow enough to be moved by one, and a reduction of the others. A rod's
    /// modes that a harmonic of the force may move wait if a run of this `accuracy` may need them, or are kept as they are. A
    /// static oscillator stands for the slow ones, which no contact moves. `None` if there are too few modes to reduce, a mode
    /// answers against the force, or the rule is another.
    pub fn for_contact(instrument: &Instrument, omega: f64, rule: BasisRule, accuracy: f64) -> Option<Self> {
        let BasisRule::Contact { rate, count, resonant, .. } = rule else { return None };
        let share = |mode: &Mode| mode.inverse_mass() / (mode.omega * mode.omega);
        let flexibility: f64 = instrument.modes.iter().map(share).sum();
        // The slowest lever mode and all above it.
        let first = (0..instrument.modes.len())
            .max_by(|a, b| share(&instrument.modes[*a]).total_cmp(&share(&instrument.modes[*b])))?;
        let rod = instrument.modes.iter().any(|mode| mode.top * mode.inverse_mass() != 0.0);
        let mut waiting = Vec::new();
        if rod {
            // The reduction has the flexibility of modes that are faster than the low harmonics.
            let fastest = (LOW_HARMONIC + 0.5) * omega;
            waiting = resonances(&instrument.modes, omega, (accuracy, true), fastest);
            waiting.sort_by(|a, b| b.compliance().norm().total_cmp(&a.compliance().norm()));
        }
        let joining = if resonant { waiting.len().min(MAX_JOINING_MODES) } else { 0 };
        let count = if rod { count.min(MODES_MAX - joining - 1) } else { count };
        let moved: Vec<usize> =
            (first..instrument.modes.len()).filter(|k| instrument.modes[*k].inverse_mass() != 0.0).collect();
        // All modes of a list; the fastest modes of a finite-element beam are too fast to be stepped.
        let fastest = moved.iter().map(|k| instrument.modes[*k].omega).fold(0.0, f64::max);
        let all = moved.len() <= count && fastest <= MAX_MODE_RATE_RATIO * rate;
        let exact = match all {
            true => moved.clone(),
            false => ringing(instrument, omega, rate, &moved, count),
        };
        waiting.retain(|one| !exact.contains(&one.mode));
        let met: Vec<usize> = waiting.iter().take(joining).map(|one| one.mode).collect();
        if resonant {
            // Those that did not join are reduced with the others.
            waiting.clear();
        }
        let mut modes: Vec<KeptMode> =
            exact.iter().chain(&met).map(|&k| KeptMode::of(instrument, k)).collect();
        if !all {
            let kept = |k: &&usize| exact.contains(*k) || met.contains(*k);
            let rest: Vec<&Mode> = moved.iter().filter(|k| !kept(k)).map(|k| &instrument.modes[*k]).collect();
            // Starts where the lever answers: a rod adds little below that.
            let levers = LeverModes::of(instrument, omega);
            let from = 0.5 * rest.iter().find(|mode| levers.own(mode)).or(rest.first())?.omega;
            modes.extend(reduced(&rest, count - exact.len(), from, rate.max(4.0 * from))?);
        }
        let left = 1.0 - modes.iter().map(KeptMode::flexibility).sum::<f64>() / flexibility;
        let reason = match all {
            true => format!("all {} modes that move the tip", exact.len()),
            false => reduction_reason(exact.len(), count - exact.len(), rate),
        };
        let mut kept = Self { waiting, ..Self::of(modes, (flexibility, left), rule, reason) };
        if rod {
            kept.add_static_of_rest(instrument, omega, MIN_STATIC_SHARE);
        }
        Some(kept.with_missed_response(instrument, omega))
    }

    /// Initial number of oscillators for an accuracy, with contacts of the rate `rate` (rad/s).
    pub fn oscillators(instrument: &Instrument, omega: f64, rate: f64, accuracy: f64) -> usize {
        let levers = LeverModes::of(instrument, omega);
        let lever = || instrument.modes.iter().filter(|mode| levers.own(mode));
        let slower = lever().filter(|mode| mode.omega <= rate).count();
        let ring = lever()
            .filter(|mode| mode.omega <= MAX_LEVER_MODE_RATIO * rate && left(mode, omega) >= LONG_RING_SHARE)
            .count();
        let rule = (OSCILLATORS_BESIDE + OSCILLATORS_PER_MODE * slower as f64)
            * (1e-3 / accuracy).powf(OSCILLATOR_GROWTH);
        (rule.ceil() as usize).max(ring + MIN_REDUCED_OSCILLATORS)
    }

    /// Whether these oscillators represent the instrument at the tip well enough for `accuracy`, with contacts of the rate
    /// `rate` (rad/s) under a drive of angular frequency `omega`. A nearly undamped mode of a rod that the contact meets again
    /// and again must be among them, whatever the compliance.
    pub fn serves(&self, instrument: &Instrument, omega: f64, rate: f64, accuracy: f64) -> bool {
        let levers = LeverModes::of(instrument, omega);
        let kept = |k: usize| self.modes.iter().any(|mode| mode.index == Some(k));
        let lingers = |mode: &Mode| mode.omega <= rate && !levers.own(mode) && levers.gathers(mode);
        // A rod's modes slower than the lever's first are no spring at the rates of a contact.
        let first = instrument.modes.iter().position(|mode| levers.own(mode)).unwrap_or(0);
        let missing =
            instrument.modes.iter().enumerate().skip(first).any(|(k, mode)| lingers(mode) && !kept(k));
        !missing
            && self.wrong(instrument, rate)
                <= COMPLIANCE_TOL_SHARE * accuracy * (accuracy / COARSE_ACCURACY).min(1.0).sqrt()
    }

    /// Largest relative error of the tip's compliance, from half the contact's rate to the end of its onset. Beyond the
    /// contact's rate the error counts less, by the square of the rate, as the force of a smooth contact falls. The force of
    /// JKR's jumps falls less, but a weight for it gained nothing (450 random levers at 1e-3).
    pub fn wrong(&self, instrument: &Instrument, rate: f64) -> f64 {
        let error = |times: f64| {
            let s = times * rate;
            let whole = compliance(instrument.modes.iter().map(|mode| (mode.omega, mode.inverse_mass())), s);
            let ours = compliance(self.modes.iter().map(|mode| (mode.omega, mode.inverse_mass)), s);
            (ours / whole - 1.0).abs() / times.max(1.0).powi(2)
        };
        [0.5, 1.0, 2.0, MAX_RATE_RATIO].into_iter().map(error).fold(0.0, f64::max)
    }

    /// Adds the resonant modes `met` that are not kept for their share.
    fn add_met(&mut self, instrument: &Instrument, met: &[usize]) {
        for &k in met.iter().take(MODES_MAX.saturating_sub(self.modes.len())) {
            let mode = KeptMode::of(instrument, k);
            self.residual_share -= mode.flexibility() / self.flexibility;
            self.note(format!(
                "the mode at {:.4} kHz too: a harmonic of the drive meets it",
                mode.omega / std::f64::consts::TAU / 1e3
            ));
            self.modes.push(mode);
        }
    }

    pub(super) fn note(&mut self, text: String) {
        if !self.reason.is_empty() {
            self.reason.push_str("; ");
        }
        self.reason.push_str(&text);
    }

    /// Acceleration of the tip per tip force at short times, 1/kg.
    pub fn inverse_mass(&self) -> f64 {
        self.modes.iter().map(|mode| mode.inverse_mass).sum()
    }

    /// The same as steps of this length (s) meet it: fast oscillators count by their mean answer to a force within a step.
    pub fn stepped_inverse_mass(&self, step: f64) -> f64 {
        match self.rule {
            BasisRule::Shares { .. } => self.inverse_mass(),
            BasisRule::Contact { .. } => self.inverse_mass() * own_answer(&self.flow(), step),
        }
    }

    /// Whether both keep modes of the same numbers, and treat the rest alike. The oscillators of levers that differ in scale
    /// then correspond, whatever their frequencies.
    pub fn copies(&self, other: &Self) -> bool {
        let residual = self.residual_kept && other.residual_kept;
        let same = |(a, b): (&KeptMode, &KeptMode)| {
            let alike = a.index.is_some() || a.is_static() || residual || a.omega == b.omega;
            alike && a.corresponds(b)
        };
        self.modes.len() == other.modes.len() && self.modes.iter().zip(&other.modes).all(same)
    }

    /// Angular frequency of the fastest oscillator, rad/s.
    pub fn fastest(&self) -> f64 {
        self.modes.iter().map(|mode| mode.omega).fold(0.0, f64::max)
    }

    /// The share of a mode's travel and rate that its numbers in a state have, at steps of this length (s).
    pub fn stored_share(&self, mode: &KeptMode, step: f64) -> f64 {
        self.flow_mode(mode).stored_share(step)
    }

    /// The oscillators in the kernel's form.
    pub fn flow(&self) -> Vec<FlowMode> {
        let inverse_mass = self.inverse_mass();
        let share = |mode: &KeptMode| mode.inverse_mass / inverse_mass;
        self.modes.iter().map(|mode| FlowMode { share: share(mode), ..self.flow_mode(mode) }).collect()
    }

    /// An oscillator in the kernel's form, but for its share. Steps may meet oscillators that were made for an elastic contact by
    /// their means; for another contact those alone that the most steps cannot follow.
    fn flow_mode(&self, mode: &KeptMode) -> FlowMode {
        let fast_angle = match self.rule {
            BasisRule::Shares { .. } => f64::INFINITY,
            BasisRule::Contact { elastic: true, .. } => FAST_ANGLE,
            BasisRule::Contact { elastic: false, .. } => 2.0 * FAST_ANGLE,
        };
        FlowMode { omega: mode.omega, damping: mode.damping, share: 1.0, fast_angle }
    }
}

//! Modes that a harmonic of the tip force moves although their share of the tip's flexibility is small.
//!
//! A rod's modes have a share of 1e-5 or so of the tip's flexibility, too little to be kept for that. But if a harmonic of the
//! drive meets one, the contacts excite it in every period. Except at the top of its resonance, a lever of high quality factor
//! shows the loss in its phase, which hardly anything else determines. Two runs that both lack the mode do not show it.
//!
//! The first harmonics of the force are its largest and move such modes in phase, too.

use crate::instrument::Mode;
use nalgebra::Complex;

/// A hard contact needs a mode if its loss under a harmonic of the tip force, as a share of the tip's flexibility and times the
/// quality factor of the driven mode, exceeds this many accuracies: 0.1 at an accuracy of 1e-3. `tests/hard/rod_met.toml`, asked
/// for that, has modes with losses of 0.84 and 0.25: without both its phase is off by 2.5e-3, without the second by 6e-4.
const MIN_LOSS_RATIO: f64 = 100.0;

/// Most contacts last a tenth of a period or more: beyond this harmonic their force falls by the square of the harmonic's
/// number. A shorter one may lose more by such a mode than is told here.
const SMOOTH_HARMONIC: f64 = 10.0;

/// A mode also matters if a low harmonic of the force moves it by more than this share of the accuracy, relative to the travel
/// of the whole tip under the fundamental. The gap of a set-point may amplify that a hundredfold, so a mode waits for less than
/// it is kept for where nothing can make it join later, and there only for the fundamental.
const MIN_WAITING_TRAVEL: f64 = 0.01;
const MIN_KEPT_TRAVEL: f64 = 0.5;

/// A contact that lasts has a force of so many harmonics. Next to a resonance of the pressed lever one of them may move a mode
/// far: at twice 154.8 kHz a rod's mode of a share of 7e-6 changed the largest force by 7e-3.
pub(super) const LOW_HARMONIC: f64 = 3.0;

/// A harmonic meets a mode head-on if the mode's out-of-phase response is this many times its static one. Few of many
/// frequencies or levers are so, and no trial on a sample of them shows it.
const HEAD_ON_RESPONSE: f64 = 10.0;

/// A mode under the nearest harmonic of the tip force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Resonance {
    /// Index among the instrument's modes.
    pub mode: usize,
    pub harmonic: f64,
    /// Its tip flexibility, m/N, and its response over the static one.
    flexibility: f64,
    response: Complex<f64>,
}

impl Resonance {
    /// The mode of this number under the nearest harmonic of a drive of angular frequency `omega`.
    fn of(number: usize, mode: &Mode, omega: f64) -> Self {
        Self::under((mode.omega / omega).round().max(1.0), number, mode, omega)
    }

    /// The same under the fundamental.
    pub(super) fn at_drive(number: usize, mode: &Mode, omega: f64) -> Self {
        Self::under(1.0, number, mode, omega)
    }

    fn under(harmonic: f64, number: usize, mode: &Mode, omega: f64) -> Self {
        let response = response(mode, harmonic * omega);
        Self { mode: number, harmonic, flexibility: flexibility(mode), response }
    }

    /// Whether the harmonic meets the mode head-on.
    pub(super) fn is_head_on(&self) -> bool {
        -self.response.im > HEAD_ON_RESPONSE
    }

    /// Whether the harmonic is among the first, which a contact that lasts has, too.
    fn is_low(&self) -> bool {
        self.harmonic <= LOW_HARMONIC
    }

    /// Tip displacement per force of this harmonic, m/N; the imaginary part is negative and loses energy.
    pub fn compliance(&self) -> Complex<f64> {
        self.flexibility * self.response
    }

    /// The mode's loss under a contact that lasts a tenth of a period: its compliance out of phase, m/N.
    fn lossy_compliance(&self) -> f64 {
        -self.compliance().im * (SMOOTH_HARMONIC / self.harmonic).min(1.0).powi(4)
    }
}

/// Response of a mode to a force of angular frequency `omega`, over the static one.
fn response(mode: &Mode, omega: f64) -> Complex<f64> {
    let ratio = omega / mode.omega;
    Complex::new(1.0 - ratio * ratio, ratio / mode.quality_factor).inv()
}

/// The tip's flexibility by one mode, m/N.
fn flexibility(mode: &Mode) -> f64 {
    (mode.inverse_mass() / mode.omega.powi(2)).abs()
}

/// The modes that a drive of angular frequency `omega` (rad/s) may excite so much that `accuracy` needs them, the largest loss
/// first. They may wait for the measured force if the run is `refined`. A residual oscillator stands for modes faster than
/// `fastest` (rad/s): they count for their loss alone.
pub(super) fn resonances(
    modes: &[Mode],
    omega: f64,
    (accuracy, refined): (f64, bool),
    fastest: f64,
) -> Vec<Resonance> {
    let swing = |mode: &Mode| flexibility(mode) * response(mode, omega).norm();
    let driven = modes.iter().max_by(|a, b| swing(a).total_cmp(&swing(b)));
    let quality = driven.map_or(0.0, |mode| mode.quality_factor);
    let least = MIN_LOSS_RATIO * accuracy * modes.iter().map(flexibility).sum::<f64>() / quality;
    let all = || modes.iter().enumerate();
    let whole: Complex<f64> = all().map(|(k, mode)| Resonance::at_drive(k, mode, omega).compliance()).sum();
    let share = if refined { MIN_WAITING_TRAVEL } else { MIN_KEPT_TRAVEL };
    let swinging = share * accuracy * whole.norm();
    let moved = |(k, mode): (usize, &Mode)| {
        let nearest = Resonance::of(k, mode, omega);
        let first = Resonance::at_drive(k, mode, omega);
        let swings = |one: &Resonance| mode.omega < fastest && one.compliance().norm() > swinging;
        let met = nearest.lossy_compliance() > least || refined && nearest.is_low() && swings(&nearest);
        if met { Some(nearest) } else { Some(first).filter(swings) }
    };
    let mut met: Vec<Resonance> = all().filter_map(moved).collect();
    met.sort_by(|a, b| b.lossy_compliance().total_cmp(&a.lossy_compliance()).then(a.mode.cmp(&b.mode)));
    met
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mode(share: f64, frequency: f64, quality_factor: f64) -> Mode {
        let omega = std::f64::consts::TAU * frequency;
        Mode {
            omega,
            quality_factor,
            tip: share.sqrt() * omega,
            force: share.sqrt() * omega,
            drive: 1.0,
            top: 0.0,
        }
    }

    /// A lever driven at its resonance, 1 Hz, and one more mode of a share of 1e-5 and a quality factor of 100.
    fn with_mode_at(frequency: f64, quality_factor: f64) -> [Mode; 2] {
        [mode(1.0 - 1e-5, 1.0, quality_factor), mode(1e-5, frequency, 100.0)]
    }

    #[test]
    fn a_mode_at_resonance_loses_its_share_times_its_quality_factor() {
        let lost = Resonance::of(0, &mode(1e-5, 6.0, 100.0), std::f64::consts::TAU).lossy_compliance();
        assert!((lost / 1e-3 - 1.0).abs() < 1e-12, "{lost}");
    }

    /// A lever off resonance, 100.3 kHz, whose third mode is at 16.964 times that: with this mode merged into a residual
    /// oscillator its largest force was 4.7 % off, which no sample of 150 such levers showed.
    #[test]
    fn a_mode_within_a_few_widths_of_a_harmonic_is_met_head_on() {
        let omega = std::f64::consts::TAU;
        let met = |frequency| Resonance::of(0, &mode(3e-3, frequency, 1100.0), omega).is_head_on();
        assert!(met(16.964) && met(17.0));
        assert!(!met(16.9) && !met(6.27));
    }

    #[test]
    fn what_a_harmonic_meets_is_kept_where_the_lever_rings_long() {
        let omega = std::f64::consts::TAU;
        let met = |frequency, quality| -> Vec<usize> {
            let all = resonances(&with_mode_at(frequency, quality), omega, (1e-3, true), 0.0);
            all.iter().map(|one| one.mode).collect()
        };
        assert_eq!(met(6.0, 2000.0), [0, 1]);
        assert_eq!(met(6.5, 2000.0), [0]);
        assert_eq!(met(6.0, 50.0), [0]);
    }
}

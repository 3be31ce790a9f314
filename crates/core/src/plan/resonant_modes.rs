//! Modes resonant with a harmonic of the drive, which take energy out of every contact.
//!
//! A rod's modes have a share of 1e-5 or so of the tip's flexibility, too little to be kept for that. But if a harmonic of the
//! drive meets one, the contacts excite it in every period. Except at the top of its resonance, a lever of high quality factor
//! shows the loss in its phase, which hardly anything else determines. Two runs that both lack the mode do not show it.

use crate::instrument::Mode;

/// A mode is kept if its loss under a harmonic of the tip force, as a share of the tip's flexibility and times the quality
/// factor of the driven mode, exceeds this many accuracies. `tests/hard/rod_met.toml`, asked for 1e-3, has modes of 0.84 and
/// 0.25: without both its phase is off by 2.5e-3, without the second by 6e-4.
const MIN_LOSS_RATIO: f64 = 100.0;

/// A contact lasts a tenth of a period or more: beyond this harmonic its force falls by the square of the harmonic's number.
const SMOOTH_HARMONIC: f64 = 10.0;

/// A harmonic meets a mode head-on if the mode's out-of-phase response is this many times its static one. Few of many
/// frequencies or levers are so, and no trial on a sample of them shows it.
const HEAD_ON_ANSWER: f64 = 10.0;

/// Response of a mode to a force of angular frequency `omega`, over the static one: the part in phase, and the part that lags
/// a quarter of a period.
fn answer(mode: &Mode, omega: f64) -> (f64, f64) {
    let ratio = omega / mode.omega;
    let (stiff, lossy) = (1.0 - ratio * ratio, ratio / mode.quality_factor);
    let size = stiff * stiff + lossy * lossy;
    (stiff / size, lossy / size)
}

/// The tip's flexibility by one mode, m/N.
fn flexibility(mode: &Mode) -> f64 {
    (mode.inverse_mass() / mode.omega.powi(2)).abs()
}

/// The harmonic of the drive at `omega` that is nearest to the mode.
fn nearest_harmonic(mode: &Mode, omega: f64) -> f64 {
    (mode.omega / omega).round().max(1.0)
}

/// Whether a harmonic of the drive meets the mode head-on.
pub(super) fn is_head_on(mode: &Mode, omega: f64) -> bool {
    answer(mode, nearest_harmonic(mode, omega) * omega).1 > HEAD_ON_ANSWER
}

/// Loss of the mode under the nearest harmonic of the tip force: its compliance out of phase, m/N.
fn lossy_compliance(mode: &Mode, omega: f64) -> f64 {
    let harmonic = nearest_harmonic(mode, omega);
    let (_, lags) = answer(mode, harmonic * omega);
    flexibility(mode) * lags * (SMOOTH_HARMONIC / harmonic).min(1.0).powi(4)
}

/// Indices of the modes that a drive of angular frequency `omega` (rad/s) excites so much that `accuracy` needs them, the
/// largest loss first.
pub(super) fn resonant_modes(modes: &[Mode], omega: f64, accuracy: f64) -> Vec<usize> {
    let swing = |mode: &Mode| {
        let (ahead, lags) = answer(mode, omega);
        flexibility(mode) * ahead.hypot(lags)
    };
    let driven = modes.iter().max_by(|a, b| swing(a).total_cmp(&swing(b)));
    let quality = driven.map_or(0.0, |mode| mode.quality_factor);
    let least = MIN_LOSS_RATIO * accuracy * modes.iter().map(flexibility).sum::<f64>() / quality;
    let mut met: Vec<(usize, f64)> = modes
        .iter()
        .map(|mode| lossy_compliance(mode, omega))
        .enumerate()
        .filter(|(_, lost)| *lost > least)
        .collect();
    met.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    met.into_iter().map(|(k, _)| k).collect()
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
        let lost = lossy_compliance(&mode(1e-5, 6.0, 100.0), std::f64::consts::TAU);
        assert!((lost / 1e-3 - 1.0).abs() < 1e-12, "{lost}");
    }

    /// A lever off resonance, 100.3 kHz, whose third mode is at 16.964 times that: with this mode merged into a residual
    /// oscillator its largest force was 4.7 % off, which no sample of 150 such levers showed.
    #[test]
    fn a_mode_within_a_few_widths_of_a_harmonic_is_met_head_on() {
        let omega = std::f64::consts::TAU;
        let met = |frequency| is_head_on(&mode(3e-3, frequency, 1100.0), omega);
        assert!(met(16.964) && met(17.0));
        assert!(!met(16.9) && !met(6.27));
    }

    #[test]
    fn what_a_harmonic_meets_is_kept_where_the_lever_rings_long() {
        let omega = std::f64::consts::TAU;
        let met = |frequency, quality| resonant_modes(&with_mode_at(frequency, quality), omega, 1e-3);
        assert_eq!(met(6.0, 2000.0), [0, 1]);
        assert_eq!(met(6.5, 2000.0), [0]);
        assert_eq!(met(6.0, 50.0), [0]);
    }
}

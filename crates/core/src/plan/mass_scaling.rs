//! Slower oscillators in place of those that are far faster than a contact.
//!
//! The fastest oscillators of a reduced basis ask for the most steps and hardly move. More mass at the same flexibility slows
//! them, so that a contact feels the same spring (selective mass scaling: Olovsson, Simonsson & Unosson, Int. J. Numer. Meth.
//! Engng 63, 2005, 1436).

use super::compliance::{MAX_RATE_RATIO, compliance};
use super::oscillator::KeptMode;

/// Slowing oscillators may change the compliance by this share of the accuracy at the contact's rate, and by the square of
/// `MAX_RATE_RATIO` times as much at that multiple of it. With a tenth, JKR's largest force on a lever of
/// 1 N/m is estimated five times too well (tests/all/hard_cases.rs).
const SLOWED_SHARE: f64 = 0.04;
/// Halvings in search of the lowest ceiling, to a thousandth for oscillators of a hundred times the contact's rate.
const CEILING_HALVINGS: usize = 12;

/// Slows oscillators to the lowest ceiling that `accuracy` allows for contacts of the rate `rate` (rad/s). The first `exact` are the
/// lever's own modes, which ring on, and are slowed only where nothing faster than `stepped` (rad/s) can be stepped. Returns
/// how many are slowed, and the ceiling (rad/s); `None` if none is.
pub(super) fn scale_mass(
    modes: &mut [KeptMode],
    exact: usize,
    (rate, accuracy): (f64, f64),
    stepped: f64,
) -> Option<(usize, f64)> {
    let whole = compliance(modes.iter().map(|mode| (mode.omega, mode.inverse_mass)), MAX_RATE_RATIO * rate);
    // The change is largest at the end of a contact's onset, where it counts less: see `ReducedBasis::wrong`.
    let allowed = MAX_RATE_RATIO.powi(2) * SLOWED_SHARE * accuracy * whole;
    let (own, made) = modes.split_at_mut(exact);
    let ceiling = lowest_ceiling(made, rate, allowed).min(stepped);
    let count = slow(own, stepped) + slow(made, ceiling);
    (count > 0).then_some((count, ceiling))
}

/// Slows those faster than `ceiling` (rad/s) and returns how many they are.
fn slow(modes: &mut [KeptMode], ceiling: f64) -> usize {
    let faster = modes.iter_mut().filter(|mode| mode.omega > ceiling);
    faster.map(|mode| *mode = slowed(*mode, ceiling)).count()
}

/// The oscillator with so much more mass that it is not faster than `ceiling` (rad/s).
fn slowed(mode: KeptMode, ceiling: f64) -> KeptMode {
    let omega = mode.omega.min(ceiling);
    KeptMode { omega, inverse_mass: mode.inverse_mass * (omega / mode.omega).powi(2), ..mode }
}

/// The lowest ceiling (rad/s), not below the contact's rate, that changes the compliance by `allowed` (m/N) at most at the end of
/// a contact's onset.
fn lowest_ceiling(modes: &[KeptMode], rate: f64, allowed: f64) -> f64 {
    let below = |ceiling: f64| {
        let slowed = modes.iter().map(|mode| slowed(*mode, ceiling));
        compliance(slowed.map(|mode| (mode.omega, mode.inverse_mass)), MAX_RATE_RATIO * rate)
    };
    let unchanged = below(f64::INFINITY);
    let (mut low, mut high) = (rate, modes.iter().map(|mode| mode.omega).fold(rate, f64::max));
    for _ in 0..CEILING_HALVINGS {
        let middle = (low * high).sqrt();
        match unchanged - below(middle) <= allowed {
            true => high = middle,
            false => low = middle,
        }
    }
    high
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: the compliance, at rest and at the end of the onset.
    #[test]
    fn slowed_oscillators_are_the_same_spring_to_a_contact() {
        let oscillator =
            |omega: f64| KeptMode { index: None, omega, damping: 0.1, inverse_mass: 1e12 / omega, top: 1.0 };
        let before = [2.0, 9.0, 80.0, 900.0].map(|times| oscillator(times * 1e6));
        let compliance_of =
            |modes: &[KeptMode], s| compliance(modes.iter().map(|mode| (mode.omega, mode.inverse_mass)), s);
        for accuracy in [1e-2, 1e-3, 1e-5] {
            let mut after = before;
            let (count, ceiling) = scale_mass(&mut after, 1, (1e6, accuracy), 5e8).unwrap();
            assert!(count >= 1 && ceiling < 5e8, "{count} slowed to {ceiling:.2e} rad/s");
            assert_eq!(after[0], before[0], "a mode that rings is as it was");
            assert!((compliance_of(&after, 0.0) / compliance_of(&before, 0.0) - 1.0).abs() < 1e-14);
            let change = 1.0 - compliance_of(&after, 4e6) / compliance_of(&before, 4e6);
            let allowed = 16.0 * SLOWED_SHARE * accuracy;
            assert!(change > 0.9 * allowed && change <= allowed, "{change:.2e} of {allowed:.2e}");
        }
        // What cannot be stepped is slowed whatever the accuracy.
        let mut after = before;
        assert_eq!(scale_mass(&mut after, 1, (1e6, 1e-12), 1e6), Some((4, 1e6)));
        assert_eq!(scale_mass(&mut [oscillator(1e6)], 0, (1e6, 1e-3), 5e8), None);
    }
}

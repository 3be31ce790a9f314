//! Oscillators for the flexibility that the chosen modes lack.

use super::ReducedBasis;
use super::oscillator::KeptMode;
use crate::instrument::Instrument;
use crate::kernel::MODES_MAX;
use nalgebra::Complex;

impl ReducedBasis {
    /// Adds the residual oscillator: the flexibility of all modes above the kept ones, at the frequency of the one with the
    /// largest share, which is the one that rings. Slower modes that are not kept (the rod's, each a share of 1e-4 or less)
    /// are no spring at the frequencies of a contact and stay out.
    pub(super) fn add_residual(
        &mut self,
        instrument: &Instrument,
        met: &[usize],
        accuracy: f64,
        fastest: f64,
    ) {
        let kept = self.fastest();
        let (mut spring, mut loss, mut top) = (0.0, 0.0, 0.0);
        let (mut largest, mut omega) = (0.0, f64::NAN);
        for (k, mode) in instrument.modes.iter().enumerate() {
            if mode.omega > kept && !met.contains(&k) {
                let flexibility = mode.inverse_mass() / mode.omega.powi(2);
                spring += flexibility;
                if flexibility > largest {
                    (largest, omega) = (flexibility, mode.omega);
                }
                loss += flexibility / mode.quality_factor;
                top += mode.top * mode.force / mode.omega.powi(2);
            }
        }
        let share = spring / self.flexibility;
        let negligible = share.abs() <= 0.1 * accuracy;
        if negligible || !(spring > 0.0 && omega.is_finite()) {
            self.note(format!("{} modes carry all but {:.1e}", self.modes.len(), self.residual_share));
        } else if omega > fastest {
            self.note(format!(
                "{} modes; the other {:.1e} of the flexibility is too fast to be stepped",
                self.modes.len(),
                self.residual_share
            ));
        } else {
            self.note(format!(
                "{} modes, another {:.1e} of the flexibility as one residual oscillator",
                self.modes.len(),
                share
            ));
            self.residual_kept = true;
            self.residual_share -= share;
            self.modes.push(KeptMode {
                index: None,
                omega,
                damping: 0.5 * loss / spring,
                inverse_mass: omega * omega * spring,
                top: top / spring,
            });
        }
    }

    /// Adds the static oscillator of a drive of angular frequency `omega` for the modes slower than `fastest` (rad/s) that are
    /// not kept, if their share of the flexibility is above `least`.
    pub(super) fn add_static_of_slow(
        &mut self,
        instrument: &Instrument,
        (omega, fastest): (f64, f64),
        least: f64,
    ) {
        let kept = |k: usize| self.modes.iter().any(|mode| mode.index == Some(k));
        let (mut spring, mut top) = (0.0, 0.0);
        for (k, mode) in instrument.modes.iter().enumerate() {
            if mode.omega < fastest && !kept(k) {
                spring += mode.inverse_mass() / mode.omega.powi(2);
                top += mode.top * mode.force / mode.omega.powi(2);
            }
        }
        self.add_static(omega, (spring, top), least);
    }

    /// The same for all that the oscillators lack, which no mode stands for alone.
    pub(super) fn add_static_of_rest(&mut self, instrument: &Instrument, omega: f64, least: f64) {
        let all: f64 = instrument.modes.iter().map(|mode| mode.top * mode.force / mode.omega.powi(2)).sum();
        let ours: f64 = self.modes.iter().map(|mode| mode.top * mode.flexibility()).sum();
        self.add_static(omega, (self.residual_share * self.flexibility, all - ours), least);
    }

    /// Adds a static oscillator with this flexibility of the tip, and the top's travel per force on the tip, m/N.
    fn add_static(&mut self, omega: f64, (spring, top): (f64, f64), least: f64) {
        let share = spring / self.flexibility;
        if share > least && self.modes.len() < MODES_MAX {
            self.note(format!("{share:.1e} of it as one static oscillator, for the mean force"));
            self.modes.push(KeptMode::at_rest(omega, spring, top / spring));
            self.residual_share -= share;
        }
    }

    /// Keeps what the oscillators, and the modes that wait for this, miss of the tip's response to the fundamental of the force,
    /// of angular frequency `omega`.
    pub(super) fn with_missed_response(mut self, instrument: &Instrument, omega: f64) -> Self {
        let waits = |k: usize| self.waiting.iter().any(|one| one.mode == k && one.harmonic == 1.0);
        let all = (0..instrument.modes.len()).filter(|k| !waits(*k));
        let all = all.map(|k| KeptMode::of(instrument, k).response(omega));
        let ours = self.modes.iter().map(|one| one.response(omega));
        self.missed_response = all.sum::<Complex<f64>>() - ours.sum::<Complex<f64>>();
        self
    }
}

#[cfg(test)]
mod tests {
    use crate::plan::{BasisRule, ReducedBasis};
    use crate::test_plans::plan_of;
    use nalgebra::Complex;

    /// Closed forms: the sums over all modes of the instrument.
    #[test]
    fn a_rod_answers_the_mean_force_in_full_and_knows_what_the_fundamental_lacks() {
        let text = r#"
            instrument.preset = "ha-fung-chen-2005"
            instrument.actuator.quality_factor = 50
            contact.law = "hertz"
            drive = { frequency = "150 kHz", free_amplitude = "10 nm" }
            approach.gap = "8 nm"
            run = { accuracy = 1e-4, steady = "search" }
        "#;
        let plan = plan_of(text);
        let driven = plan.driven(0);
        let (instrument, omega) = (&driven.instrument, driven.free.omega);
        let rule = BasisRule::Contact { rate: 1e8, count: 24, elastic: true, resonant: true };
        let for_contact = ReducedBasis::for_contact(instrument, omega, rule, 1e-4).expect("it is made");
        let bases = [("shares", &*driven.kept), ("contact", &for_contact)];
        for (rule, basis) in bases {
            let flexibility: f64 = basis.modes.iter().map(|mode| mode.flexibility()).sum();
            assert!((flexibility / basis.flexibility - 1.0).abs() < 1e-5, "{rule}");
            assert!(basis.modes.len() <= crate::kernel::MODES_MAX && basis.residual_share.abs() < 1e-5);
            let response = |own: f64, quality: f64, inverse_mass: f64| {
                inverse_mass / Complex::new(own * own - omega * omega, omega * own / quality)
            };
            let waits = |k: usize| basis.waiting.iter().any(|one| one.mode == k && one.harmonic == 1.0);
            let modes = instrument.modes.iter().enumerate().filter(|(k, _)| !waits(*k));
            let all: Complex<f64> =
                modes.map(|(_, one)| response(one.omega, one.quality_factor, one.inverse_mass())).sum();
            let ours: Complex<f64> =
                basis.modes.iter().map(|one| response(one.omega, 0.5 / one.damping, one.inverse_mass)).sum();
            let missed = all - ours;
            assert!((basis.missed_response - missed).norm() < 1e-9 * all.norm(), "{rule}");
            assert!(missed.norm() < 1e-4 * all.norm(), "{rule}: {:e}", missed.norm() / all.norm());
        }
        assert_eq!(driven.kept.modes.iter().filter(|mode| mode.is_static()).count(), 1);
    }
}

//! Which modes the tip force needs.
//!
//! A mode matters to the stepped motion only through the tip moving under the tip force:
//! c_k b_k / omega_k^2 is its share of the tip's static flexibility. What the kept modes leave
//! out acts, at frequencies below its own, as one more spring; it is kept as one more oscillator
//! with that flexibility (a residual attachment mode in the sense of MacNeal 1971 and Rubin 1975),
//! so that the static answer to a contact force is exact, at the frequency of the mode that
//! carries most of it, so that it rings as that one does: with the inertia of all of them it would
//! ring too fast, which the largest force of short contacts shows (tests/hard/rod_damped.toml).

use crate::instrument::Instrument;
use crate::kernel::{FlowMode, MODES_MAX};

/// One oscillator of the reduced instrument.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KeptMode {
    /// Which of the instrument's modes; none for the residual oscillator.
    pub index: Option<usize>,
    /// rad/s
    pub omega: f64,
    /// Damping ratio 1/(2Q).
    pub damping: f64,
    /// Acceleration of the tip per tip force through this mode, c_k b_k, 1/kg.
    pub mobility: f64,
    /// Travel of the rod's top per travel of the tip, in this mode under a tip force.
    pub top: f64,
}

/// The reduced instrument, largest share of the flexibility first.
#[derive(Clone, Debug, PartialEq)]
pub struct KeptModes {
    pub modes: Vec<KeptMode>,
    /// The tip's static flexibility, all modes, m/N.
    pub flexibility: f64,
    /// Share of it that no kept oscillator carries.
    pub residual_share: f64,
    /// Whether the faster modes are kept as one residual oscillator.
    pub residual_kept: bool,
    /// The accuracy that asked for them.
    pub accuracy: f64,
    /// What decided.
    pub reason: String,
}

/// Largest phase, rad, that a kept oscillator may turn through in one step.
pub(super) const ANGLE_MAX: f64 = 1.2;

impl KeptModes {
    /// Chooses for a drive of angular frequency `omega`: modes in order of their share until what
    /// is left out is below three times `accuracy`, the rest as a residual oscillator where it is
    /// above a tenth of `accuracy` and slow enough to be stepped with `steps_max` steps a period.
    /// `count` overrides: exactly so many modes, nothing for the rest.
    pub fn choose(
        instrument: &Instrument,
        omega: f64,
        accuracy: f64,
        count: Option<usize>,
        steps_max: f64,
    ) -> Self {
        let share = |k: usize| {
            let mode = &instrument.modes[k];
            mode.tip * mode.force / (mode.omega * mode.omega)
        };
        let flexibility: f64 = (0..instrument.modes.len()).map(share).sum();
        let mut order: Vec<usize> = (0..instrument.modes.len()).collect();
        order.sort_by(|a, b| share(*b).abs().total_cmp(&share(*a).abs()).then(a.cmp(b)));
        let fastest = omega * steps_max * ANGLE_MAX / std::f64::consts::TAU;

        let mut modes = Vec::new();
        let mut left = 1.0;
        let wanted = count.unwrap_or(MODES_MAX - 1).min(MODES_MAX);
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
            let mode = &instrument.modes[k];
            left -= share(k) / flexibility;
            modes.push(KeptMode {
                index: Some(k),
                omega: mode.omega,
                damping: 0.5 / mode.quality_factor,
                mobility: mode.tip * mode.force,
                top: mode.top / mode.tip,
            });
        }
        let mut kept =
            Self { modes, flexibility, residual_share: left, residual_kept: false, accuracy, reason };
        if let Some(count) = count {
            kept.reason = format!("{count} modes, as the scene says");
        } else {
            kept.add_residual(instrument, accuracy, fastest);
        }
        kept
    }

    /// The residual oscillator: the flexibility of all modes above the kept ones, at the frequency of the
    /// one among them with the largest share, which is the one that rings. Slower modes that are not kept
    /// (the rod's, each a share of 1e-4 or less) are no spring at the frequencies of a contact and stay out.
    fn add_residual(&mut self, instrument: &Instrument, accuracy: f64, fastest: f64) {
        let kept = self.fastest();
        let (mut spring, mut loss, mut top) = (0.0, 0.0, 0.0);
        let (mut largest, mut omega) = (0.0, f64::NAN);
        for mode in &instrument.modes {
            if mode.omega > kept {
                let flexibility = mode.tip * mode.force / mode.omega.powi(2);
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
                mobility: omega * omega * spring,
                top: top / spring,
            });
        }
    }

    fn note(&mut self, text: String) {
        if !self.reason.is_empty() {
            self.reason.push_str("; ");
        }
        self.reason.push_str(&text);
    }

    /// Acceleration of the tip by a unit of tip force at short times, 1/kg.
    pub fn mobility(&self) -> f64 {
        self.modes.iter().map(|mode| mode.mobility).sum()
    }

    /// Angular frequency of the fastest oscillator, rad/s.
    pub fn fastest(&self) -> f64 {
        self.modes.iter().map(|mode| mode.omega).fold(0.0, f64::max)
    }

    /// As the kernel takes them.
    pub fn flow(&self) -> Vec<FlowMode> {
        let mobility = self.mobility();
        self.modes
            .iter()
            .map(|mode| FlowMode {
                omega: mode.omega,
                damping: mode.damping,
                share: mode.mobility / mobility,
            })
            .collect()
    }
}

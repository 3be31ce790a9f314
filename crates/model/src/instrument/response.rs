//! The free tip's response over frequency, and where it peaks.

use nalgebra::Complex;
use std::cell::OnceCell;

use super::instrument_error::InstrumentError;
use super::{Instrument, Mode};

/// Undamped and closer than this to a natural frequency, relative, the response is rounding.
const ON_RESONANCE: f64 = 1e-12;
/// How far from the lever's first mode a peak is looked for, as a factor of its frequency.
const REACH: f64 = 16.0;
/// How far it is looked for first.
const NEAR: f64 = 1.25;
/// Points of the coarse scan, which finds peaks that belong to no single mode.
const SCAN: usize = 256;

impl Mode {
    /// 1/Q; zero for an undamped mode.
    pub(crate) fn inverse_q(&self) -> f64 {
        1.0 / self.quality_factor
    }

    /// Receptance 1/(omega_k^2 - omega^2 + i omega omega_k/Q) and its derivative by omega.
    pub(super) fn receptance(&self, omega: f64) -> (Complex<f64>, Complex<f64>) {
        let damping = self.omega * self.inverse_q();
        // As a product, so that nothing cancels near resonance.
        let stiffness = (self.omega - omega) * (self.omega + omega);
        let h = Complex::new(1.0, 0.0) / Complex::new(stiffness, omega * damping);
        (h, h * h * Complex::new(2.0 * omega, -damping))
    }
}

impl Instrument {
    /// Phasor of each modal coordinate per unit of drive level at `omega` (rad/s).
    ///
    /// # Errors
    /// An undamped mode that is driven exactly at its own frequency.
    pub(crate) fn modal_response(&self, omega: f64) -> Result<Vec<Complex<f64>>, InstrumentError> {
        let per_level = if self.moving_base { -omega * omega } else { 1.0 };
        let mut phasors = Vec::with_capacity(self.modes.len());
        for (k, mode) in self.modes.iter().enumerate() {
            if mode.drive == 0.0 {
                phasors.push(Complex::new(0.0, 0.0));
                continue;
            }
            if mode.inverse_q() == 0.0 && (mode.omega - omega).abs() <= ON_RESONANCE * omega {
                let frequency_hz = mode.omega / std::f64::consts::TAU;
                return Err(InstrumentError::DrivenOnResonance { frequency_hz, mode: k });
            }
            phasors.push(mode.receptance(omega).0 * (mode.drive * per_level));
        }
        Ok(phasors)
    }

    /// The tip's phasor per unit of drive level and its derivative by omega.
    fn tip_response(&self, omega: f64) -> (Complex<f64>, Complex<f64>) {
        let mut sum = Complex::new(0.0, 0.0);
        let mut slope = Complex::new(0.0, 0.0);
        for mode in &self.modes {
            let (h, dh) = mode.receptance(omega);
            let share = mode.tip * mode.drive;
            if share != 0.0 {
                sum += h * share;
                slope += dh * share;
            }
        }
        if self.moving_base {
            let square = -omega * omega;
            (Complex::new(1.0, 0.0) + sum * square, slope * square - sum * (2.0 * omega))
        } else {
            (sum, slope)
        }
    }

    /// Half the derivative of |tip|^2 by omega, and |tip|^2.
    fn climb(&self, omega: f64) -> (f64, f64) {
        let (tip, slope) = self.tip_response(omega);
        (tip.re * slope.re + tip.im * slope.im, tip.norm_sqr())
    }

    /// Frequency (Hz) at which the free tip moves farthest for a given drive level: the peak of
    /// |tip| nearest the lever's own first mode, to rounding.
    ///
    /// # Errors
    /// The nearest peak is that of an undamped mode, or there is no peak within a factor of
    /// 16 of the lever's first mode.
    pub fn resonance(&self) -> Result<f64, InstrumentError> {
        let target = self.lever_frequency * std::f64::consts::TAU;
        let none = InstrumentError::NoPeak { lever_hz: self.lever_frequency };
        // Infinite peaks are known without a search.
        let poles: Vec<f64> = self
            .modes
            .iter()
            .filter(|m| m.inverse_q() == 0.0 && m.tip * m.drive != 0.0)
            .map(|m| m.omega)
            .collect();
        let nearer = |a: &f64, b: &f64| (a - target).abs().total_cmp(&(b - target).abs());
        let pole = poles.iter().copied().min_by(nearer);
        let peak = self.nearest_peak(target, &poles);
        match (pole, peak) {
            (Some(pole), peak) if peak.is_none_or(|peak| nearer(&pole, &peak).is_le()) => {
                Err(InstrumentError::UndampedPeak { frequency_hz: pole / std::f64::consts::TAU })
            }
            (_, Some(peak)) => Ok(peak / std::f64::consts::TAU),
            _ => Err(none),
        }
    }

    /// The finite peak nearest to `target`. What lies farther from it than a peak that is found is not looked at.
    fn nearest_peak(&self, target: f64, poles: &[f64]) -> Option<f64> {
        let near = self.nearest_within(NEAR, target, poles);
        // What may be nearer lies within as well.
        near.filter(|peak| (peak - target).abs() < target * (1.0 - 1.0 / NEAR))
            .or_else(|| self.nearest_within(REACH, target, poles))
    }

    /// The same, a factor of `reach` around it.
    fn nearest_within(&self, reach: f64, target: f64, poles: &[f64]) -> Option<f64> {
        let points = self.scan_points(reach, target);
        let climbs: Vec<OnceCell<f64>> = vec![OnceCell::new(); points.len()];
        let climb = |i: usize| *climbs[i].get_or_init(|| self.climb(points[i]).0);
        let off = |omega: f64| (omega - target).abs();
        let mut best: Option<f64> = None;
        // Intervals end at points `right` and `left`: those from the target upwards and downwards.
        let mut right = points.partition_point(|p| *p < target).max(1);
        let mut left = right - 1;
        loop {
            // How near their near ends are.
            let above = (right < points.len()).then(|| off(points[right - 1].max(target)));
            let below = (left >= 1).then(|| off(points[left].min(target)));
            let up = match (above, below) {
                (None, None) => return best,
                (Some(above), Some(below)) => above <= below,
                (above, _) => above.is_some(),
            };
            let (i, gap) = if up { (right, above) } else { (left, below) };
            if best.zip(gap).is_some_and(|(best, gap)| off(best) < gap) {
                return best;
            }
            if up {
                right += 1
            } else {
                left -= 1
            }
            // A maximum: uphill, then downhill. NaN on a pole is neither.
            if climb(i - 1) > 0.0 && climb(i) <= 0.0 {
                let peak = self.peak_between(points[i - 1], points[i]);
                // The search climbs to infinite peaks too.
                let infinite = poles.iter().any(|pole| (peak - pole).abs() <= 1e-9 * pole);
                if !infinite && best.is_none_or(|best| off(peak) < off(best)) {
                    best = Some(peak);
                }
            }
        }
    }

    /// Where to look, a factor of `reach` around the target: a coarse scan, and around each mode points spaced by its own
    /// width.
    fn scan_points(&self, reach: f64, target: f64) -> Vec<f64> {
        let (low, high) = (target / reach, target * reach);
        let ratio = (REACH * REACH).powf(1.0 / SCAN as f64);
        // Steps from the target on either side.
        let steps = (reach.ln() / ratio.ln()).round() as i32;
        let mut points: Vec<f64> = (-steps..=steps).map(|i| target * ratio.powi(i)).collect();
        for mode in self.modes.iter().filter(|m| m.omega > low && m.omega < high) {
            // An undamped mode is bracketed a rounding or two away.
            let width = (0.5 * mode.inverse_q()).max(1e-12);
            points.push(mode.omega);
            let mut offset = 0.25 * width;
            while offset < 0.3 {
                points.push(mode.omega * (1.0 - offset));
                points.push(mode.omega * (1.0 + offset));
                offset *= 2.0;
            }
        }
        points.retain(|p| *p >= low && *p <= high);
        points.sort_by(f64::total_cmp);
        points
    }

    /// The top between `low` (uphill) and `high` (downhill), by chords; an end that a second chord leaves where it is counts less
    /// (Anderson & Bjorck, BIT 13 (1973) 253), and one that three leave there is brought nearer by half.
    fn peak_between(&self, low: f64, high: f64) -> f64 {
        let end = |omega: f64| (omega, self.climb(omega).0);
        let less = |share: f64| if share < 1.0 { 1.0 - share } else { 0.5 };
        let (mut low, mut high) = (end(low), end(high));
        let (mut low_stayed, mut high_stayed) = (0, 0);
        loop {
            let half = 0.5 * (low.0 + high.0);
            let chord = low.0 + (high.0 - low.0) * (low.1 / (low.1 - high.1));
            let by_half = low_stayed.max(high_stayed) >= 3 || !chord.is_finite();
            let middle = end(if by_half { half } else { chord });
            if !(middle.0 > low.0 && middle.0 < high.0 && high.0 - low.0 > 2.0 * f64::EPSILON * high.0) {
                return middle.0.clamp(low.0, high.0);
            }
            if middle.1 > 0.0 {
                high.1 *= if high_stayed > 0 { less(middle.1 / low.1) } else { 1.0 };
                (low, low_stayed, high_stayed) = (middle, 0, if by_half { 0 } else { high_stayed + 1 });
            } else {
                low.1 *= if low_stayed > 0 { less(middle.1 / high.1) } else { 1.0 };
                (high, high_stayed, low_stayed) = (middle, 0, if by_half { 0 } else { low_stayed + 1 });
            }
        }
    }
}

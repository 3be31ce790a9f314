//! Harmonic balance with one harmonic: states of tapping where the force takes the tip's swing as a spring does. Searches
//! start from them.
//!
//! The force's part at the drive's frequency is `F = kappa z` of a tip that swings by z. With the compliance C at the drive
//! and the free swing z0, the swing is `z = z0/(1 - C kappa)`. A lever of high quality factor needs hardly any force to
//! balance its drive, so its swing has hardly any other harmonic. (Describing function: Gelb & Vander Velde 1968.)

use super::orbit_transfer;
use super::tolerances::free_multiplier;
use crate::contact::Contact;
use crate::kernel::MODES_MAX;
use crate::periodic::root_within;
use crate::plan::{Driven, KeptMode, Plan, SectionState};
use nalgebra::Complex;
use std::f64::consts::PI;

/// A lever rings long if its free motion takes so many periods to decay by this exponent: from a quality factor of 100 on.
const LONG_DECAY_PERIODS: f64 = 64.0;
const DECAY_EXPONENT: f64 = 2.0;
/// Points at which the force is taken on either way, to the nearest point and back: so many in contact, and so many outside.
const PATH_POINTS: u32 = 16;
/// An amplitude is at balance if it needs a drive that is the present one but for this share.
const BALANCE_TOL: f64 = 1e-5;
/// Halvings that tell the amplitude of no force on the mean, between touching and the largest amplitude.
const NEUTRAL_HALVINGS: u32 = 16;
/// Least amplitude looked at, in free amplitudes.
const LEAST_AMPLITUDE: f64 = 1e-3;
/// Amplitudes tried where the force attracts.
const AMPLITUDES_TRIED: u32 = 32;
/// Off resonance a sample may raise the amplitude: so often it is tried, by this factor.
const AMPLITUDE_RAISES: (usize, f64) = (8, 1.3);

/// The motion that keeps `share` of the free amplitude while the sample takes no energy. Two real kappa give the share: a
/// negative one, for a force that pushes where the tip is nearest, and a positive one.
pub(super) fn conservative_orbit(plan: &Plan, instance: u32, share: f64, repulsive: bool) -> SectionState {
    let driven = plan.driven(instance);
    let compliance = driven.free.compliance;
    let (size, cosine) = (compliance.norm(), compliance.arg().cos());
    let root = (cosine * cosine - 1.0 + share.powi(-2)).sqrt();
    let kappa = (cosine + if repulsive { -root } else { root }) / size;
    orbit_under(plan, instance, Complex::from(kappa))
}

/// The motion of an instance at the balance of its own contact, if its lever rings long and there is a balance. If both
/// branches have one, it is on the repulsive branch, to which the free oscillation mostly leads.
pub(super) fn balanced_orbit(plan: &Plan, instance: u32) -> Option<SectionState> {
    balanced_at(plan, instance, |balance| balance.amplitude())
}

/// The same on the attractive branch.
pub(super) fn attractive_orbit(plan: &Plan, instance: u32) -> Option<SectionState> {
    balanced_at(plan, instance, |balance| balance.attractive_amplitude())
}

/// Whether the free motion of an instance's lever decays slowly.
fn rings_long(plan: &Plan, instance: u32) -> bool {
    LONG_DECAY_PERIODS * -free_multiplier(plan, instance).ln() <= DECAY_EXPONENT
}

/// The motion of an instance at the amplitude that `find` tells, if its lever rings long.
fn balanced_at(plan: &Plan, instance: u32, find: impl Fn(&Balance) -> Option<f64>) -> Option<SectionState> {
    if !rings_long(plan, instance) {
        return None;
    }
    let case = plan.case(instance);
    let balance = Balance { contact: &case.contact, gap: case.gap, driven: plan.driven(instance) };
    let kappa = balance.stiffness(find(&balance)?);
    kappa.is_finite().then(|| orbit_under(plan, instance, kappa))
}

/// The section state of an instance whose tip feels the spring `kappa`, N/m: the mode that answers the drive most takes the
/// whole motion beyond the free one.
fn orbit_under(plan: &Plan, instance: u32, kappa: Complex<f64>) -> SectionState {
    let driven = plan.driven(instance);
    let beyond = driven.free.tip / (1.0 - driven.free.compliance * kappa) - driven.free.tip;
    let mut station = SectionState::free(plan, instance);
    let far = |mode: &KeptMode| (mode.omega / driven.free.omega).ln().abs();
    let modes = &driven.kept.modes[..driven.kept.modes.len().min(MODES_MAX)];
    let nearest = (0..modes.len()).min_by(|a, b| far(&modes[*a]).total_cmp(&far(&modes[*b])));
    if let Some(k) = nearest {
        let turned =
            beyond * Complex::from_polar(1.0, orbit_transfer::section_angle(driven, plan.steps(instance)));
        (station.x[k], station.u[k]) = (turned.im, turned.re * driven.free.omega / modes[k].omega);
    }
    station
}

/// A contact at a gap (m), under a driven lever.
struct Balance<'a> {
    contact: &'a Contact,
    gap: f64,
    driven: &'a Driven,
}

impl Balance<'_> {
    /// The spring that takes a swing of `amplitude` (m) as the contact does, N/m. Its imaginary part is the loss.
    fn stiffness(&self, amplitude: f64) -> Complex<f64> {
        let goes = || path(self.gap / amplitude);
        let (mut touching, mut sum) = (false, Complex::ZERO);
        // The tip comes and goes; it is nearest half a period after the top of its swing.
        let mut add = |angle: f64, share: f64| {
            let turn = -Complex::from_polar(1.0, angle);
            let (depth, rate) =
                (-self.gap - amplitude * turn.re, amplitude * self.driven.free.omega * turn.im);
            touching = self.contact.next_contact(depth, touching);
            sum += turn.conj() * (self.contact.force_moving(depth, rate, touching) * share);
        };
        let reversible = self.contact.is_reversible();
        if !reversible {
            goes().rev().for_each(|(angle, share)| add(-angle, share));
        }
        goes().for_each(|(angle, share)| add(angle, share));
        // The way there has the same forces as the way back.
        let sum = if reversible { Complex::from(2.0 * sum.re) } else { sum };
        sum / (PI * amplitude)
    }

    /// By how much the free amplitude is too small to drive a swing of `amplitude`, m.
    fn miss(&self, amplitude: f64) -> f64 {
        let left = 1.0 - self.driven.free.compliance * self.stiffness(amplitude);
        left.norm() * amplitude - self.driven.free_amplitude()
    }

    /// Whether the drive is too strong for a swing of `amplitude`, which then grows.
    fn drives_on(&self, amplitude: f64) -> bool {
        self.miss(amplitude) < 0.0
    }

    /// Whether the force attracts on the mean over a swing of `amplitude`.
    fn attracts(&self, amplitude: f64) -> bool {
        self.stiffness(amplitude).re >= 0.0
    }

    /// The amplitude at balance, m.
    fn amplitude(&self) -> Option<f64> {
        let (touching, most) = self.touching_and_most()?;
        if self.drives_on(touching) {
            // Mostly there is no balance between touching and this one.
            let amplitude = self.between(touching, most);
            if !self.attracts(amplitude) {
                return Some(amplitude);
            }
        }
        let neutral = self.neutral(touching, most);
        if self.drives_on(neutral) {
            return Some(self.between(neutral, most));
        }
        // Also where the force attracts there may be several amplitudes; the tip taps at the largest one.
        let tried = |n: u32| neutral * tried_share(n);
        let low = (1..AMPLITUDES_TRIED).rev().find(|n| self.drives_on(tried(*n)))?;
        Some(self.between(tried(low), tried(low + 1)))
    }

    /// The amplitude at balance on the attractive branch, m.
    fn attractive_amplitude(&self) -> Option<f64> {
        let (touching, most) = self.touching_and_most()?;
        let neutral = self.neutral(touching, most);
        let tried = |n: u32| neutral * tried_share(n);
        let high = (1..=AMPLITUDES_TRIED).find(|n| !self.drives_on(tried(*n)))?;
        Some(self.between(tried(high - 1), tried(high)))
    }

    /// The amplitude at balance between one that grows and one that does not, m.
    fn between(&self, low: f64, high: f64) -> f64 {
        let close = BALANCE_TOL * self.driven.free_amplitude();
        root_within(low, high, close, |amplitude| self.miss(amplitude))
    }

    /// The amplitude of a tip that just touches, and one that is too large for a balance, m.
    fn touching_and_most(&self) -> Option<(f64, f64)> {
        let free = self.driven.free_amplitude();
        let (raises, factor) = AMPLITUDE_RAISES;
        let raised = std::iter::successors(Some(free), |amplitude| Some(factor * amplitude));
        let most = raised.take(raises + 1).find(|amplitude| self.miss(*amplitude) >= 0.0)?;
        Some((self.gap.clamp(LEAST_AMPLITUDE * free, most), most))
    }

    /// The amplitude above which the force repels on the mean and below which it attracts, from that of touching to the
    /// largest one, m.
    fn neutral(&self, touching: f64, most: f64) -> f64 {
        if self.attracts(most) {
            return most;
        }
        let (mut low, mut high) = (touching, most);
        for _ in 0..NEUTRAL_HALVINGS {
            let middle = 0.5 * (low + high);
            *if self.attracts(middle) { &mut low } else { &mut high } = middle;
        }
        low
    }
}

/// Share of the neutral amplitude that is tried as number n of [`AMPLITUDES_TRIED`]: dense near the neutral one, where the
/// attraction is strongest.
fn tried_share(n: u32) -> f64 {
    1.0 - (1.0 - f64::from(n) / f64::from(AMPLITUDES_TRIED)).powi(2)
}

/// Angles of half a period from the tip's nearest point on, and their weights in an integral, where the contact ends at the
/// angle whose cosine is `gap` (in amplitudes). They are dense on both sides of it, where the force has its kinks and the
/// attraction is strongest.
fn path(gap: f64) -> impl DoubleEndedIterator<Item = (f64, f64)> {
    let ends = gap.clamp(-1.0, 1.0).acos();
    let share = |n: u32| (f64::from(n) + 0.5) / f64::from(PATH_POINTS);
    let inside = (0..PATH_POINTS).rev().map(share).map(move |s| (ends * (1.0 - s * s), 2.0 * ends * s));
    let left = PI - ends;
    let outside = (0..PATH_POINTS).map(share).map(move |s| (ends + left * s * s * s, 3.0 * left * s * s));
    inside.chain(outside).map(|(angle, weight)| (angle, weight / f64::from(PATH_POINTS)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_plans::plan_of;

    const RADIUS: f64 = 10e-9;
    const WORK: f64 = 0.03;
    const DECAY_LENGTH: f64 = 0.3e-9;

    /// A lever of 40 N/m and quality factor 2000 on 2 GPa, 17 nm below its tip that swings freely by 20 nm.
    fn plan(law: &str) -> Plan {
        let text = format!(
            r#"
            [instrument.cantilever]
            modes = [{{ stiffness = "40 N/m", frequency = "300 kHz", quality_factor = 2000 }}]
            [instrument.tip]
            radius = "{RADIUS} m"
            [sample]
            youngs_modulus = "2 GPa"
            surface_energy = "{WORK} J/m^2"
            [contact]
            law = "{law}"
            decay_length = "{DECAY_LENGTH} m"
            [drive]
            on = "tip"
            frequency = "300 kHz"
            free_amplitude = "20 nm"
            [approach]
            gap = "17 nm"
            "#
        );
        plan_of(&text)
    }

    fn with_balance<T>(plan: &Plan, gap: f64, look: impl FnOnce(Balance) -> T) -> T {
        look(Balance { contact: &plan.contact(0), gap, driven: plan.driven(0) })
    }

    /// Truth: of a force -c/d^2 at the distance d = g + A cos(t), the spring is 2 c/(g^2 - A^2)^(3/2).
    #[test]
    fn the_spring_of_an_inverse_square_is_in_closed_form() {
        let plan = plan("dmt");
        let strength = 2.0 * PI * WORK * RADIUS * DECAY_LENGTH.powi(2);
        for gap in [15e-9, 11e-9, 10.2e-9] {
            let amplitude = 10e-9;
            let exact = 2.0 * strength / ((gap + DECAY_LENGTH).powi(2) - amplitude * amplitude).powf(1.5);
            let found = with_balance(&plan, gap, |one| one.stiffness(amplitude));
            println!("gap {gap:e}: {:.6e}, exact {exact:.6e}", found.re);
            assert!((found.re / exact - 1.0).abs() < 2e-3, "{gap}: {found} {exact}");
            assert!(found.im.abs() < 1e-9 * exact, "{gap}: {found}");
        }
    }

    /// Truth: a neck that forms at one depth and breaks at another takes energy, a contact without hysteresis none.
    #[test]
    fn the_spring_of_a_neck_loses_energy() {
        let lost = |law| with_balance(&plan(law), 17e-9, |one| one.stiffness(18e-9)).im * 20e-9;
        assert!(lost("hertz").abs() < 1e-9 && lost("dmt").abs() < 1e-9);
        assert!(lost("jkr") < -1e-12, "{}", lost("jkr"));
    }

    /// The swing of a lever with the spring that its contact is at this amplitude.
    fn swing(balance: &Balance, amplitude: f64) -> Complex<f64> {
        let free = &balance.driven.free;
        free.tip / (1.0 - free.compliance * balance.stiffness(amplitude))
    }

    /// Truth: the drive's force and the contact's on the lever add up to what it answers with its own compliance.
    #[test]
    fn drive_and_contact_are_in_balance() {
        for law in ["hertz", "dmt", "jkr"] {
            let plan = plan(law);
            let (swing, free) = with_balance(&plan, 17e-9, |one| {
                let amplitude = one.amplitude().expect("a balance exists");
                let swing = swing(&one, amplitude);
                assert!((swing.norm() / amplitude - 1.0).abs() < 1e-4, "{law}: {swing} {amplitude}");
                (swing, one.driven.free.amplitude)
            });
            // It taps, and the sample holds it back.
            assert!(17e-9 < swing.norm() && swing.norm() < 0.95 * free, "{law}: {}", swing.norm());
        }
    }

    /// Truth: the same, where the tip hovers and the attraction of an inverse square pulls at it.
    #[test]
    fn a_hovering_tip_is_in_balance() {
        let plan = plan("dmt");
        let (amplitude, swing) = with_balance(&plan, 18.5e-9, |one| {
            let amplitude = one.attractive_amplitude().expect("a balance exists");
            (amplitude, swing(&one, amplitude))
        });
        assert!((swing.norm() / amplitude - 1.0).abs() < 1e-4, "{swing} {amplitude}");
        assert!(17e-9 < amplitude && amplitude < 18.5e-9, "{amplitude}");
        // Nothing attracts under this law.
        assert_eq!(with_balance(&self::plan("hertz"), 18.5e-9, |one| one.attractive_amplitude()), None);
    }
}

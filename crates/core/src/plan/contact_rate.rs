//! The rate of a contact, at which its stiffness and the lever's compliance balance.

use super::basis::RICHEST_ACCURACY_SHARE;
use super::basis_rule::OSCILLATOR_COUNTS;
use super::compliance::compliance;
use super::steps::JUMPS_BELOW;
use super::{BasisRule, Driven, ReducedBasis};
use crate::contact::Contact;
use crate::instrument::Mode;
use std::sync::Arc;

/// Fixed-point iterations between a contact's rate and its depth. Each reduces the error to a tenth, and the rate is needed to
/// a factor of two.
const RATE_ITERATIONS: usize = 4;

/// A viscous contact begins with a force that grows as the root of time and moves modes far above its rate, so that its rate
/// counts so many times; docs/tuning.md has the figures.
const MAX_VISCOUS_ONSET: f64 = 24.0;
/// It does so from this product of rate and retardation time on, and less below it.
const VISCOUS_PRODUCT: f64 = 0.1;

/// Below the accuracy [`JUMPS_BELOW`] a contact whose force jumps gets oscillators for this share of the accuracy: jumps ring all
/// modes, and two bases of few oscillators may differ little by chance (tests/all/agree_control.rs).
const JUMP_ACCURACY_SHARE: f64 = 0.1;

/// Rate of an instance's contact, rad/s: the s with k C(s) = 1. C is the tip's compliance by all modes; k is the contact's
/// stiffness at this rate and at the depth of a collision, with the tip's inverse mass s^2 C(s). The rate is the contact's
/// own angular frequency, about four over its duration: a Hertzian collision of depth d and speed v lasts 2.94 d/v and has
/// the rate 1.37 v/d. It is 0 where no force acts on the tip.
///
/// `omega` (rad/s) and `amplitude` (m) are of the free tip, `gap` is in m, and `answer` gives the tip's compliance at a rate.
pub(super) fn contact_rate(
    contact: &Contact,
    (omega, amplitude, gap): (f64, f64, f64),
    mut answer: impl FnMut(f64) -> f64,
) -> f64 {
    if !contact.law.acts() {
        return 0.0;
    }
    let pull = contact.law().attraction_slope();
    let mut rate = omega;
    for _ in 0..RATE_ITERATIONS {
        let inverse_mass = rate * rate * answer(rate);
        let depth = super::steps::deepest(contact, inverse_mass, omega, amplitude, gap);
        let stiffness = contact.stiffness_at(depth, rate).max(pull);
        let next = (inverse_mass * stiffness).sqrt();
        // Further iterations would change nothing.
        if !next.is_finite() || next.max(omega) == rate {
            break;
        }
        rate = next.max(omega);
    }
    let viscous = (contact.viscous_time() * rate / VISCOUS_PRODUCT).min(1.0);
    rate * (MAX_VISCOUS_ONSET - 1.0).mul_add(viscous, 1.0)
}

/// What contacts that share a basis have in common.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(super) struct RateOctave {
    /// Their rates are at most 2 to this power times the drive's angular frequency.
    pub power: u32,
    /// Whether the sample neither loses energy nor relaxes.
    pub elastic: bool,
    /// Whether their force jumps.
    pub jumps: bool,
}

/// Data of a drive for [`Driven::octave`] of very many contacts: the numbers of [`compliance`] side by side, so that their
/// quotients are computed together.
pub(super) struct DriveCompliance<'a> {
    driven: &'a Driven,
    squares: Vec<f64>,
    inverse_masses: Vec<f64>,
    terms: Vec<f64>,
    /// The compliance at the first iterate of every contact.
    at_omega: f64,
}

impl<'a> DriveCompliance<'a> {
    pub fn of(driven: &'a Driven) -> Self {
        let modes = &driven.instrument.modes;
        let squares = modes.iter().map(|mode| mode.omega * mode.omega).collect();
        let inverse_masses = modes.iter().map(Mode::inverse_mass).collect();
        let terms = vec![0.0; modes.len()];
        let mut all = Self { driven, squares, inverse_masses, terms, at_omega: f64::NAN };
        all.at_omega = all.compliance(driven.free.omega);
        all
    }

    /// [`compliance`], to the bit.
    fn compliance(&mut self, s: f64) -> f64 {
        if s == self.driven.free.omega && !self.at_omega.is_nan() {
            return self.at_omega;
        }
        let numbers = self.squares.iter().zip(&self.inverse_masses);
        for (term, (square, inverse_mass)) in self.terms.iter_mut().zip(numbers) {
            *term = inverse_mass / (square + s * s);
        }
        self.terms.iter().sum()
    }

    /// [`Driven::octave`], to the bit.
    pub fn octave(&mut self, contact: &Contact, gap: f64) -> RateOctave {
        let driven = self.driven;
        let free = (driven.free.omega, driven.free_amplitude(), gap);
        driven.octave_of(contact, contact_rate(contact, free, |s| self.compliance(s)))
    }
}

/// The drive of the last contact, with its number: neighbours mostly share it.
#[derive(Default)]
pub(super) struct OctaveCache<'a>(Option<(u32, DriveCompliance<'a>)>);

impl<'a> OctaveCache<'a> {
    /// [`Driven::octave`] of a contact of this drive.
    pub fn octave(&mut self, (number, driven): (u32, &'a Driven), contact: &Contact, gap: f64) -> RateOctave {
        if self.0.as_ref().is_none_or(|(last, _)| *last != number) {
            self.0 = None;
        }
        self.0.get_or_insert_with(|| (number, DriveCompliance::of(driven))).1.octave(contact, gap)
    }
}

impl Driven {
    /// The octave of an instance's contact.
    pub(super) fn octave(&self, contact: &Contact, gap: f64) -> RateOctave {
        self.octave_of(contact, self.contact_rate(contact, gap))
    }

    /// The octave of a contact of this rate, rad/s.
    fn octave_of(&self, contact: &Contact, rate: f64) -> RateOctave {
        let power = (rate / self.free.omega).max(1.0).log2().ceil().min(64.0) as u32;
        RateOctave { power, elastic: contact.retardation == 0.0, jumps: contact.law.jumps() }
    }

    /// Rate of an instance's contact, rad/s: its own angular frequency against the tip as it moves at that rate, about four
    /// over its duration.
    pub fn contact_rate(&self, contact: &Contact, gap: f64) -> f64 {
        let modes = &self.instrument.modes;
        let answer = |s: f64| compliance(modes.iter().map(|mode| (mode.omega, mode.inverse_mass())), s);
        contact_rate(contact, (self.free.omega, self.free_amplitude(), gap), answer)
    }

    /// The contact rate of an octave, rad/s.
    fn rate(&self, octave: RateOctave) -> f64 {
        self.free.omega * f64::from(octave.power).exp2()
    }

    /// The basis for contacts of an octave. None if the modes with the largest shares suffice, be they as many as `shares` makes for
    /// [`RICHEST_ACCURACY_SHARE`] of the accuracy.
    pub(super) fn for_octave(
        &self,
        octave: RateOctave,
        accuracy: f64,
        shares: impl FnOnce((f64, bool)) -> ReducedBasis,
    ) -> Option<Arc<ReducedBasis>> {
        let (instrument, rate) = (&self.instrument, self.rate(octave));
        let richest = (RICHEST_ACCURACY_SHARE * accuracy, true);
        let jumps = octave.jumps && accuracy < JUMPS_BELOW;
        let bound = if jumps { JUMP_ACCURACY_SHARE * accuracy } else { accuracy };
        let serves = |kept: &ReducedBasis| kept.serves(instrument, self.free.omega, rate, bound);
        if octave.power == 0 || serves(&self.kept) || serves(&shares(richest)) {
            return None;
        }
        let least = ReducedBasis::oscillators(instrument, self.free.omega, rate, bound);
        let enough =
            |kept: &ReducedBasis| matches!(kept.rule, BasisRule::Contact { count, .. } if count >= least);
        self.for_contacts(octave, accuracy, enough)
    }

    /// The smallest basis for contacts of the octave that is `good`, or else the largest one; `None` if a mode answers against
    /// the force. `accuracy` is that of the run.
    pub(super) fn for_contacts(
        &self,
        octave: RateOctave,
        accuracy: f64,
        good: impl Fn(&ReducedBasis) -> bool,
    ) -> Option<Arc<ReducedBasis>> {
        let mut richest = None;
        // The smallest count is no contact's own basis: it is the poorer one of the next.
        for count in OSCILLATOR_COUNTS.into_iter().skip(1) {
            let (rate, elastic, resonant) = (self.rate(octave), octave.elastic, self.kept.rule.is_resonant());
            let rule = BasisRule::Contact { rate, count, elastic, resonant };
            let kept = ReducedBasis::for_contact(&self.instrument, self.free.omega, rule, accuracy);
            let enough = kept.as_ref().is_some_and(&good);
            richest = kept.or(richest);
            if enough {
                break;
            }
        }
        richest.map(Arc::new)
    }

    /// The basis that the rule asks for in a run of this accuracy, or the drive's own if that cannot be made.
    pub(super) fn reduced_by(
        &self,
        rule: BasisRule,
        accuracy: f64,
        shares: impl FnOnce((f64, bool)) -> ReducedBasis,
    ) -> Arc<ReducedBasis> {
        match rule {
            _ if rule == self.kept.rule => Arc::clone(&self.kept),
            BasisRule::Shares { accuracy, resonant } => Arc::new(shares((accuracy, resonant))),
            BasisRule::Contact { .. } => {
                let made = ReducedBasis::for_contact(&self.instrument, self.free.omega, rule, accuracy);
                made.map_or_else(|| Arc::clone(&self.kept), Arc::new)
            }
        }
    }
}

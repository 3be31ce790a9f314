//! The contact laws again, in forms of their own: nothing here shares code with `contact` or the kernel.

use super::indenter::Indenter;
use crate::contact::{Contact, Law};
use crate::scene::LawChoice;
use std::f64::consts::PI;

/// The form of a contact law in the reference engine; SI units.
pub(super) trait ReferenceForm {
    /// From the contact's modulus, radius, work and decay length.
    fn of(contact: &Contact) -> Self
    where
        Self: Sized;

    /// Force on the tip, N, on its branch. Only a law that needs the rate of indentation (m/s) calls `rate`. `memory` is the
    /// law's, if it has one, as lengths in m.
    fn at(&self, delta: f64, rate: impl FnOnce() -> f64, memory: [f64; 2], touching: bool) -> f64
    where
        Self: Sized;

    /// Rates (m/s) at which the memory changes.
    fn remembered(&self, _delta: f64, _touching: bool, _memory: [f64; 2]) -> [f64; 2] {
        [0.0; 2]
    }

    /// Under a law with a history: positive where the sample presses on the tip, which may end before the tip is out.
    fn pressing(&self, delta: f64, _rate: f64, _memory: [f64; 2]) -> f64 {
        delta
    }

    /// Indentation at which contact changes: touch from outside, release from inside; `None` without a sample.
    fn level(&self, _touching: bool) -> Option<f64> {
        Some(0.0)
    }

    /// Whether a tip that starts at this indentation touches.
    fn touches(&self, delta: f64) -> bool {
        delta > 0.0
    }

    /// Indentation of the largest pull within the contact branch, if there is one.
    fn deepest_pull(&self) -> Option<f64> {
        None
    }
}

/// From the kernel's list: each law in its form.
macro_rules! reference_law {
    ($($(#[$doc:meta])* $law:ident = $code:literal, $word:literal $(in $scenes:ident)?, $kind:ident
        { attraction: $attraction:ident, hysteresis: $hysteresis:literal, history: $history:literal,
          kin: $kin:tt, reference: $form:ident, $($steppers:tt)* };)*) => {
        /// A contact law with its constants; SI units.
        #[derive(Clone, Copy, Debug)]
        pub(super) enum ReferenceLaw {
            $($law(super::$form),)*
        }

        impl ReferenceLaw {
            /// The law of a contact.
            pub fn new(contact: &Contact) -> Self {
                match contact.law {
                    $(Law::$law => Self::$law(super::$form::of(contact)),)*
                }
            }

            #[inline]
            pub fn at(&self, delta: f64, rate: impl FnOnce() -> f64, memory: [f64; 2], touching: bool) -> f64 {
                match self {
                    $(Self::$law(form) => form.at(delta, rate, memory, touching),)*
                }
            }

            /// The law behind one pointer, for what is rarely asked.
            pub fn form(&self) -> &dyn ReferenceForm {
                match self {
                    $(Self::$law(form) => form,)*
                }
            }
        }
    };
}

crate::kernel::laws!(reference_law);

/// No sample.
#[derive(Clone, Copy, Debug)]
pub(super) struct NoForce;

impl ReferenceForm for NoForce {
    fn of(_: &Contact) -> Self {
        Self
    }

    #[inline]
    fn at(&self, _: f64, _: impl FnOnce() -> f64, _: [f64; 2], _: bool) -> f64 {
        0.0
    }

    fn level(&self, _: bool) -> Option<f64> {
        None
    }

    fn touches(&self, _: f64) -> bool {
        false
    }
}

/// f = kappa delta^1.5 with kappa = K sqrt(R): Ha, Fung & Chen 2005, equation (14).
#[derive(Clone, Copy, Debug)]
pub(super) struct ReferenceHertz {
    kappa: f64,
}

impl ReferenceForm for ReferenceHertz {
    fn of(contact: &Contact) -> Self {
        Self { kappa: contact.modulus * contact.radius.sqrt() }
    }

    #[inline]
    fn at(&self, delta: f64, _: impl FnOnce() -> f64, _: [f64; 2], touching: bool) -> f64 {
        hertz(self.kappa, delta, touching)
    }
}

/// The same with DMT's attraction.
#[derive(Clone, Copy, Debug)]
pub(super) struct ReferenceDmt {
    kappa: f64,
    pull: DmtPull,
}

impl ReferenceForm for ReferenceDmt {
    fn of(contact: &Contact) -> Self {
        Self { kappa: contact.modulus * contact.radius.sqrt(), pull: DmtPull::of(contact) }
    }

    #[inline]
    fn at(&self, delta: f64, _: impl FnOnce() -> f64, _: [f64; 2], touching: bool) -> f64 {
        hertz(self.kappa, delta, touching) + self.pull.at(delta, touching)
    }
}

/// A tip of another shape (see [`Indenter`]), with DMT's attraction.
#[derive(Clone, Copy, Debug)]
pub(super) struct ReferenceShaped {
    indenter: Indenter,
    pull: DmtPull,
}

impl ReferenceForm for ReferenceShaped {
    fn of(contact: &Contact) -> Self {
        Self { indenter: Indenter::new(contact), pull: DmtPull::of(contact) }
    }

    #[inline]
    fn at(&self, delta: f64, _: impl FnOnce() -> f64, _: [f64; 2], touching: bool) -> f64 {
        self.indenter.pressed(delta, touching) + self.pull.at(delta, touching)
    }
}

/// DMT's attraction: the adhesion -P = -2 pi w R in contact, outside -P (D0/(D0 - delta))^2: equations (17), (18). P is 0
/// where the scene asked for another law.
#[derive(Clone, Copy, Debug)]
pub(super) struct DmtPull {
    adhesion: f64,
    decay: f64,
}

impl DmtPull {
    pub fn of(contact: &Contact) -> Self {
        // A law that is named after its forces has the attraction that the scene asked for.
        let pulls = match contact.law {
            Law::Dmt | Law::ViscousDmt | Law::ShapedDmt => true,
            law => law.is_sum() && contact.choice == LawChoice::Dmt,
        };
        let adhesion = if pulls { 2.0 * PI * contact.work * contact.radius } else { 0.0 };
        Self { adhesion, decay: contact.decay_length }
    }

    #[inline]
    pub fn at(self, delta: f64, touching: bool) -> f64 {
        let Self { adhesion, decay } = self;
        if touching {
            -adhesion
        } else if delta < 0.0 {
            -adhesion * (decay / (decay - delta)).powi(2)
        } else {
            -adhesion * (1.0 + 2.0 * delta / decay)
        }
    }
}

pub(super) fn hertz(kappa: f64, delta: f64, touching: bool) -> f64 {
    if touching && delta > 0.0 {
        kappa * delta * delta.sqrt()
    } else if delta.is_nan() {
        delta
    } else {
        0.0
    }
}

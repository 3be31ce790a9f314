//! A contact's constants in the kernel's units.

use crate::contact::Contact;
use crate::kernel::contact::{Dmt, Hertz, Interaction, Jkr, Nothing};
use crate::kernel::{LENGTH, Lane};
use std::f64::consts::PI;

/// A kernel law that can be made from an instance's contact.
///
/// `scale` turns a force in N into an impulse: h^2 times the tip's mobility over the length unit.
pub(super) trait KernelLaw<L: Lane>: Interaction<L> {
    fn build(contact: &Contact, scale: f64) -> Self;
}

impl<L: Lane> KernelLaw<L> for Nothing {
    fn build(_: &Contact, _: f64) -> Self {
        Nothing
    }
}

impl<L: Lane> KernelLaw<L> for Hertz<L> {
    fn build(contact: &Contact, scale: f64) -> Self {
        Hertz { stiffness: L::splat(contact.modulus * contact.radius.sqrt() * LENGTH.powf(1.5) * scale) }
    }
}

impl<L: Lane> KernelLaw<L> for Dmt<L> {
    fn build(contact: &Contact, scale: f64) -> Self {
        Dmt {
            hertz: Hertz::build(contact, scale),
            adhesion: L::splat(2.0 * PI * contact.radius * contact.work * scale),
            inverse_decay: L::splat(LENGTH / contact.decay_length),
        }
    }
}

impl<L: Lane> KernelLaw<L> for Jkr<L> {
    fn build(contact: &Contact, scale: f64) -> Self {
        // a_s^2/R, the unit of length of the dimensionless curve.
        let unit = contact.jkr().map_or(f64::INFINITY, |jkr| jkr.indentation_scale());
        Jkr {
            unit_force: L::splat(PI * contact.work * contact.radius * scale),
            inverse_unit: L::splat(LENGTH / unit),
        }
    }
}

//! A contact's constants in the kernel's units.

use crate::contact::Contact;
use crate::kernel::contact::{Dmt, Hertz, Interaction, Jkr, Nothing};
use crate::kernel::{LENGTH, Lane};
use std::f64::consts::PI;

/// A kernel law that can be made from its instances' contacts, one for each lane.
///
/// The number beside a contact turns a force in N into an impulse: h^2 times the tip's mobility over the length unit.
pub(super) trait KernelLaw<L: Lane>: Interaction<L> {
    fn build(contacts: &[(Contact, f64)]) -> Self;
}

impl<L: Lane> KernelLaw<L> for Nothing {
    fn build(_: &[(Contact, f64)]) -> Self {
        Nothing
    }
}

impl<L: Lane> KernelLaw<L> for Hertz<L> {
    fn build(contacts: &[(Contact, f64)]) -> Self {
        Hertz {
            stiffness: L::from_lanes(|i| {
                let (contact, scale) = &contacts[i];
                contact.modulus * contact.radius.sqrt() * LENGTH.powf(1.5) * scale
            }),
        }
    }
}

impl<L: Lane> KernelLaw<L> for Dmt<L> {
    fn build(contacts: &[(Contact, f64)]) -> Self {
        Dmt {
            hertz: Hertz::build(contacts),
            adhesion: L::from_lanes(|i| {
                let (contact, scale) = &contacts[i];
                2.0 * PI * contact.radius * contact.work * scale
            }),
            inverse_decay: L::from_lanes(|i| LENGTH / contacts[i].0.decay_length),
        }
    }
}

impl<L: Lane> KernelLaw<L> for Jkr<L> {
    fn build(contacts: &[(Contact, f64)]) -> Self {
        Jkr {
            unit_force: L::from_lanes(|i| {
                let (contact, scale) = &contacts[i];
                PI * contact.work * contact.radius * scale
            }),
            // a_s^2/R, the unit of length of the dimensionless curve.
            inverse_unit: L::from_lanes(|i| {
                LENGTH / contacts[i].0.jkr().map_or(f64::INFINITY, |jkr| jkr.indentation_scale())
            }),
        }
    }
}

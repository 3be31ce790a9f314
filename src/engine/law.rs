//! A contact's constants in the kernel's units.

use crate::contact::{Contact, Law};
use crate::kernel::LENGTH;
use std::f64::consts::PI;

/// The constants of the contact's law, in the order of its shader's fields.
///
/// `scale` turns a force in N into an impulse: h^2 times the tip's mobility over the length unit.
pub(super) fn numbers(contact: &Contact, scale: f64) -> impl Iterator<Item = f64> {
    let stiffness = || contact.modulus * contact.radius.sqrt() * LENGTH.powf(1.5) * scale;
    let all = match contact.law {
        Law::None => [0.0; 3],
        Law::Hertz => [stiffness(), 0.0, 0.0],
        Law::Dmt => {
            let adhesion = 2.0 * PI * contact.radius * contact.work * scale;
            [stiffness(), adhesion, LENGTH / contact.decay_length]
        }
        Law::Jkr => {
            // a_s^2/R, the unit of length of the dimensionless curve.
            let unit = contact.jkr().map_or(f64::INFINITY, |jkr| jkr.indentation_scale());
            [PI * contact.work * contact.radius * scale, LENGTH / unit, 0.0]
        }
    };
    all.into_iter().take(contact.law.shader().fields.len())
}

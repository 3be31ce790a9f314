//! Steps per drive period.

use super::basis::{ANGLE_MAX, STEPS_MAX};
use super::{BasisRule, Driven, ReducedBasis};
use crate::contact::Contact;
use std::f64::consts::TAU;

/// Fewest steps per period the rule gives.
pub const STEPS_MIN: u32 = 64;

/// Steps per period for smooth scenes at accuracy 1e-3, and the order by which they grow with the accuracy.
const BASE_STEPS: f64 = 128.0;
const STEPPER_ORDER: f64 = 3.0;
/// Limit of contact stiffness times h^2 times the tip's inverse mass, for a step h. It bounds the error of the largest force;
/// every other observable is ten times better.
///
/// Before the kicks knew when within the step the force acts, of 617 random cases (tests/all/agree_plan.rs; accuracy 1e-3,
/// against eight times the steps) 6 were above the accuracy with 0.2, the worst by 9 times; with 0.125, for 7 % more steps, 2
/// are: one by 4 %, and by 5 times the force of a contact as shallow as lengths are accurate. At 1e-2 one of 615 (a snap-in
/// that either happens or not), at 1e-4 two of 612, by 2.3 times at most.
const STIFFNESS_FACTOR: f64 = 0.125;
/// The same for the slope of an attraction just outside contact.
const ATTRACTION_FACTOR: f64 = 1.0;

/// An elastic contact that determines the oscillators excites many of them: its steps are finer by this factor. Of 10,000
/// cases of a lever of 4 N/m on samples up to 100 GPa (accuracy 1e-3; against the accuracy 1e-4) as many have a largest force
/// beyond the accuracy with 2 as did when steps followed the fastest oscillator: 19 and 25 under DMT, none under Hertz, 115 and
/// 183 under JKR. With 1.7 they are 61, none and 243; with 2.4, for a fifth more steps, 13, none and 61.
const FAST_CONTACT_REFINEMENT: f64 = 2.0;
/// The same below the accuracy [`JUMPS_BELOW`] if the force jumps: jumps ring all oscillators. Of 450 random levers under JKR
/// (accuracy 1e-4) five have a largest force beyond the accuracy with 2 and two with 3, for a fifth more steps.
const JUMP_REFINEMENT: f64 = 3.0;
pub(super) const JUMPS_BELOW: f64 = 1e-3;

/// The rule: enough steps for the requested accuracy, for the fastest mode that was chosen by its share, and for the contact at
/// the expected largest indentation. The contact meets faster oscillators by their mean over a step, so that the lever it sees
/// depends on the step.
pub fn steps(
    contact: &Contact,
    kept: &ReducedBasis,
    omega: f64,
    amplitude: f64,
    gap: f64,
    accuracy: f64,
) -> u32 {
    let base = BASE_STEPS * (1e-3 / accuracy).powf(1.0 / STEPPER_ORDER);
    let period = TAU / omega;
    let jumps = accuracy < JUMPS_BELOW && contact.law.jumps();
    let finer = match kept.rule {
        BasisRule::Contact { elastic: true, .. } if jumps => JUMP_REFINEMENT,
        BasisRule::Contact { elastic: true, .. } => FAST_CONTACT_REFINEMENT,
        _ => 1.0,
    };
    let limit = STIFFNESS_FACTOR * (accuracy / 1e-3).sqrt().clamp(0.05, 2.0);
    let mut steps = round_up(base.max(needed_by_modes(kept, omega)));
    loop {
        let inverse_mass = kept.stepped_inverse_mass(period / f64::from(steps));
        let depth = deepest(contact, inverse_mass, omega, amplitude, gap);
        let stiff = finer * period * (inverse_mass * contact.stiffness(depth, true).max(0.0) / limit).sqrt();
        let pull = period * (inverse_mass * contact.law().attraction_slope() / ATTRACTION_FACTOR).sqrt();
        if stiff.max(pull) <= f64::from(steps) || steps >= STEPS_MAX {
            return steps;
        }
        steps = round_up(f64::from(steps + 1));
    }
}

/// Steps per period that the fastest oscillator needs. Those made for an elastic contact need none; those for another move
/// with it and need twice as many.
pub(super) fn needed_by_modes(kept: &ReducedBasis, omega: f64) -> f64 {
    let needed = TAU * kept.fastest() / (omega * ANGLE_MAX);
    match kept.rule {
        BasisRule::Shares { .. } => needed,
        BasisRule::Contact { elastic: false, .. } => 2.0 * needed,
        BasisRule::Contact { elastic: true, .. } => 0.0,
    }
}

/// Fewest steps per period that can step the kept modes.
pub fn fewest(driven: &Driven) -> u32 {
    round_up(needed_by_modes(&driven.kept, driven.free.omega))
}

/// Smallest of 64, 96, 128, 192, 256, ... that is not below `steps`: few classes, small excess.
fn round_up(steps: f64) -> u32 {
    let mut power = STEPS_MIN;
    while power < STEPS_MAX {
        for candidate in [power, power + power / 2] {
            if f64::from(candidate) >= steps {
                return candidate;
            }
        }
        power *= 2;
    }
    STEPS_MAX
}

/// Expected largest indentation, m: that of the free swing or of a collision at the free tip's speed, whichever is less, plus
/// the depth at rest and what adhesion adds.
pub fn deepest(contact: &Contact, inverse_mass: f64, omega: f64, amplitude: f64, gap: f64) -> f64 {
    let overlap = (amplitude - gap).max(0.0);
    let inside = (amplitude * amplitude - gap * gap).max(0.0).sqrt().max(0.1 * amplitude);
    let speed = omega * inside;
    let collision = contact.law().collision_depth(speed, inverse_mass);
    let adhesion = contact.law().depth_by_adhesion();
    let resting = (-gap).max(0.0);
    collision.min(overlap) + adhesion + resting.min(overlap)
}

#[cfg(test)]
mod tests {
    use super::round_up;

    #[test]
    fn ladder_steps_are_not_below_what_was_asked() {
        for asked in [1.0, 64.0, 65.0, 97.0, 128.1, 1000.0, 65_535.0, 1e9] {
            let got = round_up(asked);
            assert!(f64::from(got) >= asked.min(65_536.0));
            assert!(f64::from(got) <= (1.5 * asked).max(64.0));
        }
    }
}

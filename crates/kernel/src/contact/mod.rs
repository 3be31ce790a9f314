//! The laws as the kernel needs them: mean force along a piece of the tip's path, and when within the step it acts.

mod accompanied;
mod cubic_path;
mod dmt;
pub mod force_table;
mod hertz;
mod hysteretic_sum;
mod jkr;
mod jkr_curve;
mod kelvin_voigt;
mod path;
mod relaxing_hertz;
mod shaped;
mod sum;

pub use accompanied::Accompanied;
pub use dmt::{Dmt, Tail};
pub use hertz::{Elastic, Hertz};
pub use hysteretic_sum::HystereticSum;
pub use jkr::Jkr;
pub use kelvin_voigt::{Clean, KelvinVoigt};
pub use relaxing_hertz::RelaxingHertz;
pub use shaped::{POWERS, ShapedHertz};
pub use sum::{ForceSum, TERMS};

use super::Lane;
use super::constants::{FAR, ONE, ZERO};
use super::lane::{Zip, when};
use std::marker::PhantomData;

/// The tip at one sample: indentation, its rate of change over the step before the kick, and its
/// acceleration by everything but the contact force. Kernel units.
///
/// A law's force may depend on the indentation, on its rate and on whether there is contact. All of them know the rate: the
/// step needs it for the piece of path, so that it costs a law that leaves it out nothing.
#[derive(Clone, Copy, Debug)]
pub struct Approach<L> {
    pub indentation: L,
    pub speed: L,
    pub acceleration: L,
    /// What the law remembers, where [`Interaction::MEMORY`] is true.
    pub memory: [L; 2],
}

impl<L: Lane> Approach<L> {
    /// Whether this step's piece of path can reach an indentation above zero. Wide enough that
    /// leaving the law out elsewhere changes no bit of the result.
    #[inline(always)]
    fn may_touch(self) -> L::Mask {
        (-(self.speed.abs() + self.acceleration.abs())).less(self.indentation)
    }
}

/// What the sample does to the tip during one step.
#[derive(Clone, Copy, Debug)]
pub struct Kick<L> {
    /// Change of tip travel per step; positive pushes away.
    pub impulse: L,
    /// Tip travel by which the impulse falls earlier or later within the step than a force that changes
    /// evenly would have it, positive where a repulsive one falls early; zero where [`Interaction::SHIFTS`] is false.
    pub shift: L,
    /// Share of the step spent in contact, 0 to 1.
    pub contact: L,
    /// 1 in contact at the step's end, else 0.
    pub touching: L,
    /// What the step adds to the law's memory beyond the recovery of a sample that nothing touches.
    pub memory: [L; 2],
}

/// One contact law with its constants in kernel units.
pub trait Interaction<L: Lane>: Copy {
    /// Names of its constants.
    const FIELDS: &'static [&'static str];
    /// Whether its kick also moves the tip: where the force has a corner, a jump or a short reach.
    const SHIFTS: bool;
    /// Whether no kick comes of a step that cannot touch the sample, after one that did not.
    const ONLY_IN_CONTACT: bool = false;
    /// Whether it remembers two numbers from step to step: the last mode of the state is then this memory. The lever says
    /// how it recovers out of contact ([`super::Lever::remembering`]), a kick what a step adds.
    const MEMORY: bool = false;

    /// Of its constants, one number after the other, in the order of [`Interaction::FIELDS`].
    fn from_numbers(next: impl FnMut() -> L) -> Self;

    /// The kick of one step. `touching` is what the last kick returned.
    fn kick(&self, approach: Approach<L>, touching: L) -> Kick<L>;

    /// Least and largest force, as impulses, within a step that had this kick. Only laws that depend on the rate follow them;
    /// the forces of the others are those at the extremes of the indentation.
    #[inline(always)]
    fn extremes(&self, _: Approach<L>, _: &Kick<L>) -> [L; 2] {
        [L::splat(ZERO); 2]
    }
}

/// 1 where the indentation is contact for a law without hysteresis, else 0.
#[inline(always)]
fn touching_at<L: Lane>(indentation: L) -> L {
    L::select(L::splat(ZERO).less(indentation), L::splat(ONE), L::splat(ZERO))
}

impl<L: Lane> Zip<L> for Kick<L> {
    #[inline(always)]
    fn zip(self, other: Self, join: &mut dyn FnMut(L, L) -> L) -> Self {
        Self {
            impulse: join(self.impulse, other.impulse),
            shift: join(self.shift, other.shift),
            contact: join(self.contact, other.contact),
            touching: join(self.touching, other.touching),
            memory: [0, 1].map(|n| join(self.memory[n], other.memory[n])),
        }
    }
}

/// Least and largest force of a step, which `forces` works out where the step may touch; elsewhere there are none.
#[inline(always)]
fn extremes_near<L: Lane>(at: Approach<L>, forces: impl FnOnce() -> (L, L)) -> [L; 2] {
    let far = L::splat(FAR);
    let (near, nothing) = (at.may_touch(), (far, -far));
    let (least, most) = when(
        near,
        nothing,
        #[inline(always)]
        || forces().zip(nothing, &mut |inside, outside| L::select(near, inside, outside)),
    );
    [least, most]
}

impl<L: Lane> Kick<L> {
    /// No force, out of contact.
    #[inline(always)]
    fn none() -> Self {
        let zero = L::splat(ZERO);
        Self { impulse: zero, shift: zero, contact: zero, touching: zero, memory: [zero; 2] }
    }
}

/// A tip of another shape under DMT's attraction.
pub type ShapedDmt<L> = Dmt<L, ShapedHertz<L>>;
/// Hertz's contact with a Kelvin-Voigt sample.
pub type ViscousHertz<L> = KelvinVoigt<L, Clean>;
/// The same under DMT's attraction.
pub type ViscousDmt<L> = KelvinVoigt<L, Tail<L>>;

/// JKR's contact with forces beside it.
pub type JkrSum<L> = Accompanied<L, Jkr<L>>;
/// A Kelvin-Voigt sample with forces beside the contact, DMT's attraction among them.
pub type ViscousSum<L> = Accompanied<L, ViscousDmt<L>>;
/// A sample that relaxes with forces beside the contact.
pub type RelaxingSum<L> = Accompanied<L, RelaxingHertz<L>>;

/// No sample at all.
#[derive(Clone, Copy, Debug)]
pub struct Nothing<L>(PhantomData<L>);

impl<L: Lane> Interaction<L> for Nothing<L> {
    const FIELDS: &'static [&'static str] = &[];
    const SHIFTS: bool = false;

    fn from_numbers(_: impl FnMut() -> L) -> Self {
        Self(PhantomData)
    }

    #[inline(always)]
    fn kick(&self, _: Approach<L>, _: L) -> Kick<L> {
        Kick::none()
    }
}

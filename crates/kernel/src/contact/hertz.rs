//! Hertz (1882): f = K sqrt(R) d^1.5 in contact; equation (14) of Ha, Fung & Chen 2005.

use super::path::{Path, corrected};
use super::{Approach, Interaction, Kick, Lane, Zip, touching_at, when};
use crate::constants::{HERTZ_ENERGY, LEAST, ZERO};

/// `stiffness` is K sqrt(R) in kernel units: impulse per step of a unit indentation.
#[derive(Clone, Copy, Debug)]
pub struct Hertz<L> {
    pub stiffness: L,
}

/// Mean force and mean slope (force per indentation) along a piece of path.
#[derive(Clone, Copy, Debug)]
pub struct Mean<L> {
    pub force: L,
    pub slope: L,
    pub share: L,
}

impl<L: Lane> Mean<L> {
    /// Out of contact.
    #[inline(always)]
    pub(super) fn none() -> Self {
        let zero = L::splat(ZERO);
        Self { force: zero, slope: zero, share: zero }
    }
}

impl<L: Lane> Zip<L> for Mean<L> {
    #[inline(always)]
    fn zip(self, other: Self, join: &mut dyn FnMut(L, L) -> L) -> Self {
        Self {
            force: join(self.force, other.force),
            slope: join(self.slope, other.slope),
            share: join(self.share, other.share),
        }
    }
}

/// An elastic half-space under a tip: the repulsion of a law.
pub trait Elastic<L: Lane>: Copy {
    /// Names of its constants, alone and before those of DMT's attraction.
    const FIELDS: &'static [&'static str];
    const WITH_TAIL: &'static [&'static str];

    fn from_numbers(next: impl FnMut() -> L) -> Self;

    /// Force at one indentation.
    fn sample(&self, indentation: L) -> L;

    /// Its mean along a piece of path.
    fn mean(&self, path: Path<L>) -> Mean<L>;
}

/// The kick of a law that is this contact alone.
#[inline(always)]
pub(super) fn elastic_kick<L: Lane>(contact: &impl Elastic<L>, at: Approach<L>) -> Kick<L> {
    when(
        at.may_touch(),
        Kick::none(),
        #[inline(always)]
        || {
            let path = Path::around(at, contact.sample(at.indentation));
            let mean = contact.mean(path);
            Kick {
                impulse: corrected(mean.force, mean.slope),
                shift: L::splat(ZERO),
                contact: mean.share,
                touching: touching_at(path.end),
                ..Kick::none()
            }
        },
    )
}

impl<L: Lane> Elastic<L> for Hertz<L> {
    const FIELDS: &'static [&'static str] = &["stiffness"];
    const WITH_TAIL: &'static [&'static str] = &["stiffness", "adhesion", "inverse_decay"];

    #[inline(always)]
    fn from_numbers(mut next: impl FnMut() -> L) -> Self {
        Self { stiffness: next() }
    }

    #[inline(always)]
    fn sample(&self, indentation: L) -> L {
        let inside = indentation.max(L::splat(ZERO));
        self.stiffness * inside * inside.sqrt()
    }

    /// Difference quotients of (2/5) d^2.5 and of d^1.5, in roots of the indentation so that
    /// nothing vanishes where the tip turns round.
    #[inline(always)]
    fn mean(&self, path: Path<L>) -> Mean<L> {
        let zero = L::splat(ZERO);
        let (aa, bb) = (path.start.max(zero), path.end.max(zero));
        let (a, b) = (aa.sqrt(), bb.sqrt());
        let share = path.share_inside();
        let ab = a * b;
        let sum = aa + bb;
        let scale = self.stiffness * share / (a + b).max(L::splat(LEAST));
        let quartic = sum.mul_add(sum + ab, -(ab * ab));
        Mean { force: quartic * scale * L::splat(HERTZ_ENERGY), slope: (sum + ab) * scale, share }
    }
}

impl<L: Lane> Interaction<L> for Hertz<L> {
    const FIELDS: &'static [&'static str] = <Self as Elastic<L>>::FIELDS;
    const SHIFTS: bool = false;
    const ONLY_IN_CONTACT: bool = true;

    #[inline(always)]
    fn from_numbers(next: impl FnMut() -> L) -> Self {
        <Self as Elastic<L>>::from_numbers(next)
    }

    #[inline(always)]
    fn kick(&self, at: Approach<L>, _touching: L) -> Kick<L> {
        elastic_kick(self, at)
    }
}

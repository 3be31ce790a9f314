//! Johnson, Kendall & Roberts (1971) with its memory; equation (16) of Ha, Fung & Chen 2005.
//!
//! Lengths and forces are in units of the fold, as in `jkr_curve.rs`.

use super::jkr_curve::{Part, Point};
use super::{Approach, Interaction, Kick, Lane, Zip, when};
use crate::constants::{
    EIGHTH, HALF, JKR_STEEPEST, JKR_TOUCH, JKR_TOUCH_ROOT, LEAST, ONE, TENTH, THREE, TWELFTH, TWO, ZERO,
};

/// `unit_force` is pi w R as impulse per step; `inverse_unit` R/a_s^2 per unit of length.
#[derive(Clone, Copy, Debug)]
pub struct Jkr<L> {
    pub unit_force: L,
    pub inverse_unit: L,
}

/// A point of the curve, and two numbers of the path there.
#[derive(Clone, Copy)]
struct Passage<L> {
    point: Point<L>,
    /// Of the step: how late it begins, or what it takes.
    share: L,
    pace: L,
}

impl<L: Lane> Zip<L> for Passage<L> {
    #[inline(always)]
    fn zip(self, other: Self, join: &mut dyn FnMut(L, L) -> L) -> Self {
        Self {
            point: self.point.zip(other.point, join),
            share: join(self.share, other.share),
            pace: join(self.pace, other.pace),
        }
    }
}

/// The path of a step without the force within it, in units of the fold.
#[derive(Clone, Copy)]
struct FreePath<L> {
    free: L,
    /// How fast and where the step begins.
    speed: L,
    start: L,
}

impl<L: Lane> FreePath<L> {
    #[inline(always)]
    fn of(at: Approach<L>, inverse_unit: L) -> Self {
        let half = L::splat(HALF);
        let free = at.acceleration * inverse_unit;
        let speed = (-half).mul_add(free, at.speed * inverse_unit);
        let along = at.indentation * inverse_unit;
        let start = (-half).mul_add(at.speed * inverse_unit, L::splat(EIGHTH).mul_add(free, along));
        Self { free, speed, start }
    }

    /// The share of the step after which the tip touches, and how fast it is there.
    #[inline(always)]
    fn touch(&self) -> (L, L) {
        let (two, zero) = (L::splat(TWO), L::splat(ZERO));
        let fast = (-two * self.free).mul_add(self.start, self.speed * self.speed).max(zero).sqrt();
        let late = -two * self.start / (self.speed + fast).max(L::splat(LEAST));
        (late.min(L::splat(ONE)), fast)
    }

    /// Where the tip is after such a share of the step, from `t1` on at this pace, the force having `held` it.
    #[inline(always)]
    fn ahead(&self, (t1, pace): (L, L), left: L, held: L) -> L {
        (left * left).mul_add(L::splat(HALF).mul_add(self.free, -held), left.mul_add(pace, t1))
    }

    /// The share of the step after which the tip has gone back by `height`, the force having `held` it.
    #[inline(always)]
    fn fall(&self, height: L, held: L) -> L {
        let (two, zero) = (L::splat(TWO), L::splat(ZERO));
        let bent = (-two).mul_add(held, self.free);
        let fast = (-two * bent).mul_add(height, self.speed * self.speed).max(zero).sqrt();
        (two * height / (fast - self.speed).max(L::splat(LEAST))).min(L::splat(ONE))
    }
}

impl<L: Lane> Jkr<L> {
    /// Impulse of a part that takes this share of the step: off its chord by the path's own bend over it.
    #[inline(always)]
    fn impulse(&self, part: &Part<L>, share: L, acceleration: L) -> L {
        let pull = self.unit_force * self.inverse_unit;
        let force = self.unit_force * part.mean;
        let bend = acceleration - force;
        let slope = (part.slope * pull).max(L::splat(JKR_STEEPEST)) * L::splat(TWELFTH);
        let roots = (part.roots * part.roots).max((bend * self.inverse_unit).abs());
        let lean = slope - L::splat(TENTH) * pull * part.bow / roots;
        share * (-(bend * lean) * share).mul_add(share, force)
    }
}

impl<L: Lane> Interaction<L> for Jkr<L> {
    const FIELDS: &'static [&'static str] = &["unit_force", "inverse_unit"];
    const SHIFTS: bool = true;
    const ONLY_IN_CONTACT: bool = true;

    #[inline(always)]
    fn from_numbers(mut next: impl FnMut() -> L) -> Self {
        Self { unit_force: next(), inverse_unit: next() }
    }

    /// The part of the step in contact: from its start or from touch, to its end or to the fold. Lengths are in units of
    /// the fold until the impulse, which is of the kernel's again.
    #[inline(always)]
    fn kick(&self, at: Approach<L>, touching: L) -> Kick<L> {
        let zero = L::splat(ZERO);
        let was = zero.less(touching);
        when(
            L::either(was, at.may_touch()),
            Kick::none(),
            #[inline(always)]
            || self.near(at, was),
        )
    }
}

impl<L: Lane> Jkr<L> {
    /// The kick where the tip was in contact or comes near it.
    #[inline(always)]
    fn near(&self, at: Approach<L>, was: L::Mask) -> Kick<L> {
        let (zero, half) = (L::splat(ZERO), L::splat(HALF));
        let path = FreePath::of(at, self.inverse_unit);
        let end = half.mul_add(path.free, path.start + path.speed);
        // Already inside at the start of the piece: touched in the gap between two pieces.
        let begins = L::either(was, zero.less(path.start));
        let touches = L::both(L::not(begins), zero.less(end));
        when(
            L::either(begins, touches),
            Kick::none(),
            #[inline(always)]
            || self.held(at, path, (begins, touches)),
        )
    }

    /// The kick where there is contact in the step: since before it, or from a touch within it.
    #[inline(always)]
    fn held(&self, at: Approach<L>, path: FreePath<L>, (begins, touches): (L::Mask, L::Mask)) -> Kick<L> {
        let (zero, one, half, three) = (L::splat(ZERO), L::splat(ONE), L::splat(HALF), L::splat(THREE));
        let acting = L::either(begins, touches);
        let FreePath { speed, start, .. } = path;
        let pull = self.unit_force * self.inverse_unit;
        let twelfth = L::splat(TWELFTH);
        // The stepped path lies off the true one by a 12th of the force (docs/method.md).
        let near = Point::roughly(start + three);
        let t1 = L::select(touches, three, pull * twelfth * near.force + start + three);
        let begun = Passage { point: Point::at(t1), share: zero, pace: speed };
        let Passage { point: from, share: late, pace } = when(
            touches,
            begun,
            #[inline(always)]
            || {
                // Touch divides the step where the free path says.
                let point = Point::of(L::splat(JKR_TOUCH_ROOT), L::splat(JKR_TOUCH));
                let (share, pace) = path.touch();
                let touch = Passage { point, share, pace };
                touch.zip(begun, &mut |yes, no| L::select(touches, yes, no))
            },
        );
        let left = one - late;
        let near = Point::roughly(path.ahead((t1, pace), left, half * pull * from.force));
        let guess = Part::between(from, near);
        let held = pull * half.mul_add(guess.mean, -guess.moment);
        let t2 = path.ahead((t1, pace), left, held);
        let lets_go = L::both(begins, L::either(t2.less(zero), t1.less(zero)));
        let ended = Passage { point: Point::at(t2), share: left, pace };
        let Passage { point: to, share, .. } = when(
            lets_go,
            ended,
            #[inline(always)]
            || {
                // The fold divides it where the path under the force does.
                let share = path.fall(t1.max(zero), held);
                let fold = Passage { point: Point::of(zero, zero), share, pace };
                fold.zip(ended, &mut |yes, no| L::select(lets_go, yes, no))
            },
        );
        let part = Part::between(from, to);
        let impulse = self.impulse(&part, share, at.acceleration);
        let middle = L::select(lets_go, -half, half) * (one - share);
        let moment = impulse.mul_add(middle, share * share * (self.unit_force * part.moment));
        let before = L::select(touches, zero, from.force);
        let after = L::select(lets_go, zero, to.force);
        let shift = (self.unit_force * twelfth).mul_add(after - before, -moment);
        Kick {
            impulse: L::select(acting, impulse, zero),
            shift: L::select(acting, shift, zero),
            contact: L::select(acting, share, zero),
            touching: L::select(L::both(acting, L::not(lets_go)), one, zero),
            ..Kick::none()
        }
    }
}

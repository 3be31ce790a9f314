//! A contact with what acts beside it, one of which is a force that remembers: it acts from where it forms on the way in to
//! where it breaks on the way out (docs/method.md). So do a liquid neck, and a table whose way out differs from its way in.

use super::dmt::{Beside, TermMean};
use super::path::Path;
use super::sum::{FIELDS as SUM_FIELDS, ForceSum, TERMS, Term};
use super::{Approach, Interaction, Kick, Lane, Zip, when};
use crate::constants::{EIGHTH, HALF, LEAST, ONE, SIXTH, THIRD, TWELFTH, TWO, ZERO};

/// The last of the terms is the one that remembers.
const OTHERS: usize = TERMS - 1;

/// A sum with a force that remembers.
#[derive(Clone, Copy, Debug)]
pub struct HystereticSum<L> {
    others: ForceSum<L, OTHERS>,
    neck: Neck<L>,
}

/// A force that acts from where it forms, an indentation passed inward, to where it breaks, one passed outward.
#[derive(Clone, Copy, Debug)]
struct Neck<L> {
    pull: Term<L>,
    forms: L,
    breaks: L,
}

/// What forming or breaking within the step makes of it.
#[derive(Clone, Copy)]
struct NeckEvent<L> {
    /// 1 where there is one.
    happens: L,
    /// Of the neck's force, over its part of the step.
    impulse: L,
    shift: L,
    /// How far the tip is, in the mean, from where it would be if that impulse were spread evenly.
    ahead: L,
}

impl<L: Lane> Zip<L> for NeckEvent<L> {
    #[inline(always)]
    fn zip(self, other: Self, join: &mut dyn FnMut(L, L) -> L) -> Self {
        Self {
            happens: join(self.happens, other.happens),
            impulse: join(self.impulse, other.impulse),
            shift: join(self.shift, other.shift),
            ahead: join(self.ahead, other.ahead),
        }
    }
}

impl<L: Lane> NeckEvent<L> {
    #[inline(always)]
    fn none() -> Self {
        let zero = L::splat(ZERO);
        Self { happens: zero, impulse: zero, shift: zero, ahead: zero }
    }

    #[inline(always)]
    fn select(mask: L::Mask, yes: Self, no: Self) -> Self {
        yes.zip(no, &mut |yes, no| L::select(mask, yes, no))
    }
}

/// The other forces with the neck's, where it holds all through the step, and its impulse where it does so in a part.
struct Joined<'a, L: Lane> {
    sum: &'a HystereticSum<L>,
    holds: L::Mask,
    impulse: L,
}

impl<L: Lane> Beside<L> for Joined<'_, L> {
    #[inline(always)]
    fn sampled(&self, contact: L, indentation: L) -> L {
        let zero = L::splat(ZERO);
        let pull = when(
            self.holds,
            zero,
            #[inline(always)]
            || L::select(self.holds, self.sum.neck.pull.sample(indentation), zero),
        );
        self.sum.others.terms.sampled(contact, indentation) + (pull + self.impulse)
    }

    #[inline(always)]
    fn along(&self, path: Path<L>) -> Option<TermMean<L>> {
        let zero = L::splat(ZERO);
        let none = TermMean { force: zero, slope: zero, lean: zero };
        let held = when(
            self.holds,
            none,
            #[inline(always)]
            || {
                let all = self.sum.neck.pull.along(path);
                all.zip(none, &mut |held, none| L::select(self.holds, held, none))
            },
        );
        let others = self.sum.others.terms.along(path)?;
        Some(TermMean {
            force: others.force + (held.force + self.impulse),
            slope: others.slope + held.slope,
            lean: others.lean + held.lean,
        })
    }
}

/// Where the next event is, and whether the neck holds before it.
#[derive(Clone, Copy)]
struct Awaited<L: Lane> {
    held: L::Mask,
    level: L,
}

impl<L: Lane> HystereticSum<L> {
    /// The force before the event.
    #[inline(always)]
    fn before(&self, awaited: Awaited<L>, indentation: L) -> L {
        let pull = self.neck.pull.sample(indentation);
        self.others.sample(indentation) + L::select(awaited.held, pull, L::splat(ZERO))
    }

    /// Forming or breaking, if the path under the force meets it within the step.
    #[inline(always)]
    fn event(&self, at: Approach<L>, awaited: Awaited<L>) -> NeckEvent<L> {
        let (zero, one, half, two) = (L::splat(ZERO), L::splat(ONE), L::splat(HALF), L::splat(TWO));
        let Awaited { held, level } = awaited;
        // The path from the step's start on; the stepped path lies off the true one by a 12th of the force.
        let pace = (-half).mul_add(at.acceleration, at.speed);
        let free = (-half).mul_add(at.speed, L::splat(EIGHTH).mul_add(at.acceleration, at.indentation));
        let force = self.before(awaited, free);
        let start = L::splat(TWELFTH).mul_add(force, free);
        // On the way to the event the force changes evenly.
        let bend = at.acceleration - L::splat(THIRD) * two.mul_add(force, self.before(awaited, level));
        let way = L::select(held, start - level, level - start);
        let pace_there = L::select(held, -pace, pace);
        let bend_there = L::select(held, -bend, bend);
        let square = (two * bend_there).mul_add(way, pace_there * pace_there);
        let sum = pace_there + square.max(zero).sqrt();
        let past = L::not(zero.less(way));
        let met = L::both(L::not(square.less(zero)), (two * way).less(sum));
        let happens = L::either(past, met);
        let late = L::select(past, zero, (two * way / sum.max(L::splat(LEAST))).min(one));
        // The neck's part of the step: up to the event, or from it on.
        let share = L::select(held, late, one - late);
        let begun = L::select(held, start, level.max(start));
        let pull = self.neck.pull.sample(begun);
        let bend = L::select(held, bend, bend - pull);
        let there = late.mul_add(bend, pace);
        let on = (half * bend * share).mul_add(share, there.mul_add(share, begun));
        let path = Path { start: begun, end: L::select(held, level.min(start), on) };
        let mean = self.neck.pull.along(path);
        let steep = L::splat(TWELFTH).mul_add(mean.slope, mean.lean);
        let square = share * share;
        // Off the chord by the path's own bend.
        let impulse = share * (-(bend * steep)).mul_add(square, mean.force);
        let middle = half * L::select(held, late - one, late);
        let moment = (square * (path.end - path.start)).mul_add(steep, impulse * middle);
        let last = self.neck.pull.sample(path.end);
        let (first, last) = (L::select(held, pull, zero), L::select(held, zero, last));
        let shift = L::splat(TWELFTH).mul_add(last - first, -moment);
        // What an impulse moves by the step's end it moves in the mean by a third of it, if it acts from the start.
        let (from, to) = (L::select(held, one, share), L::select(held, one - share, zero));
        let cubes = (from * from).mul_add(from, -(to * to * to));
        let moved = L::splat(SIXTH) * mean.force * cubes;
        let ahead = L::splat(TWELFTH).mul_add(first + impulse, -moved);
        NeckEvent::select(happens, NeckEvent { happens: one, impulse, shift, ahead }, NeckEvent::none())
    }
}

/// As those of a sum without memory, and where the last term forms and breaks.
const FIELDS: [&str; SUM_FIELDS.len() + 2] = {
    let mut all = [""; SUM_FIELDS.len() + 2];
    let mut n = 0;
    while n < SUM_FIELDS.len() {
        all[n] = SUM_FIELDS[n];
        n += 1;
    }
    (all[n], all[n + 1]) = ("forms", "breaks");
    all
};

impl<L: Lane> Interaction<L> for HystereticSum<L> {
    const FIELDS: &'static [&'static str] = &FIELDS;
    const SHIFTS: bool = true;

    #[inline(always)]
    fn from_numbers(mut next: impl FnMut() -> L) -> Self {
        let others = ForceSum::of(&mut next);
        let pull = Term::from_numbers(&mut next);
        Self { others, neck: Neck { pull, forms: next(), breaks: next() } }
    }

    #[inline(always)]
    fn kick(&self, at: Approach<L>, touching: L) -> Kick<L> {
        let (zero, one) = (L::splat(ZERO), L::splat(ONE));
        let held = zero.less(touching);
        let awaited = Awaited { held, level: L::select(held, self.neck.breaks, self.neck.forms) };
        let reach = at.speed.abs() + at.acceleration.abs();
        let way = L::select(held, at.indentation - awaited.level, awaited.level - at.indentation);
        let near = way.less(reach);
        let event = when(
            near,
            NeckEvent::none(),
            #[inline(always)]
            || NeckEvent::select(near, self.event(at, awaited), NeckEvent::none()),
        );
        let happens = zero.less(event.happens);
        let holds = L::both(held, L::not(happens));
        let joined = Joined { sum: self, holds, impulse: event.impulse };
        let (kick, slope) = self.others.kick_with(&joined, at);
        let touching = L::select(happens, one - touching, touching);
        Kick {
            impulse: slope.mul_add(event.ahead, kick.impulse),
            shift: kick.shift + event.shift,
            touching,
            ..kick
        }
    }
}

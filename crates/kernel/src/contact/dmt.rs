//! Derjaguin, Muller & Toporov (1975): Hertz's force less a constant adhesion in contact, and
//! its decay with distance outside; equations (17), (18) of Ha, Fung & Chen 2005 in the form
//! that is continuous at first touch.

use super::hertz::{Elastic, Hertz, Mean};
use super::path::{Path, corrected};
use super::{Approach, Interaction, Kick, Lane, Zip, touching_at, when};
use crate::constants::{EIGHT, HALF, ONE, TAIL_1, TAIL_2, TAIL_POLE, THIRD, ZERO};

/// The attraction: `adhesion` is 2 pi R w as impulse per step; `inverse_decay` 1/D0 per unit of length.
#[derive(Clone, Copy, Debug)]
pub struct Tail<L> {
    pub adhesion: L,
    pub inverse_decay: L,
}

/// Hertz's contact under the attraction, or that of a tip of another shape.
#[derive(Clone, Copy, Debug)]
pub struct Dmt<L, E = Hertz<L>> {
    pub contact: E,
    pub tail: Tail<L>,
}

/// Mean of the attraction along a piece of path.
pub(super) struct TailPull<L> {
    fall: TailFall<L>,
    away: L,
    steep: L,
    /// Toward the sample, and how it falls with the distance.
    pub force: L,
    pub slope: L,
}

impl<L: Lane> Tail<L> {
    /// One and the distance from the surface in decay lengths; 1 in contact.
    #[inline(always)]
    pub(super) fn stretch(&self, indentation: L) -> L {
        (-indentation).max(L::splat(ZERO)).mul_add(self.inverse_decay, L::splat(ONE))
    }

    /// The attraction along a piece of path outside.
    #[inline(always)]
    pub(super) fn fall(&self, path: Path<L>) -> TailFall<L> {
        TailFall::between(self.stretch(path.start), self.stretch(path.end))
    }

    /// Mean along a piece of which this `share` is in contact: the tail's outside, 1 inside, by shares.
    #[inline(always)]
    pub(super) fn along(&self, fall: TailFall<L>, share: L) -> TailPull<L> {
        let one = L::splat(ONE);
        let away = one - share;
        let force = self.adhesion * share.mul_add(one - fall.mean, fall.mean);
        let steep = self.adhesion * self.inverse_decay * away;
        let slope = steep * fall.fall;
        TailPull { fall, away, steep, force, slope }
    }
}

/// The attraction 1/s^2 while s runs evenly from `a` to `b`, both at least 1, or in part of a step and is 1 in the rest.
pub(super) struct TailFall<L> {
    sum: L,
    step: L,
    mean: L,
    /// Minus the mean of its slope in s: (a + b)/(ab)^2.
    fall: L,
}

/// How far the tail is from a force that changes evenly over the step.
struct TailBend<L> {
    /// Minus the first moment of 1/s^2 about the middle of the step, less an even change's, over z.
    moment: L,
    /// z = (b - a)/(a + b), and 1/(a + b).
    lean: L,
    inverse_sum: L,
}

impl<L: Lane> TailFall<L> {
    #[inline(always)]
    fn between(a: L, b: L) -> Self {
        let mean = L::splat(ONE) / (a * b);
        let sum = a + b;
        Self { sum, step: b - a, mean, fall: sum * mean * mean }
    }

    /// Whether the step is long beside the distance.
    #[inline(always)]
    fn bends(&self) -> L::Mask {
        self.sum.less(L::splat(EIGHT) * self.step.abs())
    }

    /// `outside` is its share of the step, `inside` the rest.
    ///
    /// With c = (a + b)/2 the moment of 1/s^2 about its middle is -z p(z^2)/(ab), p(x) = (z - (1 - x) atanh z)/(2xz)
    /// = 1/3 + x/15 + x^2/35 + ... up to 1/2 (docs/method.md).
    #[inline(always)]
    fn bend(&self, outside: L, inside: L) -> TailBend<L> {
        let one = L::splat(ONE);
        // One quotient for two: 1/sum, and p's pole, 1/(1 + TAIL_POLE z^2) = sum^2/pole.
        let square = self.sum * self.sum;
        let pole = (L::splat(TAIL_POLE) * self.step).mul_add(self.step, square);
        let both = one / (pole * self.sum);
        let inverse_sum = pole * both;
        let lean = self.step * inverse_sum;
        let x = lean * lean;
        let above = L::splat(TAIL_2).mul_add(x, L::splat(TAIL_1)).mul_add(x, L::splat(THIRD));
        let p = above * (square * self.sum * both);
        let middle = L::splat(HALF) * self.sum;
        let moment = outside * outside.mul_add(p, inside * middle);
        let even = middle * middle * self.mean * L::splat(THIRD);
        TailBend { moment: self.mean * (moment - even), lean, inverse_sum }
    }
}

impl<L: Lane> TailPull<L> {
    /// Impulse and shift of a step whose force bends the path by `bending`, if the mean of the force alone gives `straight`.
    #[inline(always)]
    pub(super) fn bent(&self, (adhesion, bending): (L, L), share: L, straight: L) -> (L, L) {
        let zero = L::splat(ZERO);
        let bends = L::either(self.fall.bends(), zero.less(share));
        when(
            bends,
            (straight, zero),
            #[inline(always)]
            || {
                let bend = self.fall.bend(self.away, share);
                // The path bends too, and meets the force off the chord.
                let met = bending.mul_add(self.steep * bend.moment * bend.inverse_sum, straight);
                let shift = -(adhesion * bend.lean * bend.moment);
                (L::select(bends, met, straight), L::select(bends, shift, zero))
            },
        )
    }
}

/// Mean of a force beside contact and attraction along a piece of path.
#[derive(Clone, Copy)]
pub(super) struct TermMean<L> {
    pub force: L,
    pub slope: L,
    /// Its first moment about the middle of the step, less that of a force which changes evenly, over the length of the piece.
    pub lean: L,
}

impl<L: Lane> Zip<L> for TermMean<L> {
    #[inline(always)]
    fn zip(self, other: Self, join: &mut dyn FnMut(L, L) -> L) -> Self {
        Self {
            force: join(self.force, other.force),
            slope: join(self.slope, other.slope),
            lean: join(self.lean, other.lean),
        }
    }
}

/// What acts beside a contact and DMT's attraction.
pub(super) trait Beside<L> {
    /// The force of contact and attraction with it.
    fn sampled(&self, contact: L, indentation: L) -> L;

    /// Its mean along a piece of path, if there is any.
    fn along(&self, path: Path<L>) -> Option<TermMean<L>>;
}

/// Nothing.
impl<L> Beside<L> for () {
    #[inline(always)]
    fn sampled(&self, contact: L, _: L) -> L {
        contact
    }

    #[inline(always)]
    fn along(&self, _: Path<L>) -> Option<TermMean<L>> {
        None
    }
}

/// The force of a contact under the attraction at an indentation.
#[inline(always)]
pub(super) fn tail_sample<L: Lane, E: Elastic<L>>((contact, tail): (&E, &Tail<L>), indentation: L) -> L {
    let adhesion = tail.adhesion;
    let y = L::splat(ONE) / tail.stretch(indentation);
    when(
        L::splat(ZERO).less(indentation),
        -(adhesion * y * y),
        #[inline(always)]
        || (-(adhesion * y)).mul_add(y, contact.sample(indentation)),
    )
}

/// The kick of a contact under the attraction, with what acts beside them, and the mean slope of all these forces.
#[inline(always)]
pub(super) fn tail_kick<L: Lane, E: Elastic<L>>(
    (contact, tail): (&E, &Tail<L>),
    beside: &impl Beside<L>,
    at: Approach<L>,
) -> (Kick<L>, L) {
    let (zero, adhesion) = (L::splat(ZERO), tail.adhesion);
    let sample = tail_sample((contact, tail), at.indentation);
    let path = Path::around(at, beside.sampled(sample, at.indentation));
    let fall = tail.fall(path);
    let elastic = when(
        L::either(zero.less(path.start), zero.less(path.end)),
        Mean::none(),
        #[inline(always)]
        || contact.mean(path),
    );
    let pull = tail.along(fall, elastic.share);
    let (force, slope) = (elastic.force - pull.force, elastic.slope - pull.slope);
    let (impulse, shift, slope) = match beside.along(path) {
        None => {
            let straight = corrected(force, slope);
            let (impulse, shift) = pull.bent((adhesion, at.acceleration - force), elastic.share, straight);
            (impulse, shift, slope)
        }
        Some(term) => {
            let (force, slope) = (force + term.force, slope + term.slope);
            let straight = corrected(force, slope);
            let bending = at.acceleration - force;
            let (impulse, shift) = pull.bent((adhesion, bending), elastic.share, straight);
            let length = path.end - path.start;
            ((-bending).mul_add(term.lean, impulse), (-term.lean).mul_add(length, shift), slope)
        }
    };
    let touching = touching_at(path.end);
    (Kick { impulse, shift, contact: elastic.share, touching, ..Kick::none() }, slope)
}

impl<L: Lane, E: Elastic<L>> Interaction<L> for Dmt<L, E> {
    const FIELDS: &'static [&'static str] = E::WITH_TAIL;
    const SHIFTS: bool = true;

    #[inline(always)]
    fn from_numbers(mut next: impl FnMut() -> L) -> Self {
        let contact = E::from_numbers(&mut next);
        Self { contact, tail: Tail { adhesion: next(), inverse_decay: next() } }
    }

    #[inline(always)]
    fn kick(&self, at: Approach<L>, _touching: L) -> Kick<L> {
        tail_kick((&self.contact, &self.tail), &(), at).0
    }
}

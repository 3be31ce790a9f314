//! A contact and what acts beside it: half-integer powers of the indentation, DMT's attraction, and up to four forces that are
//! tabulated (docs/method.md): electrostatic, double layer, hydration, a user's own.

use super::dmt::{Beside, Tail, TermMean, tail_kick, tail_sample};
use super::force_table::COLUMNS;
use super::path::Path;
use super::shaped::{POWERS, ShapedHertz};
use super::{Approach, Elastic, Interaction, Kick, Lane, when};
use crate::constants::{EIGHTH, EIGHTIETH, HALF, LEAST, ONE, ONE_120TH, QUARTER, THREE, TWELFTH, ZERO};

/// How many tabulated forces there may be.
pub const TERMS: usize = 4;

/// A tabulated force: `scale` as impulse per step, its table's unit of length, and the table's number.
#[derive(Clone, Copy, Debug)]
pub(super) struct Term<L> {
    scale: L,
    inverse_length: L,
    table: L,
}

/// Tabulated forces that act together.
#[derive(Clone, Copy, Debug)]
pub(super) struct Terms<L, const N: usize = TERMS>([Term<L>; N]);

/// A contact with what acts beside it.
#[derive(Clone, Copy, Debug)]
pub struct ForceSum<L, const N: usize = TERMS> {
    contact: ShapedHertz<L>,
    tail: Tail<L>,
    pub(super) terms: Terms<L, N>,
}

impl<L: Lane, const N: usize> ForceSum<L, N> {
    /// Of its constants, in the order of the fields.
    #[inline(always)]
    pub(super) fn of(mut next: impl FnMut() -> L) -> Self {
        let contact = <ShapedHertz<L> as Elastic<L>>::from_numbers(&mut next);
        let tail = Tail { adhesion: next(), inverse_decay: next() };
        Self { contact, tail, terms: Terms::from_numbers(next) }
    }

    /// The force at an indentation.
    #[inline(always)]
    pub(super) fn sample(&self, indentation: L) -> L {
        self.terms.sampled(tail_sample((&self.contact, &self.tail), indentation), indentation)
    }

    /// The kick, with what acts beside the contact, and the mean slope of all these forces.
    #[inline(always)]
    pub(super) fn kick_with(&self, beside: &impl Beside<L>, at: Approach<L>) -> (Kick<L>, L) {
        tail_kick((&self.contact, &self.tail), beside, at)
    }
}

/// A row of a table: from `at` to `next` the force is value + d (rise + d (square + d cube)), d from `at`; `work` and `moment`
/// are the integrals of the force and of force times x up to there.
#[derive(Clone, Copy)]
struct Cell<L> {
    at: L,
    next: L,
    value: L,
    rise: L,
    square: L,
    cube: L,
    work: L,
    moment: L,
    next_value: L,
    next_work: L,
    next_moment: L,
}

/// A piece of a cell.
struct Piece<L> {
    length: L,
    centre: L,
    mean: L,
    /// Mean slope.
    slope: L,
    /// Integral of the force times the distance from the centre.
    moment: L,
}

impl<L: Lane> Cell<L> {
    #[inline(always)]
    fn new(row: [L; COLUMNS]) -> Self {
        let [at, next, value, rise, square, cube, work, moment, next_value, next_work, next_moment] = row;
        Self { at, next, value, rise, square, cube, work, moment, next_value, next_work, next_moment }
    }

    #[inline(always)]
    fn value(&self, x: L) -> L {
        let d = x - self.at;
        self.cube.mul_add(d, self.square).mul_add(d, self.rise).mul_add(d, self.value)
    }

    /// Exact for a cubic.
    #[inline(always)]
    fn piece(&self, from: L, to: L) -> Piece<L> {
        let length = to - from;
        let centre = L::splat(HALF) * (from + to);
        let d = centre - self.at;
        let area = length * length;
        let bend = (L::splat(THREE) * self.cube).mul_add(d, self.square);
        let steep = (bend + self.square).mul_add(d, self.rise);
        let mean = (L::splat(TWELFTH) * area).mul_add(bend, self.value(centre));
        let slope = (L::splat(QUARTER) * self.cube).mul_add(area, steep);
        let moment = (L::splat(EIGHTIETH) * self.cube).mul_add(area, L::splat(TWELFTH) * steep);
        Piece { length, centre, mean, slope, moment: length * area * moment }
    }
}

impl<L: Lane> Term<L> {
    #[inline(always)]
    pub fn from_numbers(mut next: impl FnMut() -> L) -> Self {
        Self { scale: next(), inverse_length: next(), table: next() }
    }

    #[inline(always)]
    fn cell(&self, x: L) -> Cell<L> {
        Cell::new(x.look_up(self.table))
    }

    #[inline(always)]
    fn acts(&self) -> L::Mask {
        L::splat(ZERO).less(self.scale.abs())
    }

    #[inline(always)]
    pub fn sample(&self, indentation: L) -> L {
        let x = indentation * self.inverse_length;
        self.scale * self.cell(x).value(x)
    }

    /// Mean, slope and lean along a piece of path: pieces of the cells at its two ends, and sums of whole cells between.
    #[inline(always)]
    pub fn along(&self, path: Path<L>) -> TermMean<L> {
        let zero = L::splat(ZERO);
        let (start, end) = (path.start * self.inverse_length, path.end * self.inverse_length);
        let (low, high) = (start.min(end), start.max(end));
        let (first, last) = (self.cell(low), self.cell(high));
        let apart = first.at.less(last.at);
        let one = first.piece(low, high.min(first.next));
        let two = last.piece(L::select(apart, last.at, high), high);
        let (work, moment) = (last.work - first.next_work, last.moment - first.next_moment);
        let centre = L::splat(HALF) * (low + high);
        let inverse = L::splat(ONE) / (high - low).max(L::splat(LEAST));
        let (work_one, work_two) = (one.length * one.mean, two.length * two.mean);
        let work_all = work_one + work_two + L::select(apart, work, zero);
        let rise = one.length.mul_add(one.slope, two.length * two.slope)
            + L::select(apart, last.value - first.next_value, zero);
        let turn = (one.centre - centre).mul_add(work_one, one.moment)
            + (two.centre - centre).mul_add(work_two, two.moment)
            + L::select(apart, moment - centre * work, zero);
        let even = (turn * inverse).mul_add(inverse, -(L::splat(TWELFTH) * rise)) * inverse;
        // On a short piece across a knot this is a difference of almost equal numbers, and next to nothing.
        let width = L::splat(EIGHTH) * (first.next - first.at);
        let long = L::both(apart, width.less(high - low));
        let within = -(L::splat(ONE_120TH) * first.cube) * (one.length * one.length);
        let steep = self.scale * self.inverse_length;
        TermMean {
            force: self.scale * L::select(apart, work_all * inverse, one.mean),
            slope: steep * L::select(apart, rise * inverse, one.slope),
            lean: steep * L::select(long, even, within),
        }
    }
}

impl<L: Lane, const N: usize> Terms<L, N> {
    /// Of their constants, in the order of [`TERM_FIELDS`].
    #[inline(always)]
    pub(super) fn from_numbers(mut next: impl FnMut() -> L) -> Self {
        Self(std::array::from_fn(|_| Term::from_numbers(&mut next)))
    }

    /// What they come to along a piece of path.
    #[inline(always)]
    pub(super) fn mean(&self, path: Path<L>) -> TermMean<L> {
        let zero = L::splat(ZERO);
        let none = TermMean { force: zero, slope: zero, lean: zero };
        let mut sum = none;
        for term in &self.0 {
            let one = when(
                term.acts(),
                none,
                #[inline(always)]
                || term.along(path),
            );
            sum = TermMean {
                force: sum.force + one.force,
                slope: sum.slope + one.slope,
                lean: sum.lean + one.lean,
            };
        }
        sum
    }
}

impl<L: Lane, const N: usize> Beside<L> for Terms<L, N> {
    #[inline(always)]
    fn sampled(&self, contact: L, indentation: L) -> L {
        let mut sum = contact;
        for term in &self.0 {
            let zero = L::splat(ZERO);
            sum = sum
                + when(
                    term.acts(),
                    zero,
                    #[inline(always)]
                    || term.sample(indentation),
                );
        }
        sum
    }

    #[inline(always)]
    fn along(&self, path: Path<L>) -> Option<TermMean<L>> {
        Some(self.mean(path))
    }
}

/// Of each term three.
pub(super) const TERM_FIELDS: [&str; 3 * TERMS] = [
    "scale_0",
    "inverse_length_0",
    "table_0",
    "scale_1",
    "inverse_length_1",
    "table_1",
    "scale_2",
    "inverse_length_2",
    "table_2",
    "scale_3",
    "inverse_length_3",
    "table_3",
];

/// The powers and DMT's attraction, and the terms.
pub(super) const FIELDS: [&str; POWERS + 2 + TERM_FIELDS.len()] = {
    let contact = <ShapedHertz<f64> as Elastic<f64>>::WITH_TAIL;
    let mut all = [""; POWERS + 2 + TERM_FIELDS.len()];
    let mut n = 0;
    while n < all.len() {
        all[n] = if n < contact.len() { contact[n] } else { TERM_FIELDS[n - contact.len()] };
        n += 1;
    }
    all
};

impl<L: Lane> Interaction<L> for ForceSum<L> {
    const FIELDS: &'static [&'static str] = &FIELDS;
    const SHIFTS: bool = true;

    #[inline(always)]
    fn from_numbers(next: impl FnMut() -> L) -> Self {
        Self::of(next)
    }

    #[inline(always)]
    fn kick(&self, at: Approach<L>, _touching: L) -> Kick<L> {
        self.kick_with(&self.terms, at).0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::force_table::{ForceTable, Knot};

    /// Truth: the antiderivatives of a cubic, which is its own table. Within a cell, over a knot and over several, both ways.
    #[test]
    fn means_slopes_and_leans_are_those_of_the_antiderivatives() {
        let force = |x: f64| 0.3 * x.powi(3) - 0.7 * x * x + 0.2 * x + 1.1;
        let slope = |x: f64| 0.9 * x * x - 1.4 * x + 0.2;
        let knots = [-1.0, -0.4, -0.1, 0.3, 1.2].map(|x| Knot::smooth(x, force(x), slope(x)));
        let table = ForceTable::number(&knots).unwrap() as f64;
        let term = Term { scale: 2.0, inverse_length: 0.5, table };
        let work = |x: f64| 0.075 * x.powi(4) - 0.7 / 3.0 * x.powi(3) + 0.1 * x * x + 1.1 * x;
        let moment = |x: f64| 0.06 * x.powi(5) - 0.175 * x.powi(4) + 0.2 / 3.0 * x.powi(3) + 0.55 * x * x;
        for (start, end) in
            [(-0.9, -0.5), (-0.5, -0.9), (-0.45, -0.35), (-0.9, 1.1), (1.1, -0.9), (-0.2, 0.2)]
        {
            let mean = term.along(Path { start: 2.0 * start, end: 2.0 * end });
            let (length, middle) = (end - start, 0.5 * (start + end));
            let area = work(end) - work(start);
            let rise = force(end) - force(start);
            let turn = (moment(end) - moment(start) - middle * area) / (length * length);
            let close = |found: f64, truth: f64| assert!((found - truth).abs() < 1e-12, "{found} {truth}");
            close(mean.force, 2.0 * area / length);
            close(mean.slope, rise / length);
            close(mean.lean, (turn - rise / 12.0) / length);
            close(term.sample(2.0 * start), 2.0 * force(start));
        }
        // A tip that rests has the force and the slope there.
        let rests = term.along(Path { start: 0.4, end: 0.4 });
        assert_eq!(rests.lean, 0.0);
        assert!((rests.force - 2.0 * force(0.2)).abs() + (rests.slope - slope(0.2)).abs() < 1e-14);
    }
}

//! The tip's path over a step as a cubic through its ends, by indentation and rate.

use super::Lane;
use crate::constants::{LEAST, ONE, SIX, THREE, TWO, ZERO};

/// After a share x of the step the indentation is start + x (rate + x (bend + x twist)).
#[derive(Clone, Copy)]
pub(super) struct CubicPath<L> {
    start: L,
    rate: L,
    bend: L,
    twist: L,
}

impl<L: Lane> CubicPath<L> {
    /// Between indentations and rates at the step's start and end.
    #[inline(always)]
    pub fn between(start: (L, L), end: (L, L)) -> Self {
        let (two, way) = (L::splat(TWO), end.0 - start.0);
        let bend = L::splat(THREE) * way - two * start.1 - end.1;
        Self { start: start.0, rate: start.1, bend, twist: start.1 + end.1 - two * way }
    }

    /// Indentation, rate and acceleration after a share of the step.
    #[inline(always)]
    pub fn at(&self, share: L) -> [L; 3] {
        let (two, three) = (L::splat(TWO), L::splat(THREE));
        let rise = self.twist.mul_add(share, self.bend).mul_add(share, self.rate);
        let rate = (three * self.twist).mul_add(share, two * self.bend).mul_add(share, self.rate);
        let turn = two * (three * self.twist).mul_add(share, self.bend);
        [rise.mul_add(share, self.start), rate, turn]
    }

    /// How fast the acceleration changes.
    #[inline(always)]
    pub fn jerk(&self) -> L {
        L::splat(SIX) * self.twist
    }

    /// Where within the step the tip turns; an end where it does not.
    #[inline(always)]
    pub fn turn(&self) -> L {
        let (zero, one) = (L::splat(ZERO), L::splat(ONE));
        let (first, last) = (self.at(zero)[1], self.at(one)[1]);
        let turns = (first * last).less(zero);
        let mut share = first / L::select(turns, first - last, one);
        for _ in 0..2 {
            let [_, rate, turn] = self.at(share);
            let level = turn.abs().less(L::splat(LEAST));
            share = share - rate / L::select(level, one, turn);
        }
        L::select(turns, share.max(zero).min(one), zero)
    }
}

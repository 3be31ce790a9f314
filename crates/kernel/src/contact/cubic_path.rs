//! The tip's path over a step as a cubic through its ends, by indentation and rate.

use super::Lane;
use crate::constants::{EIGHTH, HALF, SIX, THREE, TWO};

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
}

/// Indentation and rate in the middle of a cubic through two points that are `span` steps apart.
#[inline(always)]
pub(super) fn midway<L: Lane>(from: (L, L), to: (L, L), span: f64) -> (L, L) {
    let (half, span) = (L::splat(HALF), L::splat(span));
    let indentation = half * (from.0 + to.0) + L::splat(EIGHTH) * span * (from.1 - to.1);
    let mean = (to.0 - from.0) / span;
    (indentation, mean + half * (mean - half * (from.1 + to.1)))
}

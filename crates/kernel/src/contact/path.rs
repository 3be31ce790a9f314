//! A straight piece of the tip's path, from half a step before a sample to half a step after it, for the laws without
//! memory; JKR follows the bent one.

use super::{Approach, Lane};
use crate::constants::{HALF, ONE, QUARTER, TWELFTH, TWENTY_FOURTH, ZERO};

/// The mean force with the commutator of kick and flow, of second order (docs/method.md).
#[inline(always)]
pub fn corrected<L: Lane>(force: L, slope: L) -> L {
    (-(force * slope)).mul_add(L::splat(TWELFTH), force)
}

/// Indentation at the two ends, in order of time.
#[derive(Clone, Copy, Debug)]
pub struct Path<L> {
    pub start: L,
    pub end: L,
}

impl<L: Lane> Path<L> {
    /// The chord through the sample at the mid-kick speed (`speed` before the kick less half the
    /// impulse), moved by a third of the sagitta of the force-free curve: then the mean along the
    /// chord is the mean over time to fourth order.
    #[inline(always)]
    pub fn around(at: Approach<L>, impulse: L) -> Self {
        let reach = (-L::splat(QUARTER)).mul_add(impulse, L::splat(HALF) * at.speed);
        let centre = at.acceleration.mul_add(L::splat(TWENTY_FOURTH), at.indentation);
        Self { start: centre - reach, end: centre + reach }
    }

    /// Share of the piece with positive indentation.
    #[inline(always)]
    pub fn share_inside(self) -> L {
        let zero = L::splat(ZERO);
        let low = self.start.min(self.end);
        let high = self.start.max(self.end);
        // high - low is positive wherever the quotient is used.
        let crossing = high / (high - low);
        let outside = L::select(high.less(zero), zero, crossing);
        L::select(low.less(zero), outside, L::splat(ONE))
    }
}

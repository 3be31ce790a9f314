//! A lane with its derivatives: what a kick written for any lane tells of its slope.

use super::Lane;
use super::constants::{HALF, LEAST, ONE, ZERO};
use super::contact::force_table::COLUMNS;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A number and its derivatives by the three numbers of an [`Approach`](super::contact::Approach), in their order.
///
/// The value goes through the operations of its lane in their order, so that it is what the lane alone gives, to the bit.
/// Where two numbers are compared, the derivatives are those of the one that is taken.
#[derive(Clone, Copy, Debug)]
pub struct Dual<L> {
    pub value: L,
    pub by: [L; 3],
}

impl<L: Lane> Dual<L> {
    /// A number that does not depend on the approach.
    #[inline(always)]
    pub fn constant(value: L) -> Self {
        Self { value, by: [L::splat(ZERO); 3] }
    }

    /// The n-th number of the approach itself.
    #[inline(always)]
    pub fn own(value: L, n: usize) -> Self {
        let mut by = [L::splat(ZERO); 3];
        by[n] = L::splat(ONE);
        Self { value, by }
    }

    #[inline(always)]
    fn each(value: L, by: impl Fn(usize) -> L) -> Self {
        Self { value, by: [by(0), by(1), by(2)] }
    }
}

impl<L: Lane> Add for Dual<L> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self::each(self.value + other.value, |n| self.by[n] + other.by[n])
    }
}

impl<L: Lane> Sub for Dual<L> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self::each(self.value - other.value, |n| self.by[n] - other.by[n])
    }
}

impl<L: Lane> Mul for Dual<L> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self::each(self.value * other.value, |n| self.by[n].mul_add(other.value, self.value * other.by[n]))
    }
}

impl<L: Lane> Div for Dual<L> {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        let inverse = L::splat(ONE) / other.value;
        Self::each(value, |n| (-value).mul_add(other.by[n], self.by[n]) * inverse)
    }
}

impl<L: Lane> Neg for Dual<L> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self::each(-self.value, |n| -self.by[n])
    }
}

impl<L: Lane> Lane for Dual<L> {
    type Mask = L::Mask;
    type Element = L::Element;
    const WIDTH: usize = L::WIDTH;

    fn gather(value: &dyn Fn(usize) -> f64) -> Self {
        Self::constant(L::gather(value))
    }
    #[inline(always)]
    fn lane(self, i: usize) -> f64 {
        self.value.lane(i)
    }
    #[inline(always)]
    fn load(from: &[L::Element]) -> Self {
        Self::constant(L::load(from))
    }
    #[inline(always)]
    fn store(self, to: &mut [L::Element]) {
        self.value.store(to);
    }
    #[inline(always)]
    fn element(value: f64) -> L::Element {
        L::element(value)
    }
    #[inline(always)]
    fn broadcast(element: L::Element) -> Self {
        Self::constant(L::broadcast(element))
    }
    #[inline(always)]
    fn splat(value: f64) -> Self {
        Self::constant(L::splat(value))
    }
    /// The root of nothing, which does not depend on anything where it is met, has the slope of a number next to nothing.
    #[inline(always)]
    fn sqrt(self) -> Self {
        let value = self.value.sqrt();
        let slope = L::splat(HALF) / value.max(L::splat(LEAST));
        Self::each(value, |n| self.by[n] * slope)
    }
    #[inline(always)]
    fn abs(self) -> Self {
        let negative = self.value.less(L::splat(ZERO));
        Self::each(self.value.abs(), |n| L::select(negative, -self.by[n], self.by[n]))
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        let own = self.value.less(other.value);
        Self::each(self.value.min(other.value), |n| L::select(own, self.by[n], other.by[n]))
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        let own = other.value.less(self.value);
        Self::each(self.value.max(other.value), |n| L::select(own, self.by[n], other.by[n]))
    }
    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        Self::each(self.value.mul_add(factor.value, term.value), |n| {
            self.by[n].mul_add(factor.value, self.value.mul_add(factor.by[n], term.by[n]))
        })
    }
    #[inline(always)]
    fn less(self, other: Self) -> L::Mask {
        self.value.less(other.value)
    }
    #[inline(always)]
    fn select(mask: L::Mask, yes: Self, no: Self) -> Self {
        Self::each(L::select(mask, yes.value, no.value), |n| L::select(mask, yes.by[n], no.by[n]))
    }
    #[inline(always)]
    fn both(a: L::Mask, b: L::Mask) -> L::Mask {
        L::both(a, b)
    }
    #[inline(always)]
    fn either(a: L::Mask, b: L::Mask) -> L::Mask {
        L::either(a, b)
    }
    #[inline(always)]
    fn not(a: L::Mask) -> L::Mask {
        L::not(a)
    }
    #[inline(always)]
    fn any(mask: L::Mask) -> bool {
        L::any(mask)
    }
    /// A table's rows do not depend on the approach.
    #[inline(always)]
    fn look_up(self, table: Self) -> [Self; COLUMNS] {
        self.value.look_up(table.value).map(
            #[inline(always)]
            |number| Self::constant(number),
        )
    }
    #[inline(always)]
    fn when<T>(
        mask: L::Mask,
        otherwise: T,
        work: impl FnOnce() -> T,
        zip: impl FnOnce(T, T, &mut dyn FnMut(Self, Self) -> Self) -> T,
    ) -> T {
        L::when(mask, otherwise, work, |otherwise, taken, join| {
            zip(otherwise, taken, &mut |a: Self, b: Self| {
                let value = join(a.value, b.value);
                Self { value, by: std::array::from_fn(|n| join(a.by[n], b.by[n])) }
            })
        })
    }
    #[inline(always)]
    fn run<R>(work: impl FnOnce() -> R) -> R {
        L::run(work)
    }
}

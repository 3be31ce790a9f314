//! Two lanes as one.

use super::Lane;
use super::contact::force_table::COLUMNS;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// Two lanes stepped together: while the operations of one wait for each other, the other's run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair<L>(L, L);

macro_rules! pair {
    ($($trait:ident $name:ident),*) => {
        $(impl<L: Lane> $trait for Pair<L> {
            type Output = Self;
            #[inline(always)]
            fn $name(self, other: Self) -> Self {
                Self(self.0.$name(other.0), self.1.$name(other.1))
            }
        })*
    };
}

pair!(Add add, Sub sub, Mul mul, Div div);

impl<L: Lane> Neg for Pair<L> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(-self.0, -self.1)
    }
}

impl<L: Lane> Lane for Pair<L> {
    type Mask = (L::Mask, L::Mask);
    type Element = L::Element;
    const WIDTH: usize = 2 * L::WIDTH;

    #[inline(never)]
    fn gather(value: &dyn Fn(usize) -> f64) -> Self {
        Self(L::gather(value), L::gather(&|i| value(L::WIDTH + i)))
    }
    #[inline(always)]
    fn lane(self, i: usize) -> f64 {
        if i < L::WIDTH { self.0.lane(i) } else { self.1.lane(i - L::WIDTH) }
    }
    #[inline(always)]
    fn load(from: &[L::Element]) -> Self {
        Self(L::load(from), L::load(&from[L::WIDTH..]))
    }
    #[inline(always)]
    fn store(self, to: &mut [L::Element]) {
        self.0.store(to);
        self.1.store(&mut to[L::WIDTH..]);
    }
    #[inline(always)]
    fn element(value: f64) -> L::Element {
        L::element(value)
    }
    #[inline(always)]
    fn broadcast(element: L::Element) -> Self {
        Self(L::broadcast(element), L::broadcast(element))
    }
    #[inline(always)]
    fn splat(value: f64) -> Self {
        Self(L::splat(value), L::splat(value))
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(self.0.sqrt(), self.1.sqrt())
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Self(self.0.abs(), self.1.abs())
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self(self.0.min(other.0), self.1.min(other.1))
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self(self.0.max(other.0), self.1.max(other.1))
    }
    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        Self(self.0.mul_add(factor.0, term.0), self.1.mul_add(factor.1, term.1))
    }
    #[inline(always)]
    fn less(self, other: Self) -> Self::Mask {
        (self.0.less(other.0), self.1.less(other.1))
    }
    #[inline(always)]
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self {
        Self(L::select(mask.0, yes.0, no.0), L::select(mask.1, yes.1, no.1))
    }
    #[inline(always)]
    fn both(a: Self::Mask, b: Self::Mask) -> Self::Mask {
        (L::both(a.0, b.0), L::both(a.1, b.1))
    }
    #[inline(always)]
    fn either(a: Self::Mask, b: Self::Mask) -> Self::Mask {
        (L::either(a.0, b.0), L::either(a.1, b.1))
    }
    #[inline(always)]
    fn not(a: Self::Mask) -> Self::Mask {
        (L::not(a.0), L::not(a.1))
    }
    #[inline(always)]
    fn any(mask: Self::Mask) -> bool {
        // One question for both, not two.
        L::any(mask.0) | L::any(mask.1)
    }
    #[inline(always)]
    fn look_up(self, table: Self) -> [Self; COLUMNS] {
        let (one, two) = (self.0.look_up(table.0), self.1.look_up(table.1));
        std::array::from_fn(
            #[inline(always)]
            |column| Self(one[column], two[column]),
        )
    }
    #[inline(always)]
    fn run<R>(work: impl FnOnce() -> R) -> R {
        L::run(work)
    }
}

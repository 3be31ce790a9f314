//! Lanes of one vector register of WebAssembly. Every operation rounds, so that the values are those of plain numbers, to the
//! bit.

use super::Lane;
use std::arch::wasm32::*;
use std::ops::{Add, Div, Mul, Neg, Sub};

macro_rules! operator {
    ($trait:ident, $method:ident, $op:ident) => {
        impl $trait for Two64 {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self($op(self.0, other.0))
            }
        }
    };
}

/// Two f64.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Two64(v128);

operator!(Add, add, f64x2_add);
operator!(Sub, sub, f64x2_sub);
operator!(Mul, mul, f64x2_mul);
operator!(Div, div, f64x2_div);

impl Neg for Two64 {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(f64x2_neg(self.0))
    }
}

impl Lane for Two64 {
    type Mask = v128;
    type Element = f64;
    const WIDTH: usize = 2;

    #[inline(never)]
    fn gather(value: &dyn Fn(usize) -> f64) -> Self {
        let all: [f64; 2] = std::array::from_fn(value);
        Self::load(&all)
    }
    #[inline(always)]
    fn lane(self, i: usize) -> f64 {
        let mut all = [0.0; 2];
        self.store(&mut all);
        all[i]
    }
    #[inline(always)]
    fn load(from: &[f64]) -> Self {
        let all = &from[..2];
        // SAFETY: the slice has a register's size, and loads need no alignment.
        Self(unsafe { v128_load(all.as_ptr().cast()) })
    }
    #[inline(always)]
    fn store(self, to: &mut [f64]) {
        let all = &mut to[..2];
        // SAFETY: the slice has a register's size, and stores need no alignment.
        unsafe { v128_store(all.as_mut_ptr().cast(), self.0) }
    }
    #[inline(always)]
    fn element(value: f64) -> f64 {
        value
    }
    #[inline(always)]
    fn broadcast(element: f64) -> Self {
        Self(f64x2_splat(element))
    }
    #[inline(always)]
    fn splat(value: f64) -> Self {
        Self(f64x2_splat(value))
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(f64x2_sqrt(self.0))
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Self(f64x2_abs(self.0))
    }
    // pmin(a, b) is b where b < a, else a.
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self(f64x2_pmin(other.0, self.0))
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self(f64x2_pmax(other.0, self.0))
    }
    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        self * factor + term
    }
    #[inline(always)]
    fn less(self, other: Self) -> v128 {
        f64x2_lt(self.0, other.0)
    }
    #[inline(always)]
    fn select(mask: v128, yes: Self, no: Self) -> Self {
        Self(v128_bitselect(yes.0, no.0, mask))
    }
    #[inline(always)]
    fn both(a: v128, b: v128) -> v128 {
        v128_and(a, b)
    }
    #[inline(always)]
    fn either(a: v128, b: v128) -> v128 {
        v128_or(a, b)
    }
    #[inline(always)]
    fn not(a: v128) -> v128 {
        v128_not(a)
    }
    #[inline(always)]
    fn any(mask: v128) -> bool {
        v128_any_true(mask)
    }
    crate::lane::look_up!(f64, 2);
}

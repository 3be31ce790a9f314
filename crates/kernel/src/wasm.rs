//! Lanes of one vector register of WebAssembly. Every operation rounds, so that the values are those of plain numbers, to the
//! bit.

use super::Lane;
use std::arch::wasm32::*;
use std::ops::{Add, Div, Mul, Neg, Sub};

macro_rules! register {
    (
        $(#[$doc:meta])* $name:ident: [$float:ty; $width:literal], splat $splat:ident, add $add:ident, sub $sub:ident,
        mul $mul:ident, div $div:ident, pmin $pmin:ident, pmax $pmax:ident, sqrt $sqrt:ident, abs $abs:ident,
        neg $neg:ident, less $less:ident
    ) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug)]
        pub(crate) struct $name(v128);

        register!(@op $name, Add, add, $add);
        register!(@op $name, Sub, sub, $sub);
        register!(@op $name, Mul, mul, $mul);
        register!(@op $name, Div, div, $div);

        impl Neg for $name {
            type Output = Self;
            #[inline(always)]
            fn neg(self) -> Self {
                Self($neg(self.0))
            }
        }

        impl Lane for $name {
            type Mask = v128;
            type Element = $float;
            const WIDTH: usize = $width;

            #[inline(never)]
            fn gather(value: &dyn Fn(usize) -> f64) -> Self {
                let all: [$float; $width] = std::array::from_fn(|i| value(i) as $float);
                Self::load(&all)
            }
            #[inline(always)]
            fn lane(self, i: usize) -> f64 {
                let mut all: [$float; $width] = [0.0; $width];
                self.store(&mut all);
                all[i].into()
            }
            #[inline(always)]
            fn load(from: &[$float]) -> Self {
                let all = &from[..$width];
                // SAFETY: the slice has a register's size, and loads need no alignment.
                Self(unsafe { v128_load(all.as_ptr().cast()) })
            }
            #[inline(always)]
            fn store(self, to: &mut [$float]) {
                let all = &mut to[..$width];
                // SAFETY: the slice has a register's size, and stores need no alignment.
                unsafe { v128_store(all.as_mut_ptr().cast(), self.0) }
            }
            #[inline(always)]
            fn element(value: f64) -> $float {
                value as $float
            }
            #[inline(always)]
            fn broadcast(element: $float) -> Self {
                Self($splat(element))
            }
            #[inline(always)]
            fn splat(value: f64) -> Self {
                Self($splat(value as $float))
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                Self($sqrt(self.0))
            }
            #[inline(always)]
            fn abs(self) -> Self {
                Self($abs(self.0))
            }
            // pmin(a, b) is b where b < a, else a.
            #[inline(always)]
            fn min(self, other: Self) -> Self {
                Self($pmin(other.0, self.0))
            }
            #[inline(always)]
            fn max(self, other: Self) -> Self {
                Self($pmax(other.0, self.0))
            }
            #[inline(always)]
            fn mul_add(self, factor: Self, term: Self) -> Self {
                self * factor + term
            }
            #[inline(always)]
            fn less(self, other: Self) -> v128 {
                $less(self.0, other.0)
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
            crate::lane::look_up!($float, $width);
        }
    };
    (@op $name:ident, $trait:ident, $method:ident, $op:ident) => {
        impl $trait for $name {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self($op(self.0, other.0))
            }
        }
    };
}

register!(
    /// Two f64.
    Two64: [f64; 2], splat f64x2_splat, add f64x2_add, sub f64x2_sub,
    mul f64x2_mul, div f64x2_div, pmin f64x2_pmin, pmax f64x2_pmax, sqrt f64x2_sqrt, abs f64x2_abs,
    neg f64x2_neg, less f64x2_lt
);
register!(
    /// Four f32.
    Four32: [f32; 4], splat f32x4_splat, add f32x4_add, sub f32x4_sub,
    mul f32x4_mul, div f32x4_div, pmin f32x4_pmin, pmax f32x4_pmax, sqrt f32x4_sqrt, abs f32x4_abs,
    neg f32x4_neg, less f32x4_lt
);

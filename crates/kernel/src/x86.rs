//! Lanes of one vector register of x86-64, with fused products and sums.
//!
//! Written with the processor's own instructions: what the compiler makes of loops over arrays depends on
//! which of them it recognises, and costs up to four times the speed. The values are those of
//! [`Pack`](super::Pack) with FUSED, to the bit.
//!
//! Safety: these lanes are known in the crate only, and only made where the processor has been asked for the
//! instructions (`lanes.rs`).

use super::Lane;
use std::arch::x86_64::*;
use std::ops::{Add, Div, Mul, Neg, Sub};

macro_rules! register {
    (
        $(#[$doc:meta])* $name:ident($register:ty): [$float:ty; $width:literal], $features:literal, $mask:ty;
        load $load:ident, store $store:ident, splat $splat:ident,
        add $add:ident, sub $sub:ident, mul $mul:ident, div $div:ident,
        min $min:ident, max $max:ident, sqrt $sqrt:ident, fused $fused:ident,
        bits $and_not:ident $xor:ident, less $less:expr, select $select:expr, masks $masks:ident
    ) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug)]
        pub(crate) struct $name($register);

        register!(@op $name, Add, add, $add);
        register!(@op $name, Sub, sub, $sub);
        register!(@op $name, Mul, mul, $mul);
        register!(@op $name, Div, div, $div);

        impl Neg for $name {
            type Output = Self;
            #[inline(always)]
            fn neg(self) -> Self {
                // SAFETY: as the module says.
                Self(unsafe { $xor(self.0, $splat(-0.0)) })
            }
        }

        impl Lane for $name {
            type Mask = $mask;
            type Element = $float;
            const WIDTH: usize = $width;

            #[inline(never)]
            fn gather(value: &dyn Fn(usize) -> f64) -> Self {
                let all: [$float; $width] = std::array::from_fn(|i| value(i) as $float);
                // SAFETY: as the module says; the array has a register's size.
                Self(unsafe { $load(all.as_ptr()) })
            }
            #[inline(always)]
            fn lane(self, i: usize) -> f64 {
                let mut all: [$float; $width] = [0.0; $width];
                // SAFETY: as the module says; the array has a register's size.
                unsafe { $store(all.as_mut_ptr(), self.0) };
                all[i].into()
            }
            #[inline(always)]
            fn load(from: &[$float]) -> Self {
                let all = &from[..$width];
                // SAFETY: as the module says; the slice has a register's size.
                Self(unsafe { $load(all.as_ptr()) })
            }
            #[inline(always)]
            fn store(self, to: &mut [$float]) {
                let all = &mut to[..$width];
                // SAFETY: as the module says; the slice has a register's size.
                unsafe { $store(all.as_mut_ptr(), self.0) };
            }
            #[inline(always)]
            fn element(value: f64) -> $float {
                value as $float
            }
            #[inline(always)]
            fn broadcast(element: $float) -> Self {
                // SAFETY: as the module says.
                Self(unsafe { $splat(element) })
            }
            #[inline(always)]
            fn splat(value: f64) -> Self {
                // SAFETY: as the module says.
                Self(unsafe { $splat(value as $float) })
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                // SAFETY: as the module says.
                Self(unsafe { $sqrt(self.0) })
            }
            #[inline(always)]
            fn abs(self) -> Self {
                // SAFETY: as the module says.
                Self(unsafe { $and_not($splat(-0.0), self.0) })
            }
            // Both take the second operand where the comparison is not true.
            #[inline(always)]
            fn min(self, other: Self) -> Self {
                // SAFETY: as the module says.
                Self(unsafe { $min(self.0, other.0) })
            }
            #[inline(always)]
            fn max(self, other: Self) -> Self {
                // SAFETY: as the module says.
                Self(unsafe { $max(self.0, other.0) })
            }
            #[inline(always)]
            fn mul_add(self, factor: Self, term: Self) -> Self {
                // SAFETY: as the module says.
                Self(unsafe { $fused(self.0, factor.0, term.0) })
            }
            #[inline(always)]
            fn less(self, other: Self) -> $mask {
                // SAFETY: as the module says.
                unsafe { $less(self.0, other.0) }
            }
            #[inline(always)]
            fn select(mask: $mask, yes: Self, no: Self) -> Self {
                // SAFETY: as the module says.
                Self(unsafe { $select(mask, yes.0, no.0) })
            }
            register!(@masks $masks, $mask);
            crate::lane::look_up!($float, $width);

            #[inline(always)]
            fn run<R>(work: impl FnOnce() -> R) -> R {
                #[target_feature(enable = $features)]
                fn on<R>(work: impl FnOnce() -> R) -> R {
                    work()
                }
                // SAFETY: as the module says.
                unsafe { on(work) }
            }
        }
    };
    (@op $name:ident, $trait:ident, $method:ident, $op:ident) => {
        impl $trait for $name {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                // SAFETY: as the module says.
                Self(unsafe { $op(self.0, other.0) })
            }
        }
    };
    (@masks bits, $mask:ty) => {
        #[inline(always)]
        fn both(a: $mask, b: $mask) -> $mask {
            a & b
        }
        #[inline(always)]
        fn either(a: $mask, b: $mask) -> $mask {
            a | b
        }
        #[inline(always)]
        fn not(a: $mask) -> $mask {
            !a
        }
        #[inline(always)]
        fn any(mask: $mask) -> bool {
            mask != 0
        }
    };
    (@masks single, $mask:ty) => {
        register!(@masks register, $mask, _mm256_and_ps, _mm256_or_ps, _mm256_andnot_ps, _mm256_movemask_ps,
            _mm256_castsi256_ps(_mm256_set1_epi32(-1)));
    };
    (@masks double, $mask:ty) => {
        register!(@masks register, $mask, _mm256_and_pd, _mm256_or_pd, _mm256_andnot_pd, _mm256_movemask_pd,
            _mm256_castsi256_pd(_mm256_set1_epi32(-1)));
    };
    (@masks register, $mask:ty, $and:ident, $or:ident, $and_not:ident, $gather:ident, $all:expr) => {
        #[inline(always)]
        fn both(a: $mask, b: $mask) -> $mask {
            // SAFETY: as the module says.
            unsafe { $and(a, b) }
        }
        #[inline(always)]
        fn either(a: $mask, b: $mask) -> $mask {
            // SAFETY: as the module says.
            unsafe { $or(a, b) }
        }
        #[inline(always)]
        fn not(a: $mask) -> $mask {
            // SAFETY: as the module says.
            unsafe { $and_not(a, $all) }
        }
        #[inline(always)]
        fn any(mask: $mask) -> bool {
            // SAFETY: as the module says.
            unsafe { $gather(mask) != 0 }
        }
    };
}

register! {
    /// Sixteen f32.
    Zmm32(__m512): [f32; 16], "avx512f,avx512dq,avx512vl,avx2,fma", __mmask16;
    load _mm512_loadu_ps, store _mm512_storeu_ps, splat _mm512_set1_ps,
    add _mm512_add_ps, sub _mm512_sub_ps, mul _mm512_mul_ps, div _mm512_div_ps,
    min _mm512_min_ps, max _mm512_max_ps, sqrt _mm512_sqrt_ps, fused _mm512_fmadd_ps,
    bits _mm512_andnot_ps _mm512_xor_ps, less |a, b| _mm512_cmp_ps_mask::<_CMP_LT_OQ>(a, b),
    select |mask, yes, no| _mm512_mask_blend_ps(mask, no, yes), masks bits
}

register! {
    /// Eight f64.
    Zmm64(__m512d): [f64; 8], "avx512f,avx512dq,avx512vl,avx2,fma", __mmask8;
    load _mm512_loadu_pd, store _mm512_storeu_pd, splat _mm512_set1_pd,
    add _mm512_add_pd, sub _mm512_sub_pd, mul _mm512_mul_pd, div _mm512_div_pd,
    min _mm512_min_pd, max _mm512_max_pd, sqrt _mm512_sqrt_pd, fused _mm512_fmadd_pd,
    bits _mm512_andnot_pd _mm512_xor_pd, less |a, b| _mm512_cmp_pd_mask::<_CMP_LT_OQ>(a, b),
    select |mask, yes, no| _mm512_mask_blend_pd(mask, no, yes), masks bits
}

register! {
    /// Eight f32.
    Ymm32(__m256): [f32; 8], "avx2,fma", __m256;
    load _mm256_loadu_ps, store _mm256_storeu_ps, splat _mm256_set1_ps,
    add _mm256_add_ps, sub _mm256_sub_ps, mul _mm256_mul_ps, div _mm256_div_ps,
    min _mm256_min_ps, max _mm256_max_ps, sqrt _mm256_sqrt_ps, fused _mm256_fmadd_ps,
    bits _mm256_andnot_ps _mm256_xor_ps, less |a, b| _mm256_cmp_ps::<_CMP_LT_OQ>(a, b),
    select |mask, yes, no| _mm256_blendv_ps(no, yes, mask), masks single
}

register! {
    /// Four f64.
    Ymm64(__m256d): [f64; 4], "avx2,fma", __m256d;
    load _mm256_loadu_pd, store _mm256_storeu_pd, splat _mm256_set1_pd,
    add _mm256_add_pd, sub _mm256_sub_pd, mul _mm256_mul_pd, div _mm256_div_pd,
    min _mm256_min_pd, max _mm256_max_pd, sqrt _mm256_sqrt_pd, fused _mm256_fmadd_pd,
    bits _mm256_andnot_pd _mm256_xor_pd, less |a, b| _mm256_cmp_pd::<_CMP_LT_OQ>(a, b),
    select |mask, yes, no| _mm256_blendv_pd(no, yes, mask), masks double
}

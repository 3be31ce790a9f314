//! Which lanes the CPU engine steps with, by precision and by what the processor can do.

use crate::kernel::Lane;
#[cfg(target_arch = "aarch64")]
use crate::kernel::Pack;
#[cfg(target_arch = "x86_64")]
use crate::kernel::{Pair, Ymm32, Ymm64, Zmm32, Zmm64};
use crate::plan::Precision;

/// Lanes of one precision and one set of instructions.
pub(super) trait Family {
    /// One number of theirs.
    type Element: Lane<Element = Self::Element>;
    /// For laws and levers that keep the processor busy by themselves.
    type Narrow: Lane<Element = Self::Element> + 'static;
    /// For those that often wait for their own results: two at a time.
    type Wide: Lane<Element = Self::Element> + 'static;
}

impl<E, A, B> Family for (A, B)
where
    E: Lane<Element = E>,
    A: Lane<Element = E> + 'static,
    B: Lane<Element = E> + 'static,
{
    type Element = E;
    type Narrow = A;
    type Wide = B;
}

/// Something to be done with one family of lanes or another.
pub(super) trait Stepping {
    type Output;
    fn with<F: Family>(self) -> Self::Output;
}

/// Instructions that the kernel is compiled for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Instructions {
    /// What each 64-bit ARM has.
    #[cfg(target_arch = "aarch64")]
    Neon,
    /// AVX2 and FMA of x86-64.
    #[cfg(target_arch = "x86_64")]
    Avx2,
    /// And AVX-512 F, DQ and VL.
    #[cfg(target_arch = "x86_64")]
    Avx512,
}

/// How the CPU engine may compute.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Rounding {
    /// Sums of products round once, with these instructions at most.
    Fused(Instructions),
    /// Every operation rounds, as in the shader's text.
    Strict,
}

impl Rounding {
    /// The best that this processor has; where it fuses nothing, every operation rounds.
    pub fn new(strict: bool) -> Self {
        if strict { Self::Strict } else { fused().map_or(Self::Strict, Self::Fused) }
    }

    /// The same bits by fewer lanes, for one instance alone.
    pub fn least(self) -> Self {
        match self {
            #[cfg(target_arch = "x86_64")]
            Self::Fused(Instructions::Avx512) => Self::Fused(Instructions::Avx2),
            other => other,
        }
    }
}

#[cfg(target_arch = "x86_64")]
fn fused() -> Option<Instructions> {
    let wide = is_x86_feature_detected!("avx512f")
        && is_x86_feature_detected!("avx512dq")
        && is_x86_feature_detected!("avx512vl");
    let narrow = is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma");
    narrow.then_some(if wide { Instructions::Avx512 } else { Instructions::Avx2 })
}

#[cfg(target_arch = "aarch64")]
fn fused() -> Option<Instructions> {
    Some(Instructions::Neon)
}

#[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
fn fused() -> Option<Instructions> {
    None
}

/// The instructions that [`Rounding::new`] finds, as they are known; none where nothing fuses.
pub(super) fn instructions() -> Option<&'static str> {
    fused().map(|instructions| match instructions {
        #[cfg(target_arch = "aarch64")]
        Instructions::Neon => "NEON",
        #[cfg(target_arch = "x86_64")]
        Instructions::Avx2 => "AVX2",
        #[cfg(target_arch = "x86_64")]
        Instructions::Avx512 => "AVX-512",
    })
}

/// Does it with the lanes for this precision.
pub(super) fn with<S: Stepping>(precision: Precision, rounding: Rounding, what: S) -> S::Output {
    match precision {
        Precision::F32 => with_single(rounding, what),
        Precision::F64 => with_double(rounding, what),
    }
}

fn with_single<S: Stepping>(rounding: Rounding, what: S) -> S::Output {
    match rounding {
        #[cfg(target_arch = "x86_64")]
        Rounding::Fused(Instructions::Avx512) => what.with::<(Zmm32, Pair<Zmm32>)>(),
        #[cfg(target_arch = "x86_64")]
        Rounding::Fused(Instructions::Avx2) => what.with::<(Pair<Ymm32>, Pair<Ymm32>)>(),
        #[cfg(target_arch = "aarch64")]
        Rounding::Fused(Instructions::Neon) => what.with::<(Pack<f32, 16, true>, Pack<f32, 16, true>)>(),
        Rounding::Strict => what.with::<(f32, f32)>(),
    }
}

/// Does it with the lanes of f64.
pub(super) fn with_double<S: Stepping>(rounding: Rounding, what: S) -> S::Output {
    match rounding {
        #[cfg(target_arch = "x86_64")]
        Rounding::Fused(Instructions::Avx512) => what.with::<(Zmm64, Pair<Zmm64>)>(),
        #[cfg(target_arch = "x86_64")]
        Rounding::Fused(Instructions::Avx2) => what.with::<(Pair<Ymm64>, Pair<Ymm64>)>(),
        #[cfg(target_arch = "aarch64")]
        Rounding::Fused(Instructions::Neon) => what.with::<(Pack<f64, 8, true>, Pack<f64, 8, true>)>(),
        Rounding::Strict => what.with::<(f64, f64)>(),
    }
}

#[cfg(test)]
mod tests;

//! Which lanes the CPU engine steps with, by precision and by what the processor can do.

use super::Lane;
#[cfg(target_arch = "aarch64")]
use super::Pack;
#[cfg(any(target_arch = "x86_64", target_feature = "simd128"))]
use super::pair::Pair;
#[cfg(target_feature = "simd128")]
use super::wasm::Two64;
#[cfg(target_arch = "x86_64")]
use super::x86::{Ymm32, Ymm64, Zmm32, Zmm64};
use std::sync::LazyLock;

/// Instructions that the kernel is compiled for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Instructions {
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

/// How the CPU may compute. Only [`Rounding::new`] makes one, so that no processor is given what it does not have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rounding(pub(crate) Fused);

/// Sums of products round once, with these instructions at most; or every operation rounds, as in the shader's text.
pub(crate) type Fused = Option<Instructions>;

impl Rounding {
    /// Every operation rounds.
    pub const STRICT: Self = Self(None);

    /// The best that this processor has; where it fuses nothing, or the environment says `twice` ([`ROUNDING_VARIABLE`]), every
    /// operation rounds.
    pub fn new(strict: bool) -> Self {
        Self(if strict { None } else { fused() })
    }

    /// Whether sums of products round once: elsewhere the bits are those of a shader.
    pub fn fuses(self) -> bool {
        self.0.is_some()
    }

    /// The same bits by fewer lanes, for one instance alone.
    pub fn least(self) -> Self {
        match self.0 {
            #[cfg(target_arch = "x86_64")]
            Some(Instructions::Avx512) => Self(Some(Instructions::Avx2)),
            other => Self(other),
        }
    }
}

/// The variable of the environment that says how often a sum of a product rounds: `once`, where the processor can, or `twice`.
pub const ROUNDING_VARIABLE: &str = "AFMSWEEP_ROUNDING";

fn fused() -> Fused {
    static TWICE: LazyLock<bool> =
        LazyLock::new(|| std::env::var_os(ROUNDING_VARIABLE).is_some_and(|told| told == "twice"));
    if *TWICE { None } else { detected() }
}

#[cfg(target_arch = "x86_64")]
fn detected() -> Fused {
    let wide = is_x86_feature_detected!("avx512f")
        && is_x86_feature_detected!("avx512dq")
        && is_x86_feature_detected!("avx512vl");
    let narrow = is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma");
    narrow.then_some(if wide { Instructions::Avx512 } else { Instructions::Avx2 })
}

#[cfg(target_arch = "aarch64")]
fn detected() -> Fused {
    Some(Instructions::Neon)
}

#[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
fn detected() -> Fused {
    None
}

/// The instructions that [`Rounding::new`] finds, as they are known; none where nothing fuses.
pub fn instructions() -> Option<&'static str> {
    fused().map(|instructions| match instructions {
        #[cfg(target_arch = "aarch64")]
        Instructions::Neon => "NEON",
        #[cfg(target_arch = "x86_64")]
        Instructions::Avx2 => "AVX2",
        #[cfg(target_arch = "x86_64")]
        Instructions::Avx512 => "AVX-512",
    })
}

/// Lanes of one precision, `E`, and one set of instructions.
pub(crate) trait Family<E> {
    /// For laws and levers that keep the processor busy by themselves.
    type Narrow: Lane<Element = E>;
    /// For those that often wait for their own results: two at a time.
    type Wide: Lane<Element = E>;
    /// Whether one loop over the modes serves all numbers of them: it costs lanes of a single instance 6 % of their speed,
    /// and writing them out a third of this crate's compile time.
    const LOOPS: bool;
}

impl<E, A: Lane<Element = E>, B: Lane<Element = E>> Family<E> for (A, B) {
    type Narrow = A;
    type Wide = B;
    const LOOPS: bool = A::WIDTH == 1;
}

/// Something to be done with one family of lanes or another.
pub(crate) trait WithLanes<E> {
    type Output;
    fn with<F: Family<E>>(self) -> Self::Output;
}

/// Does it with the lanes of f32.
pub(crate) fn with_single<S: WithLanes<f32>>(rounding: Rounding, what: S) -> S::Output {
    match rounding.0 {
        #[cfg(target_arch = "x86_64")]
        Some(Instructions::Avx512) => what.with::<(Zmm32, Pair<Zmm32>)>(),
        #[cfg(target_arch = "x86_64")]
        Some(Instructions::Avx2) => what.with::<(Pair<Ymm32>, Pair<Ymm32>)>(),
        #[cfg(target_arch = "aarch64")]
        Some(Instructions::Neon) => what.with::<(Pack<f32, 16, true>, Pack<f32, 16, true>)>(),
        // In a web page too: it computes in f64, and lanes of f32 would only lengthen its engine.
        None => what.with::<(f32, f32)>(),
    }
}

/// Does it with the lanes of f64.
pub(crate) fn with_double<S: WithLanes<f64>>(rounding: Rounding, what: S) -> S::Output {
    match rounding.0 {
        #[cfg(target_arch = "x86_64")]
        Some(Instructions::Avx512) => what.with::<(Zmm64, Pair<Zmm64>)>(),
        #[cfg(target_arch = "x86_64")]
        Some(Instructions::Avx2) => what.with::<(Pair<Ymm64>, Pair<Ymm64>)>(),
        #[cfg(target_arch = "aarch64")]
        Some(Instructions::Neon) => what.with::<(Pack<f64, 8, true>, Pack<f64, 8, true>)>(),
        #[cfg(target_feature = "simd128")]
        None => what.with::<(Two64, Pair<Two64>)>(),
        #[cfg(not(target_feature = "simd128"))]
        None => what.with::<(f64, f64)>(),
    }
}

/// Does `work` compiled for the widest registers of this processor, if what it calls is inlined. Nothing is fused that its code
/// does not fuse, so the bits are those of any other registers.
#[inline]
pub fn vectorized<R>(work: impl FnOnce() -> R) -> R {
    with_double(Rounding::new(false), Vectorized(work))
}

struct Vectorized<W>(W);

impl<R, W: FnOnce() -> R> WithLanes<f64> for Vectorized<W> {
    type Output = R;

    #[inline]
    fn with<F: Family<f64>>(self) -> R {
        F::Narrow::run(self.0)
    }
}

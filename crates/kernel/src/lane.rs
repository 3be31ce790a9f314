//! The arithmetic the kernel is written in: one number, or a vector of them, per instance.

use crate::contact::force_table::COLUMNS;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A value per instance. Only operations that a shader has too are offered.
pub trait Lane:
    Copy
    + Send
    + Sync
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// A truth value per instance.
    type Mask: Copy;
    /// One instance's number.
    type Element: Copy + Send + Sync + Into<f64>;
    /// Instances held.
    const WIDTH: usize;

    /// `value(i)` for instance i, rounded to the lane's precision.
    fn from_lanes(value: impl Fn(usize) -> f64) -> Self {
        Self::gather(&value)
    }
    /// The same, compiled once for all: nothing that is done often.
    fn gather(value: &dyn Fn(usize) -> f64) -> Self;
    /// The number of instance i, below [`Lane::WIDTH`].
    fn lane(self, i: usize) -> f64;
    /// The first [`Lane::WIDTH`] numbers.
    fn load(from: &[Self::Element]) -> Self;
    /// All numbers, into the first [`Lane::WIDTH`] places.
    fn store(self, to: &mut [Self::Element]);
    /// A number rounded to the lane's precision, for a table that all instances read.
    fn element(value: f64) -> Self::Element;
    /// The same number everywhere.
    fn broadcast(element: Self::Element) -> Self;

    /// The same number everywhere, rounded to the lane's precision.
    fn splat(value: f64) -> Self;
    fn sqrt(self) -> Self;
    fn abs(self) -> Self;
    fn min(self, other: Self) -> Self;
    fn max(self, other: Self) -> Self;
    /// `self * factor + term`; whether the product is rounded before the sum is the lane's nature.
    fn mul_add(self, factor: Self, term: Self) -> Self;
    fn less(self, other: Self) -> Self::Mask;
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;
    fn both(a: Self::Mask, b: Self::Mask) -> Self::Mask;
    fn either(a: Self::Mask, b: Self::Mask) -> Self::Mask;
    fn not(a: Self::Mask) -> Self::Mask;
    fn any(mask: Self::Mask) -> bool;

    /// `work()` where some instance is in the mask, else `otherwise`. For an instance outside the mask the work must
    /// give what `otherwise` is, or what nobody reads: lanes skip the work, they do not choose between the two, and
    /// one that writes a shader makes a branch of it (`zip` pairs the numbers of the two). [`when`] is how laws say it.
    #[inline(always)]
    fn when<T>(
        mask: Self::Mask,
        otherwise: T,
        work: impl FnOnce() -> T,
        _zip: impl FnOnce(T, T, &mut dyn FnMut(Self, Self) -> Self) -> T,
    ) -> T {
        if Self::any(mask) { work() } else { otherwise }
    }

    /// For each instance the row that holds its number in the force table whose number is `table`.
    fn look_up(self, table: Self) -> [Self; COLUMNS];

    /// Does `work` compiled for the instructions that the lane is made of, if what it calls is inlined.
    #[inline(always)]
    fn run<R>(work: impl FnOnce() -> R) -> R {
        work()
    }
}

/// Something made of numbers, which is taken apart and put together by them.
pub trait Zip<L> {
    /// Of each pair of numbers, one of this and one of `other`, the number that `join` makes.
    fn zip(self, other: Self, join: &mut dyn FnMut(L, L) -> L) -> Self;
}

impl<L: Lane> Zip<L> for L {
    #[inline(always)]
    fn zip(self, other: Self, join: &mut dyn FnMut(L, L) -> L) -> Self {
        join(self, other)
    }
}

impl<L: Lane> Zip<L> for (L, L) {
    #[inline(always)]
    fn zip(self, other: Self, join: &mut dyn FnMut(L, L) -> L) -> Self {
        (join(self.0, other.0), join(self.1, other.1))
    }
}

/// [`Lane::when`] of anything made of numbers.
#[inline(always)]
pub fn when<L: Lane, T: Zip<L>>(mask: L::Mask, otherwise: T, work: impl FnOnce() -> T) -> T {
    L::when(mask, otherwise, work, |otherwise, taken, join| otherwise.zip(taken, join))
}

/// [`Lane::look_up`] of a lane of so many instances.
macro_rules! look_up {
    ($float:ty, $width:expr) => {
        #[inline(always)]
        fn look_up(self, table: Self) -> [Self; crate::contact::force_table::COLUMNS] {
            let (mut x, mut numbers): ([$float; $width], [$float; $width]) = ([0.0; $width], [0.0; $width]);
            self.store(&mut x);
            table.store(&mut numbers);
            let rows = crate::contact::force_table::columns((&x, &numbers), Self::element);
            let [a, b, c, d, e, f, g, h, i, j, k] = &rows;
            let load = Self::load;
            [
                load(a),
                load(b),
                load(c),
                load(d),
                load(e),
                load(f),
                load(g),
                load(h),
                load(i),
                load(j),
                load(k),
            ]
        }
    };
}
pub(crate) use look_up;

macro_rules! strict_scalar {
    ($float:ty) => {
        impl Lane for $float {
            type Mask = bool;
            type Element = $float;
            const WIDTH: usize = 1;

            #[inline(always)]
            fn gather(value: &dyn Fn(usize) -> f64) -> Self {
                value(0) as $float
            }
            #[inline(always)]
            fn lane(self, _: usize) -> f64 {
                self.into()
            }
            #[inline(always)]
            fn load(from: &[$float]) -> Self {
                from[0]
            }
            #[inline(always)]
            fn store(self, to: &mut [$float]) {
                to[0] = self;
            }
            #[inline(always)]
            fn element(value: f64) -> $float {
                value as $float
            }
            #[inline(always)]
            fn broadcast(element: $float) -> Self {
                element
            }
            #[inline(always)]
            fn splat(value: f64) -> Self {
                value as $float
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                <$float>::sqrt(self)
            }
            #[inline(always)]
            fn abs(self) -> Self {
                <$float>::abs(self)
            }
            // Comparisons rather than f64::min: a NaN operand gives the other one in both orders
            // there, which costs more and is not what shaders promise.
            #[inline(always)]
            fn min(self, other: Self) -> Self {
                if self < other { self } else { other }
            }
            #[inline(always)]
            fn max(self, other: Self) -> Self {
                if self > other { self } else { other }
            }
            #[inline(always)]
            fn mul_add(self, factor: Self, term: Self) -> Self {
                self * factor + term
            }
            #[inline(always)]
            fn less(self, other: Self) -> bool {
                self < other
            }
            #[inline(always)]
            fn select(mask: bool, yes: Self, no: Self) -> Self {
                if mask { yes } else { no }
            }
            #[inline(always)]
            fn both(a: bool, b: bool) -> bool {
                a & b
            }
            #[inline(always)]
            fn either(a: bool, b: bool) -> bool {
                a | b
            }
            #[inline(always)]
            fn not(a: bool) -> bool {
                !a
            }
            #[inline(always)]
            fn any(mask: bool) -> bool {
                mask
            }
            look_up!($float, 1);
        }
    };
}

strict_scalar!(f32);
strict_scalar!(f64);

/// Several instances side by side, for any processor; the same operations in the same order as one
/// alone, so the same bits. FUSED: a product and its sum round once; slow where there is no such instruction.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(64))]
pub struct Pack<T, const N: usize, const FUSED: bool>([T; N]);

macro_rules! pack {
    ($float:ty, $bits:ty, $width:literal) => {
        impl<const FUSED: bool> Pack<$float, $width, FUSED> {
            #[inline(always)]
            fn zip(self, other: Self, f: impl Fn($float, $float) -> $float) -> Self {
                let mut out = self.0;
                for i in 0..$width {
                    out[i] = f(self.0[i], other.0[i]);
                }
                Self(out)
            }
        }

        pack!(@op $float, $width, Add, add, |a, b| a + b);
        pack!(@op $float, $width, Sub, sub, |a, b| a - b);
        pack!(@op $float, $width, Mul, mul, |a, b| a * b);
        pack!(@op $float, $width, Div, div, |a, b| a / b);

        impl<const FUSED: bool> Neg for Pack<$float, $width, FUSED> {
            type Output = Self;
            #[inline(always)]
            fn neg(self) -> Self {
                Self(self.0.map(|a| -a))
            }
        }

        impl<const FUSED: bool> Lane for Pack<$float, $width, FUSED> {
            /// All bits set for true: select is then three bit operations on whole registers.
            type Mask = [$bits; $width];
            type Element = $float;
            const WIDTH: usize = $width;

            #[inline(never)]
            fn gather(value: &dyn Fn(usize) -> f64) -> Self {
                Self(std::array::from_fn(|i| value(i) as $float))
            }
            #[inline(always)]
            fn lane(self, i: usize) -> f64 {
                self.0[i].into()
            }
            #[inline(always)]
            fn load(from: &[$float]) -> Self {
                let mut out = [0.0; $width];
                out.copy_from_slice(&from[..$width]);
                Self(out)
            }
            #[inline(always)]
            fn store(self, to: &mut [$float]) {
                to[..$width].copy_from_slice(&self.0);
            }
            #[inline(always)]
            fn element(value: f64) -> $float {
                value as $float
            }
            #[inline(always)]
            fn broadcast(element: $float) -> Self {
                Self([element; $width])
            }
            #[inline(always)]
            fn splat(value: f64) -> Self {
                Self([value as $float; $width])
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                Self(self.0.map(|a| a.sqrt()))
            }
            #[inline(always)]
            fn abs(self) -> Self {
                Self(self.0.map(|a| a.abs()))
            }
            #[inline(always)]
            fn min(self, other: Self) -> Self {
                self.zip(other, |a, b| if a < b { a } else { b })
            }
            #[inline(always)]
            fn max(self, other: Self) -> Self {
                self.zip(other, |a, b| if a > b { a } else { b })
            }
            #[inline(always)]
            fn mul_add(self, factor: Self, term: Self) -> Self {
                if !FUSED {
                    return self * factor + term;
                }
                let mut out = self.0;
                for i in 0..$width {
                    out[i] = self.0[i].mul_add(factor.0[i], term.0[i]);
                }
                Self(out)
            }
            #[inline(always)]
            fn less(self, other: Self) -> Self::Mask {
                let mut out = [0; $width];
                for i in 0..$width {
                    out[i] = if self.0[i] < other.0[i] { <$bits>::MAX } else { 0 };
                }
                out
            }
            #[inline(always)]
            fn select(mask: Self::Mask, yes: Self, no: Self) -> Self {
                let mut out = no.0;
                for i in 0..$width {
                    out[i] = <$float>::from_bits(
                        (yes.0[i].to_bits() & mask[i]) | (no.0[i].to_bits() & !mask[i]),
                    );
                }
                Self(out)
            }
            #[inline(always)]
            fn both(a: Self::Mask, b: Self::Mask) -> Self::Mask {
                let mut out = a;
                for i in 0..$width {
                    out[i] &= b[i];
                }
                out
            }
            #[inline(always)]
            fn either(a: Self::Mask, b: Self::Mask) -> Self::Mask {
                let mut out = a;
                for i in 0..$width {
                    out[i] |= b[i];
                }
                out
            }
            #[inline(always)]
            fn not(a: Self::Mask) -> Self::Mask {
                a.map(|bits| !bits)
            }
            look_up!($float, $width);
            #[inline(always)]
            fn any(mask: Self::Mask) -> bool {
                mask.iter().fold(0, |all, bits| all | bits) != 0
            }
        }
    };
    (@op $float:ty, $width:literal, $trait:ident, $name:ident, $f:expr) => {
        impl<const FUSED: bool> $trait for Pack<$float, $width, FUSED> {
            type Output = Self;
            #[inline(always)]
            fn $name(self, other: Self) -> Self {
                self.zip(other, $f)
            }
        }
    };
}

pack!(f64, u64, 8);
pack!(f32, u32, 16);

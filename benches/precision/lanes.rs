//! Vectors of f64 for the hand-written Runge-Kutta method: `N` registers of eight, fused multiply-add.

use std::ops::{Add, Mul, Sub};

/// Instances in a register.
pub const WIDTH: usize = 8;

#[derive(Clone, Copy)]
#[repr(align(64))]
pub struct Lanes<const N: usize>(pub [[f64; WIDTH]; N]);

impl<const N: usize> Lanes<N> {
    #[inline(always)]
    pub fn splat(value: f64) -> Self {
        Self([[value; WIDTH]; N])
    }

    #[inline(always)]
    pub fn from_lanes(value: impl Fn(usize) -> f64) -> Self {
        Self(std::array::from_fn(|n| std::array::from_fn(|i| value(n * WIDTH + i))))
    }

    #[inline(always)]
    pub fn lane(&self, i: usize) -> f64 {
        self.0[i / WIDTH][i % WIDTH]
    }

    #[inline(always)]
    fn zip(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        let mut out = self;
        for n in 0..N {
            for i in 0..WIDTH {
                out.0[n][i] = f(self.0[n][i], other.0[n][i]);
            }
        }
        out
    }

    /// `self * factor + term`, rounded once.
    #[inline(always)]
    pub fn fma(self, factor: Self, term: Self) -> Self {
        let mut out = self;
        for n in 0..N {
            for i in 0..WIDTH {
                out.0[n][i] = self.0[n][i].mul_add(factor.0[n][i], term.0[n][i]);
            }
        }
        out
    }

    /// The same with one factor for all.
    #[inline(always)]
    pub fn scaled(self, factor: f64, term: Self) -> Self {
        self.fma(Self::splat(factor), term)
    }

    /// A loop: through `array::map` it may stay a call, for which every register is saved.
    #[inline(always)]
    pub fn sqrt(self) -> Self {
        self.zip(self, |a, _| a.sqrt())
    }

    #[inline(always)]
    pub fn max(self, other: Self) -> Self {
        self.zip(other, |a, b| if a > b { a } else { b })
    }

    #[inline(always)]
    pub fn min(self, other: Self) -> Self {
        self.zip(other, |a, b| if a < b { a } else { b })
    }

    #[inline(always)]
    pub fn over(self, other: Self) -> Self {
        self.zip(other, |a, b| a / b)
    }

    /// 1 where `self` is at least `other`, else 0.
    #[inline(always)]
    pub fn reaches(self, other: Self) -> Self {
        self.zip(other, |a, b| if a >= b { 1.0 } else { 0.0 })
    }

    /// Whether any of them is above zero.
    #[inline(always)]
    pub fn any(self) -> bool {
        let mut all = [false; WIDTH];
        for row in self.0 {
            for i in 0..WIDTH {
                all[i] |= row[i] > 0.0;
            }
        }
        all.iter().fold(false, |a, b| a | b)
    }
}

impl<const N: usize> Add for Lanes<N> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b)
    }
}

impl<const N: usize> Sub for Lanes<N> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.zip(other, |a, b| a - b)
    }
}

impl<const N: usize> Mul for Lanes<N> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.zip(other, |a, b| a * b)
    }
}

//! JKR's curve in units of the fold: its points, and what it does between two of them.
//!
//! In units of the fold, y^2 = a/a_s, the curve is D = y^4 - 4y, F = y^6/6 - y^3, y >= 1. With
//! e = y - 1 and t = D + 3 it reads t = e^2 (e^2 + 4e + 6): no cancellation at the fold e = 0.

use super::{Lane, Zip};
use crate::constants::{
    FIVE, FOUR, HALF, JKR_FORCE_0, JKR_FORCE_1, JKR_FORCE_2, JKR_FORCE_3, JKR_FORCE_4, JKR_FORCE_5,
    JKR_ROOT_A, JKR_ROOT_B, JKR_ROOT_SIX, JKR_TINY, JKR_WORK_0, JKR_WORK_1, JKR_WORK_2, JKR_WORK_3,
    JKR_WORK_4, JKR_WORK_5, JKR_WORK_6, JKR_WORK_7, JKR_WORK_8, LEAST, ONE, SIX, SIXTH, TENTH, THREE,
    TWELFTH,
};

/// Halley's step on e^2 (e^2 + 4e + 6) - t, of third order. In f32 for t up to 1e24: beyond, the slope's square overflows.
#[inline(always)]
fn halley<L: Lane>(e: L, t: L) -> L {
    let p = (e + L::splat(FOUR)).mul_add(e, L::splat(SIX));
    let miss = (e * e).mul_add(p, -t);
    let slope = L::splat(FOUR) * e * (e + L::splat(THREE)).mul_add(e, L::splat(THREE));
    let y = e + L::splat(ONE);
    let bend = L::splat(SIX) * y * y;
    e - miss * slope / slope.mul_add(slope, -(miss * bend))
}

/// e to 0.9 %, by s = sqrt(t): s/sqrt(6) where adhesion matters, sqrt(s) less a constant far beyond.
#[inline(always)]
fn about<L: Lane>(s: L) -> L {
    let q = s.sqrt();
    let above = L::splat(JKR_ROOT_A).mul_add(q, L::splat(ONE));
    let below = L::splat(JKR_ROOT_B).mul_add(q, L::splat(JKR_ROOT_SIX));
    s * above / L::splat(JKR_ROOT_A).mul_add(s, below)
}

/// Mean of F over D between two points of the curve, and its mean slope dF/dD.
///
/// Both are quotients of divided differences of polynomials in e; `h` runs through the complete
/// homogeneous symmetric polynomials of (e1, e2).
#[inline(always)]
fn mean<L: Lane>(e1: L, e2: L) -> (L, L) {
    const WORK: [f64; 9] = [
        JKR_WORK_0, JKR_WORK_1, JKR_WORK_2, JKR_WORK_3, JKR_WORK_4, JKR_WORK_5, JKR_WORK_6, JKR_WORK_7,
        JKR_WORK_8,
    ];
    const FORCE: [f64; 6] = [JKR_FORCE_0, JKR_FORCE_1, JKR_FORCE_2, JKR_FORCE_3, JKR_FORCE_4, JKR_FORCE_5];
    let mut power = e2;
    let mut h = e1 + e2;
    let mut work = L::splat(WORK[0]) * h;
    let mut slope = h.mul_add(L::splat(FORCE[1]), L::splat(FORCE[0]));
    let mut distance = L::splat(SIX) * h;
    for k in 1..9 {
        power = power * e2;
        h = e1.mul_add(h, power);
        work = h.mul_add(L::splat(WORK[k]), work);
        if k < 5 {
            slope = h.mul_add(L::splat(FORCE[k + 1]), slope);
        }
        if k == 1 {
            distance = h.mul_add(L::splat(FOUR), distance);
        }
        if k == 2 {
            distance = distance + h;
        }
    }
    // At the fold itself both differences vanish; their quotient there is -5/6.
    let tiny = L::splat(JKR_TINY);
    let inverse = L::splat(ONE) / (distance + L::splat(SIX) * tiny);
    ((work - L::splat(FIVE) * tiny) * inverse, slope * inverse)
}

/// A point of the curve: t = D + 3 with its root, e, and F.
#[derive(Clone, Copy)]
pub(super) struct Point<L> {
    pub root_t: L,
    pub e: L,
    pub force: L,
}

impl<L: Lane> Point<L> {
    /// At t, which counts as the fold if below zero, to 1e-6.
    #[inline(always)]
    pub fn roughly(t: L) -> Self {
        let t = t.max(L::splat(LEAST));
        let s = t.sqrt();
        Self::of(s, halley(about(s), t))
    }

    /// The same to rounding.
    #[inline(always)]
    pub fn at(t: L) -> Self {
        let t = t.max(L::splat(LEAST));
        let s = t.sqrt();
        Self::of(s, halley(halley(about(s), t), t))
    }

    #[inline(always)]
    pub fn of(root_t: L, e: L) -> Self {
        let y = e + L::splat(ONE);
        let cube = y * y * y;
        Self { root_t, e, force: cube.mul_add(cube * L::splat(SIXTH), -cube) }
    }
}

impl<L: Lane> Zip<L> for Point<L> {
    #[inline(always)]
    fn zip(self, other: Self, join: &mut dyn FnMut(L, L) -> L) -> Self {
        Self {
            root_t: join(self.root_t, other.root_t),
            e: join(self.e, other.e),
            force: join(self.force, other.force),
        }
    }
}

/// What the curve does between two points of it that are passed evenly, in units of F and D.
///
/// `moment` over the change of D is `slope`/12 - `bow`/(10 `roots`^2), which stays finite where the tip turns round.
pub(super) struct Part<L> {
    pub mean: L,
    /// First moment about the middle, for a whole step.
    pub moment: L,
    /// Change of F over that of D.
    pub slope: L,
    /// Mean less the mean of the two ends.
    pub bow: L,
    /// Sum of the roots of t at the ends.
    pub roots: L,
}

impl<L: Lane> Part<L> {
    /// By mean and ends: between them F is taken as a + b sqrt(t) + c t, which holds the fold.
    #[inline(always)]
    pub fn between(from: Point<L>, to: Point<L>) -> Self {
        let (mean, slope) = mean(from.e, to.e);
        let bow = (-L::splat(HALF)).mul_add(from.force + to.force, mean);
        let roots = (from.root_t + to.root_t).max(L::splat(LEAST));
        let lean = (to.root_t - from.root_t) / roots;
        let even = L::splat(TWELFTH) * (to.force - from.force);
        Self { mean, moment: (-L::splat(TENTH)).mul_add(bow * lean, even), slope, bow, roots }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::constants::{JKR_TOUCH, JKR_TOUCH_ROOT};

    /// t at e = y - 1.
    fn curve(e: f64) -> f64 {
        e * e * (6.0 + e * (4.0 + e))
    }

    #[test]
    fn points_over_thirty_decades() {
        let (mut start, mut rough, mut worst, mut worst_single): (f64, f64, f64, f64) = (0.0, 0.0, 0.0, 0.0);
        for i in 0..=4000 {
            // e from 1e-10 to 1e9, so t from 6e-20 to 1e36.
            let e = 10f64.powf(-10.0 + 19.0 * f64::from(i) / 4000.0);
            start = start.max((about(curve(e).sqrt()) / e - 1.0).abs());
            rough = rough.max((Point::roughly(curve(e)).e / e - 1.0).abs());
            worst = worst.max((Point::at(curve(e)).e / e - 1.0).abs());
            // The single one is held against what its own rounded t asks for.
            let t = curve(e) as f32;
            if t < 1e24 {
                let exact = Point::at(f64::from(t)).e;
                worst_single = worst_single.max((f64::from(Point::at(t).e) / exact - 1.0).abs());
            }
        }
        println!("relative errors {start:.1e}, {rough:.1e}, {worst:.1e}, in f32 {worst_single:.1e}");
        assert!(start < 9e-3, "{start:e}");
        assert!(rough < 1e-6, "{rough:e}");
        assert!(worst < 4.0 * f64::EPSILON, "{worst:e}");
        assert!(worst_single < 4.0 * f64::from(f32::EPSILON), "{worst_single:e}");
        // The fold, and below it.
        for t in [0.0, -1.0, -1e20] {
            assert!(Point::roughly(t).e < 1e-14 && Point::at(t as f32).e < 1e-14);
        }
        let touch = Point::at(3.0);
        assert!(
            (touch.e / JKR_TOUCH - 1.0).abs() < 1e-15 && (touch.root_t / JKR_TOUCH_ROOT - 1.0).abs() < 1e-15
        );
    }

    /// F = y^6/6 - y^3 at e = y - 1.
    fn force(e: f64) -> f64 {
        let y3 = (1.0 + e).powi(3);
        y3 * y3 / 6.0 - y3
    }

    #[test]
    fn mean_and_slope_between_any_two_points() {
        for i in 0..60 {
            let e1 = 10f64.powf(-6.0 + 0.13 * f64::from(i));
            for ratio in [1e-3, 0.5, 0.999, 1.0, 1.001, 7.0, 1e3] {
                let e2 = e1 * ratio;
                let (value, slope) = mean(e1, e2);
                // Simpson's rule in e, where F dD/de is a polynomial of degree nine.
                let count = 2000;
                let width = (e2 - e1) / f64::from(count);
                let density = |e: f64| force(e) * (4.0 * (1.0 + e).powi(3) - 4.0);
                let sum: f64 = (0..count)
                    .map(|n| {
                        let e = e1 + f64::from(n) * width;
                        width / 6.0 * (density(e) + 4.0 * density(e + 0.5 * width) + density(e + width))
                    })
                    .sum();
                let distance = curve(e2) - curve(e1);
                let (expected, steep) = if ratio == 1.0 {
                    // The curve itself, dF/dD = (y^5 - 3 y^2)/(4 y^3 - 4).
                    let y = 1.0 + 0.5 * (e1 + e2);
                    (force(y - 1.0), (y.powi(5) - 3.0 * y * y) / (4.0 * (y - 1.0) * (y * y + y + 1.0)))
                } else {
                    (sum / distance, (force(e2) - force(e1)) / distance)
                };
                let scale = force(e1).abs().max(force(e2).abs()).max(1.0);
                assert!((value - expected).abs() < 2e-6 * scale, "{e1:e} {e2:e}: {value:e} {expected:e}");
                let steepest = steep.abs().max(1.0);
                assert!((slope - steep).abs() < 1e-4 * steepest, "{e1:e} {e2:e}: slope {slope:e} {steep:e}");
            }
        }
        // At the fold itself the force is -5/6.
        assert!((mean(0.0, 0.0).0 + 5.0 / 6.0).abs() < 1e-12);
    }
}

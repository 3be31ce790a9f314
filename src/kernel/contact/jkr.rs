//! Johnson, Kendall & Roberts (1971) with its memory; equation (16) of Ha, Fung & Chen 2005.
//!
//! In units of the fold, y^2 = a/a_s, the curve is D = y^4 - 4y, F = y^6/6 - y^3, y >= 1. With
//! e = y - 1 and t = D + 3 it reads t = e^2 (e^2 + 4e + 6): no cancellation at the fold e = 0.

use super::path::{Path, corrected};
use super::{Approach, Interaction, Kick, Lane, LawShader};
use crate::kernel::constants::{
    FIVE, FOUR, JKR_FORCE_0, JKR_FORCE_1, JKR_FORCE_2, JKR_FORCE_3, JKR_FORCE_4, JKR_FORCE_5, JKR_ROOT_A,
    JKR_ROOT_B, JKR_ROOT_SIX, JKR_STEEPEST, JKR_TINY, JKR_TOUCH, JKR_WORK_0, JKR_WORK_1, JKR_WORK_2,
    JKR_WORK_3, JKR_WORK_4, JKR_WORK_5, JKR_WORK_6, JKR_WORK_7, JKR_WORK_8, LEAST, ONE, SIX, THREE, TWO,
    ZERO,
};

/// `unit_force` is pi w R as impulse per step; `inverse_unit` R/a_s^2 per unit of length.
#[derive(Clone, Copy, Debug)]
pub struct Jkr<L> {
    pub unit_force: L,
    pub inverse_unit: L,
}

/// Solves e^2 (e^2 + 4e + 6) = t for e >= 0 (t below zero counts as the fold, e = 0).
///
/// The start is close where adhesion matters and 27 % too small far beyond; four Newton steps
/// leave rounding in f32 and at most 2e-13 in f64.
#[inline(always)]
fn root<L: Lane>(t: L) -> L {
    let s = t.max(L::splat(LEAST)).sqrt();
    // e sqrt(6 + 4e + e^2) = s: s/sqrt(6 + ...) for small s, sqrt(s) - 1 for large.
    let q = s.sqrt();
    let mut e = s / (L::splat(JKR_ROOT_SIX) + L::splat(JKR_ROOT_A) * q + s / (L::splat(JKR_ROOT_B) + q));
    for _ in 0..4 {
        let p = (e + L::splat(FOUR)).mul_add(e, L::splat(SIX));
        let r = p.sqrt();
        // Newton on e sqrt(p) - s, whose slope (2e^2 + 6e + 6)/sqrt(p) never vanishes.
        let slope = (L::splat(TWO) * e + L::splat(SIX)).mul_add(e, L::splat(SIX));
        e = e - (e * r - s) * r / slope;
    }
    e
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

impl<L: Lane> Jkr<L> {
    /// One evaluation with the mid-kick speed implied by `impulse`.
    #[inline(always)]
    fn evaluate(&self, at: Approach<L>, touching: L, impulse: L) -> Kick<L> {
        let (zero, one, three) = (L::splat(ZERO), L::splat(ONE), L::splat(THREE));
        let path = Path::around(at, impulse);
        let t1 = path.start.mul_add(self.inverse_unit, three);
        let end = path.end * self.inverse_unit;
        let t2 = end + three;
        let was = zero.less(touching);
        // Already inside at the start of the piece: touched in the gap between two pieces.
        let begins = L::either(was, zero.less(path.start));
        let touches = L::both(L::not(begins), zero.less(path.end));
        let holds = L::both(begins, zero.less(t1));
        let lets_go = L::both(holds, t2.less(zero));
        let stays = L::both(holds, L::not(lets_go));
        let acting = L::either(holds, touches);
        if !L::any(acting) {
            return Kick::none();
        }
        let e1 = L::select(touches, L::splat(JKR_TOUCH), root(t1));
        let e2 = L::select(lets_go, zero, root(t2));
        // Shares of the path in contact: all of it, from touch on, or up to the fold.
        let after_touch = end / (t2 - t1);
        let before_fold = t1 / (t1 - t2);
        let part = L::select(touches, after_touch, L::select(lets_go, before_fold, one));
        let share = L::select(acting, part, zero);
        let (force, slope) = mean(e1, e2);
        let force = force * self.unit_force * share;
        // The slope is infinite at the fold; a step cannot use more than it resolves.
        let slope = (slope * self.unit_force * self.inverse_unit).max(L::splat(JKR_STEEPEST));
        let impulse = L::select(stays, corrected(force, slope), force);
        let touching = L::select(L::either(stays, touches), one, zero);
        Kick { impulse, contact: share, touching }
    }
}

impl<L: Lane> Interaction<L> for Jkr<L> {
    const SHADER: &'static LawShader = &LawShader {
        name: "jkr",
        texts: &[include_str!("../../../shaders/contact/jkr.wgsl")],
        fields: &["unit_force", "inverse_unit"],
    };

    fn numbers(&self) -> Vec<L> {
        vec![self.unit_force, self.inverse_unit]
    }

    #[inline(always)]
    fn from_numbers(mut next: impl FnMut() -> L) -> Self {
        Self { unit_force: next(), inverse_unit: next() }
    }

    #[inline(always)]
    fn kick(&self, at: Approach<L>, touching: L) -> Kick<L> {
        let zero = L::splat(ZERO);
        if !L::any(L::either(zero.less(touching), at.may_touch())) {
            return Kick::none();
        }
        let guess = self.evaluate(at, touching, zero);
        self.evaluate(at, touching, guess.impulse)
    }

    #[inline(always)]
    fn touching_at(&self, indentation: L) -> L {
        L::select(L::splat(ZERO).less(indentation), L::splat(ONE), L::splat(ZERO))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// t at e = y - 1.
    fn curve(e: f64) -> f64 {
        e * e * (6.0 + e * (4.0 + e))
    }

    #[test]
    fn root_over_twenty_decades() {
        let (mut worst, mut worst_single): (f64, f64) = (0.0, 0.0);
        for i in 0..=4000 {
            // e from 1e-10 to 1e9, so t from 6e-20 to 1e36.
            let e = 10f64.powf(-10.0 + 19.0 * f64::from(i) / 4000.0);
            let error = (root(curve(e)) / e - 1.0).abs();
            worst = worst.max(error);
            // Where adhesion matters it is rounding alone.
            assert!(e > 2.0 || error < 4.0 * f64::EPSILON, "e = {e:e}: {error:e}");
            // The single one is held against what its own rounded t asks for.
            let t = curve(e) as f32;
            let exact = root(f64::from(t));
            worst_single = worst_single.max((f64::from(root(t)) / exact - 1.0).abs());
        }
        println!("largest relative errors {worst:.1e} in f64, {worst_single:.1e} in f32");
        assert!(worst < 3e-13, "{worst:e}");
        assert!(worst_single < 4.0 * f64::from(f32::EPSILON), "{worst_single:e}");
        // The fold, and below it.
        for t in [0.0, -1.0, -1e20] {
            assert!(root(t) < 1e-14);
        }
        assert!((root(3.0) / JKR_TOUCH - 1.0).abs() < 1e-15);
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

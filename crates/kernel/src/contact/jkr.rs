//! Johnson, Kendall & Roberts (1971) with its memory; equation (16) of Ha, Fung & Chen 2005.
//!
//! In units of the fold, y^2 = a/a_s, the curve is D = y^4 - 4y, F = y^6/6 - y^3, y >= 1. With
//! e = y - 1 and t = D + 3 it reads t = e^2 (e^2 + 4e + 6): no cancellation at the fold e = 0.

use super::{Approach, Interaction, Kick, Lane, Zip, when};
use crate::constants::{
    EIGHTH, FIVE, FOUR, HALF, JKR_FORCE_0, JKR_FORCE_1, JKR_FORCE_2, JKR_FORCE_3, JKR_FORCE_4, JKR_FORCE_5,
    JKR_ROOT_A, JKR_ROOT_B, JKR_ROOT_SIX, JKR_STEEPEST, JKR_TINY, JKR_TOUCH, JKR_TOUCH_ROOT, JKR_WORK_0,
    JKR_WORK_1, JKR_WORK_2, JKR_WORK_3, JKR_WORK_4, JKR_WORK_5, JKR_WORK_6, JKR_WORK_7, JKR_WORK_8, LEAST,
    ONE, SIX, SIXTH, TENTH, THREE, TWELFTH, TWO, ZERO,
};

/// `unit_force` is pi w R as impulse per step; `inverse_unit` R/a_s^2 per unit of length.
#[derive(Clone, Copy, Debug)]
pub struct Jkr<L> {
    pub unit_force: L,
    pub inverse_unit: L,
}

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
struct Point<L> {
    root_t: L,
    e: L,
    force: L,
}

impl<L: Lane> Point<L> {
    /// At t, which counts as the fold if below zero, to 1e-6.
    #[inline(always)]
    fn roughly(t: L) -> Self {
        let t = t.max(L::splat(LEAST));
        let s = t.sqrt();
        Self::of(s, halley(about(s), t))
    }

    /// The same to rounding.
    #[inline(always)]
    fn at(t: L) -> Self {
        let t = t.max(L::splat(LEAST));
        let s = t.sqrt();
        Self::of(s, halley(halley(about(s), t), t))
    }

    #[inline(always)]
    fn of(root_t: L, e: L) -> Self {
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

/// A point of the curve, and two numbers of the path there.
#[derive(Clone, Copy)]
struct Passage<L> {
    point: Point<L>,
    /// Of the step: how late it begins, or what it takes.
    share: L,
    pace: L,
}

impl<L: Lane> Zip<L> for Passage<L> {
    #[inline(always)]
    fn zip(self, other: Self, join: &mut dyn FnMut(L, L) -> L) -> Self {
        Self {
            point: self.point.zip(other.point, join),
            share: join(self.share, other.share),
            pace: join(self.pace, other.pace),
        }
    }
}

/// What the curve does between two points of it that are passed evenly, in units of F and D.
///
/// `moment` over the change of D is `slope`/12 - `bow`/(10 `roots`^2), which stays finite where the tip turns round.
struct Part<L> {
    mean: L,
    /// First moment about the middle, for a whole step.
    moment: L,
    /// Change of F over that of D.
    slope: L,
    /// Mean less the mean of the two ends.
    bow: L,
    /// Sum of the roots of t at the ends.
    roots: L,
}

impl<L: Lane> Part<L> {
    /// By mean and ends: between them F is taken as a + b sqrt(t) + c t, which holds the fold.
    #[inline(always)]
    fn between(from: Point<L>, to: Point<L>) -> Self {
        let (mean, slope) = mean(from.e, to.e);
        let bow = (-L::splat(HALF)).mul_add(from.force + to.force, mean);
        let roots = (from.root_t + to.root_t).max(L::splat(LEAST));
        let lean = (to.root_t - from.root_t) / roots;
        let even = L::splat(TWELFTH) * (to.force - from.force);
        Self { mean, moment: (-L::splat(TENTH)).mul_add(bow * lean, even), slope, bow, roots }
    }
}

/// The path of a step without the force within it, in units of the fold.
#[derive(Clone, Copy)]
struct FreePath<L> {
    free: L,
    /// How fast and where the step begins.
    speed: L,
    start: L,
}

impl<L: Lane> FreePath<L> {
    #[inline(always)]
    fn of(at: Approach<L>, inverse_unit: L) -> Self {
        let half = L::splat(HALF);
        let free = at.acceleration * inverse_unit;
        let speed = (-half).mul_add(free, at.speed * inverse_unit);
        let along = at.indentation * inverse_unit;
        let start = (-half).mul_add(at.speed * inverse_unit, L::splat(EIGHTH).mul_add(free, along));
        Self { free, speed, start }
    }

    /// The share of the step after which the tip touches, and how fast it is there.
    #[inline(always)]
    fn touch(&self) -> (L, L) {
        let (two, zero) = (L::splat(TWO), L::splat(ZERO));
        let fast = (-two * self.free).mul_add(self.start, self.speed * self.speed).max(zero).sqrt();
        let late = -two * self.start / (self.speed + fast).max(L::splat(LEAST));
        (late.min(L::splat(ONE)), fast)
    }

    /// Where the tip is after such a share of the step, from `t1` on at this pace, the force having `held` it.
    #[inline(always)]
    fn ahead(&self, (t1, pace): (L, L), left: L, held: L) -> L {
        (left * left).mul_add(L::splat(HALF).mul_add(self.free, -held), left.mul_add(pace, t1))
    }

    /// The share of the step after which the tip has gone back by `height`, the force having `held` it.
    #[inline(always)]
    fn fall(&self, height: L, held: L) -> L {
        let (two, zero) = (L::splat(TWO), L::splat(ZERO));
        let bent = (-two).mul_add(held, self.free);
        let fast = (-two * bent).mul_add(height, self.speed * self.speed).max(zero).sqrt();
        (two * height / (fast - self.speed).max(L::splat(LEAST))).min(L::splat(ONE))
    }
}

impl<L: Lane> Jkr<L> {
    /// Impulse of a part that takes this share of the step: off its chord by the path's own bend over it.
    #[inline(always)]
    fn impulse(&self, part: &Part<L>, share: L, acceleration: L) -> L {
        let pull = self.unit_force * self.inverse_unit;
        let force = self.unit_force * part.mean;
        let bend = acceleration - force;
        let slope = (part.slope * pull).max(L::splat(JKR_STEEPEST)) * L::splat(TWELFTH);
        let roots = (part.roots * part.roots).max((bend * self.inverse_unit).abs());
        let lean = slope - L::splat(TENTH) * pull * part.bow / roots;
        share * (-(bend * lean) * share).mul_add(share, force)
    }
}

impl<L: Lane> Interaction<L> for Jkr<L> {
    const FIELDS: &'static [&'static str] = &["unit_force", "inverse_unit"];
    const SHIFTS: bool = true;

    #[inline(always)]
    fn from_numbers(mut next: impl FnMut() -> L) -> Self {
        Self { unit_force: next(), inverse_unit: next() }
    }

    /// The part of the step in contact: from its start or from touch, to its end or to the fold. Lengths are in units of
    /// the fold until the impulse, which is of the kernel's again.
    #[inline(always)]
    fn kick(&self, at: Approach<L>, touching: L) -> Kick<L> {
        let zero = L::splat(ZERO);
        let was = zero.less(touching);
        when(
            L::either(was, at.may_touch()),
            Kick::none(),
            #[inline(always)]
            || self.near(at, was),
        )
    }
}

impl<L: Lane> Jkr<L> {
    /// The kick where the tip was in contact or comes near it.
    #[inline(always)]
    fn near(&self, at: Approach<L>, was: L::Mask) -> Kick<L> {
        let (zero, half) = (L::splat(ZERO), L::splat(HALF));
        let path = FreePath::of(at, self.inverse_unit);
        let end = half.mul_add(path.free, path.start + path.speed);
        // Already inside at the start of the piece: touched in the gap between two pieces.
        let begins = L::either(was, zero.less(path.start));
        let touches = L::both(L::not(begins), zero.less(end));
        when(
            L::either(begins, touches),
            Kick::none(),
            #[inline(always)]
            || self.held(at, path, (begins, touches)),
        )
    }

    /// The kick where there is contact in the step: since before it, or from a touch within it.
    #[inline(always)]
    fn held(&self, at: Approach<L>, path: FreePath<L>, (begins, touches): (L::Mask, L::Mask)) -> Kick<L> {
        let (zero, one, half, three) = (L::splat(ZERO), L::splat(ONE), L::splat(HALF), L::splat(THREE));
        let acting = L::either(begins, touches);
        let FreePath { speed, start, .. } = path;
        let pull = self.unit_force * self.inverse_unit;
        let twelfth = L::splat(TWELFTH);
        // The stepped path lies off the true one by a 12th of the force (docs/method.md).
        let near = Point::roughly(start + three);
        let t1 = L::select(touches, three, pull * twelfth * near.force + start + three);
        let begun = Passage { point: Point::at(t1), share: zero, pace: speed };
        let Passage { point: from, share: late, pace } = when(
            touches,
            begun,
            #[inline(always)]
            || {
                // Touch divides the step where the free path says.
                let point = Point::of(L::splat(JKR_TOUCH_ROOT), L::splat(JKR_TOUCH));
                let (share, pace) = path.touch();
                let touch = Passage { point, share, pace };
                touch.zip(begun, &mut |yes, no| L::select(touches, yes, no))
            },
        );
        let left = one - late;
        let near = Point::roughly(path.ahead((t1, pace), left, half * pull * from.force));
        let guess = Part::between(from, near);
        let held = pull * half.mul_add(guess.mean, -guess.moment);
        let t2 = path.ahead((t1, pace), left, held);
        let lets_go = L::both(begins, L::either(t2.less(zero), t1.less(zero)));
        let ended = Passage { point: Point::at(t2), share: left, pace };
        let Passage { point: to, share, .. } = when(
            lets_go,
            ended,
            #[inline(always)]
            || {
                // The fold divides it where the path under the force does.
                let share = path.fall(t1.max(zero), held);
                let fold = Passage { point: Point::of(zero, zero), share, pace };
                fold.zip(ended, &mut |yes, no| L::select(lets_go, yes, no))
            },
        );
        let part = Part::between(from, to);
        let impulse = self.impulse(&part, share, at.acceleration);
        let middle = L::select(lets_go, -half, half) * (one - share);
        let moment = impulse.mul_add(middle, share * share * (self.unit_force * part.moment));
        let before = L::select(touches, zero, from.force);
        let after = L::select(lets_go, zero, to.force);
        let shift = (self.unit_force * twelfth).mul_add(after - before, -moment);
        Kick {
            impulse: L::select(acting, impulse, zero),
            shift: L::select(acting, shift, zero),
            contact: L::select(acting, share, zero),
            touching: L::select(L::both(acting, L::not(lets_go)), one, zero),
        }
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

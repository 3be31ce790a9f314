//! JKR: adhesion inside the contact, elastic neck, and with them hysteresis.

use super::static_law::Shares;
use super::{Compact, Hertz, KernelUnits, Passed, StaticLaw};
use crate::kernel::LENGTH;
use std::f64::consts::PI;

/// With the contact radius `a`: `delta = a^2/R - (2/3) sqrt(6 pi w a/K)` and
/// `f = K a^3/R - sqrt(6 pi w K a^3)`; no force out of contact.
///
/// Johnson, Kendall & Roberts 1971; equation (16) of Ha, Fung & Chen 2005. For one indentation there
/// may be two answers, so the law has a hysteresis: out of contact until `delta` reaches 0 on approach,
/// then in contact until the fold `d delta/da = 0` on retraction (the tip is held by its position,
/// not by its load).
///
/// In `y = sqrt(a/a_s)` with `a_s^3 = pi w R^2/(6K)` one curve serves every instance:
/// `delta = (a_s^2/R) (y^4 - 4y)`, `f = pi w R (y^6/6 - y^3)`, `U = pi w a_s^2 (y^10/15 - 2 y^7/3 + y^4)`,
/// `y >= 1`, the fold at `y = 1`.
///
/// Without adhesion this is Hertz.
///
/// ```
/// use afmsweep_model::contact::{Jkr, StaticLaw};
/// let (modulus, radius, work) = (1e8, 2e-8, 0.05);
/// let law = Jkr::new(modulus, radius, work);
/// let unit = std::f64::consts::PI * work * radius;
/// assert!((law.force(0.0, true) / unit + 4.0 / 3.0).abs() < 1e-14);
/// assert!((law.force(law.release(), true) / unit + 5.0 / 6.0).abs() < 1e-14);
/// assert_eq!(law.force(-1e-12, false), 0.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jkr {
    modulus: f64,
    radius: f64,
    work: f64,
    /// `a_s`, m.
    radius_scale: f64,
    /// `a_s^2/R`, m.
    indentation_scale: f64,
    /// `pi w R`, N.
    force_scale: f64,
}

/// Depth in units of `a_s^2/R` from which adhesion no longer shows in a f64 contact radius
/// (its share is `depth^-0.75`), so that Hertz's expressions serve, and nothing overflows.
const DEEP: f64 = 1e22;

/// Largest pull of the curve: y^3 = 3, so D = 3^(4/3) - 4 3^(1/3) = -3^(1/3).
const CUBE_ROOT_OF_3: f64 = 1.442_249_570_307_408_4;

impl Jkr {
    /// Combined modulus (Pa), tip radius (m), work of adhesion (J/m^2).
    pub fn new(modulus: f64, radius: f64, work: f64) -> Self {
        let force_scale = PI * work * radius;
        let radius_scale = (force_scale * radius / (6.0 * modulus)).cbrt();
        let indentation_scale = radius_scale * radius_scale / radius;
        Self { modulus, radius, work, radius_scale, indentation_scale, force_scale }
    }

    /// `a_s = (pi w R^2/(6K))^(1/3)`, m: the contact radius at the fold.
    pub fn radius_scale(&self) -> f64 {
        self.radius_scale
    }

    /// `a_s^2/R`, m: unit of indentation; the fold is at -3 of it.
    pub fn indentation_scale(&self) -> f64 {
        self.indentation_scale
    }

    /// `pi w R`, N: unit of force.
    pub fn force_scale(&self) -> f64 {
        self.force_scale
    }

    /// Energy lost in one cycle from touch at `delta = 0` to the fold, J, whatever the drive:
    /// what the jump into contact and the jump out of it release.
    ///
    /// `pi w a_s^2 (2/5 + (3/5) 4^(4/3)) = 1.2749410291014 pi w R (pi^2 w^2 R/K^2)^(1/3)`.
    pub fn loss_per_cycle(&self) -> f64 {
        PI * self.work * self.radius_scale * self.radius_scale * (0.4 + 2.4 * 4f64.cbrt())
    }

    /// Distance above the fold in units of `a_s^2/R`; 0 at the fold and below.
    fn above_fold(&self, delta: f64) -> f64 {
        let above = delta - self.release();
        if above <= 0.0 { 0.0 } else { above / self.indentation_scale }
    }

    /// True where the contact branch exists and the memory says it is taken.
    fn touching(&self, delta: f64, in_contact: bool) -> bool {
        // A NaN is not beyond the fold: it stays in contact and is passed on.
        let beyond_fold = delta < self.release();
        in_contact && !beyond_fold
    }
}

impl From<&Compact> for Jkr {
    fn from(of: &Compact) -> Self {
        Self::new(of.modulus, of.radius, of.work)
    }
}

impl StaticLaw for Jkr {
    fn force(&self, delta: f64, in_contact: bool) -> f64 {
        if !self.touching(delta, in_contact) {
            return 0.0;
        }
        let above = self.above_fold(delta);
        if above > DEEP {
            // expanded in 1/y: Hertz's load less pi w R
            return self.modulus * delta * (self.radius * delta).sqrt() - self.force_scale;
        }
        let y = 1.0 + excess(above);
        let cube = y * y * y;
        self.force_scale * cube * (cube - 6.0) / 6.0
    }

    fn stiffness(&self, delta: f64, in_contact: bool) -> f64 {
        if !self.touching(delta, in_contact) {
            return 0.0;
        }
        let above = self.above_fold(delta);
        if above > DEEP {
            return 1.5 * self.modulus * (self.radius * delta).sqrt();
        }
        let e = excess(above);
        let a = self.radius_scale * (1.0 + e) * (1.0 + e);
        // y^3 - 1, without the cancellation next to the fold
        let rise = e * (3.0 + e * (3.0 + e));
        1.5 * self.modulus * a * (rise - 2.0) / rise
    }

    fn energy(&self, delta: f64, in_contact: bool) -> f64 {
        if !self.touching(delta, in_contact) {
            return 0.0;
        }
        let above = self.above_fold(delta);
        if above > DEEP {
            return 0.4 * self.modulus * delta * delta * (self.radius * delta).sqrt();
        }
        let y = 1.0 + excess(above);
        let cube = y * y * y;
        let bracket = y * cube * (1.0 + cube * (cube / 15.0 - 2.0 / 3.0));
        PI * self.work * self.radius_scale * self.radius_scale * bracket
    }

    fn elastic_force(&self, depth: f64) -> f64 {
        Hertz::new(self.modulus, self.radius).elastic_force(depth)
    }

    fn collision_depth(&self, speed: f64, inverse_mass: f64) -> f64 {
        Hertz::new(self.modulus, self.radius).collision_depth(speed, inverse_mass)
    }

    fn contact_radius(&self, delta: f64, in_contact: bool) -> f64 {
        if !self.touching(delta, in_contact) {
            return 0.0;
        }
        let above = self.above_fold(delta);
        if above > DEEP {
            return (self.radius * delta).sqrt();
        }
        let y = 1.0 + excess(above);
        self.radius_scale * y * y
    }

    fn release(&self) -> f64 {
        -3.0 * self.indentation_scale
    }

    fn zero_force(&self) -> f64 {
        // y^3 = 6
        self.indentation_scale * 2.0 * 6f64.cbrt()
    }

    fn pull_off(&self) -> f64 {
        -1.5 * self.force_scale
    }

    fn next_contact(&self, delta: f64, was_in_contact: bool) -> bool {
        if was_in_contact { delta >= self.release() } else { delta >= 0.0 }
    }

    fn constants(&self, units: KernelUnits) -> Vec<f64> {
        vec![self.force_scale * units.impulse, LENGTH / self.indentation_scale]
    }

    /// Falls from the fold to its largest pull and rises from there.
    fn forces(&self, passed: &Passed) -> (f64, f64) {
        if !passed.touched {
            return (0.0, 0.0);
        }
        let fold = self.release();
        let pull = -CUBE_ROOT_OF_3 * self.indentation_scale;
        let least = if passed.let_go { fold } else { passed.held.max(fold) };
        let ends = [self.force(passed.deepest, true), self.force(least, true)];
        let (mut low, mut high) = (ends[0].min(ends[1]), ends[0].max(ends[1]));
        if least <= pull && pull <= passed.deepest {
            low = low.min(self.pull_off());
        }
        if passed.apart {
            (low, high) = (low.min(0.0), high.max(0.0));
        }
        (low, high)
    }

    fn depth_by_adhesion(&self) -> f64 {
        4.0 * self.indentation_scale
    }

    /// Past the fold, so that the jump out of contact is seen to end somewhere; the fold itself among them.
    fn outside(&self, _deepest: f64, shares: Shares) -> Vec<f64> {
        let release = self.release();
        let mut points: Vec<f64> = shares.iter().map(|share| 1.3 * release * share).collect();
        let place = points.partition_point(|&delta| delta < release);
        points.insert(place, release);
        points
    }

    /// In sqrt(a) far out, and still dense at the fold.
    fn crowding(&self) -> i32 {
        4
    }
}

/// `e = y - 1 >= 0` of `y^4 - 4y + 3 = e^2 (e^2 + 4e + 6) = above`, to a few ulp for every `above >= 0`.
///
/// Counting from the fold leaves nothing to cancel: every term is positive. It starts from [`near_excess`], and Halley's
/// method, which makes of an error its cube, polishes.
fn excess(above: f64) -> f64 {
    if above == 0.0 {
        return 0.0;
    }
    let mut e = near_excess(above);
    for _ in 0..2 {
        let missed = e * e * (e * (e + 4.0) + 6.0) - above;
        let slope = 4.0 * e * (e * (e + 3.0) + 3.0);
        let half_bend = 6.0 * (e + 1.0) * (e + 1.0);
        e -= missed / (slope - half_bend * (missed / slope));
    }
    e
}

/// The same to within 2 %: `r^2 (r + s)/(r^2 + (1 + s) r + s sqrt(6))` in `r = above^(1/4)` is `r^2/sqrt(6)` next to the fold,
/// as `e` is there, and `r - 1` far from it, whatever `s`; with 1.1 it is nearest in between.
fn near_excess(above: f64) -> f64 {
    const S: f64 = 1.1;
    let square = above.sqrt();
    let r = square.sqrt();
    square * (r + S) / (square + (1.0 + S) * r + S * 6f64.sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Derivative and residual of the dimensionless curve bound the root's error: a few ulp.
    #[test]
    fn contact_excess_is_exact_to_a_few_ulp() {
        for step in 0..=4000 {
            let e = 10f64.powf(-12.0 + step as f64 * (5.5 + 12.0) / 4000.0);
            // e itself made a number whose quartic is well represented: compare e after the round trip
            let above = e * e * (e * (e + 4.0) + 6.0);
            let back = excess(above);
            assert!((back / e - 1.0).abs() < 8.0 * f64::EPSILON, "e {e:e} back {back:e}");
        }
    }

    #[test]
    fn contact_excess_starts_within_two_percent() {
        for step in 0..=4000 {
            let e = 10f64.powf(-12.0 + step as f64 * (5.5 + 12.0) / 4000.0);
            let near = near_excess(e * e * (e * (e + 4.0) + 6.0));
            assert!((near / e - 1.0).abs() < 0.02, "e {e:e} near {near:e}");
        }
    }

    #[test]
    fn contact_jkr_takes_any_input() {
        for modulus in [0.0, 1e-300, 1e9, f64::INFINITY, f64::NAN] {
            for work in [0.0, 1e-300, 0.05, 1e300, f64::INFINITY, f64::NAN] {
                let law = Jkr::new(modulus, 1e-8, work);
                for delta in [f64::NEG_INFINITY, -1.0, -1e-300, 0.0, 1e-12, 1.0, f64::INFINITY, f64::NAN] {
                    for contact in [false, true] {
                        law.force(delta, contact);
                        law.stiffness(delta, contact);
                        law.energy(delta, contact);
                        law.contact_radius(delta, contact);
                        law.next_contact(delta, contact);
                    }
                }
            }
        }
        assert!(Jkr::new(1e9, 1e-8, 0.05).force(f64::NAN, true).is_nan());
    }
}

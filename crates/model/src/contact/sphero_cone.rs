//! A cone with a spherical cap.

use crate::kernel::contact::force_table::{EXPONENTIAL, ForceTable, KNOTS, Knot};
use crate::scene::TermForce;
use std::f64::consts::{FRAC_PI_2, PI};

/// The largest `delta/R` to which its force is tabulated.
pub const SPHERO_CONE_REACH: f64 = 100.0;

/// Cells of the table on the cap.
const CAP_CELLS: usize = 300;

/// A rigid cone of this half-angle (degree) whose end is a cap of radius R, which meets it at `b = R cos(alpha)` from the axis.
///
/// In the contact radius a, all lengths over R, with `s = sqrt(a^2 - b^2)` where a > b: Briscoe, Sebastian & Adams, J. Phys. D
/// 27, 1156 (1994)
///
/// ```text
/// a <= b:  delta = a^2,  f = (4/3) E* R^2 a^3
/// a > b:   delta = a (a - s) + a/tan(alpha) (pi/2 - asin(b/a))
///          f = 2 E* R^2 (a delta - a^2/(2 tan(alpha)) (pi/2 - asin(b/a)) - a^3/3 + s (b/(2 tan(alpha)) + (a^2 - b^2)/3))
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpheroCone {
    tangent: f64,
    cap: f64,
}

impl SpheroCone {
    pub fn new(half_angle: f64) -> Self {
        let angle = half_angle.to_radians();
        Self { tangent: angle.tan(), cap: angle.cos() }
    }

    /// Indentation over R and force over `E* R^2` at a contact radius over R.
    pub fn at(&self, a: f64) -> (f64, f64) {
        if a <= self.cap {
            return (a * a, 4.0 / 3.0 * a * a * a);
        }
        let square = (a - self.cap) * (a + self.cap);
        let s = square.sqrt();
        let side = (FRAC_PI_2 - (self.cap / a).asin()) / self.tangent;
        let delta = a * (a - s) + a * side;
        let inside = 0.5 * a * a * side + a * a * a / 3.0;
        (delta, 2.0 * (a * delta - inside + s * (0.5 * self.cap / self.tangent + square / 3.0)))
    }

    /// Force over indentation, in their units. The places are even in the root of a on the cap, and in that of s beyond it: there
    /// a rises with the square of the indentation at first. The slope is `2 E* a`, as of every tip with an axis.
    fn knots(&self) -> Vec<Knot> {
        let widest = 2.0 / PI * self.tangent * (SPHERO_CONE_REACH + 4.0 / self.tangent) + 2.0;
        let graded = |n: usize, all: usize| (n as f64 / all as f64).powi(2);
        let cap = (0..=CAP_CELLS).map(|n| self.cap * graded(n, CAP_CELLS));
        let cells = KNOTS - 1 - CAP_CELLS;
        let side = (1..=cells).map(|n| self.cap.hypot(widest * graded(n, cells)));
        let radii: Vec<f64> = cap.chain(side).collect();
        let knot = |a: &f64| {
            let (delta, force) = self.at(*a);
            Knot::smooth(delta, force, 2.0 * a)
        };
        let mut knots: Vec<Knot> = radii.iter().map(knot).collect();
        knots.dedup_by(|next, knot| next.at <= knot.at);
        knots
    }

    /// The force of a tip of this radius (m) on a half-space of reduced modulus `E*`, Pa.
    pub fn term(&self, modulus: f64, radius: f64) -> TermForce {
        let amplitude = modulus * radius * radius;
        match ForceTable::member("sphero-cone", [self.cap, self.tangent], || self.knots()) {
            Some(table) => TermForce { amplitude, length: radius, table },
            None => TermForce { amplitude: f64::NAN, length: radius, table: EXPONENTIAL },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: the method of dimensionality reduction, f = 2 E* times the integral of delta - g(x) from the axis to a, by
    /// Simpson's rule; g is what `at` gives as delta. And the sphere's and the cone's own forms at the ends.
    #[test]
    fn force_is_that_of_springs_side_by_side() {
        for angle in [10.0, 35.0, 70.0] {
            let tip = SpheroCone::new(angle);
            for a in [0.3 * tip.cap, 1.01 * tip.cap, 2.0, 20.0] {
                let (delta, force) = tip.at(a);
                // Even in the square root of the distance from the cap's edge, where g bends.
                let area = |from: f64, to: f64| {
                    let pieces = 4000;
                    let place = |n: f64| from + (to - from) * (n / f64::from(pieces)).powi(2);
                    let value = |n: f64| {
                        let rate = 2.0 * (to - from) * n / f64::from(pieces * pieces);
                        (delta - tip.at(place(n)).0) * rate
                    };
                    let piece = |n: i32| {
                        let n = f64::from(n);
                        (value(n) + 4.0 * value(n + 0.5) + value(n + 1.0)) / 6.0
                    };
                    (0..pieces).map(piece).sum::<f64>()
                };
                let edge = tip.cap.min(a);
                let springs = 2.0 * (area(0.0, edge) + area(edge, a));
                assert!((springs / force - 1.0).abs() < 1e-8, "{angle} {a}: {springs} {force}");
            }
            let (delta, force) = tip.at(1e4);
            let cone = 2.0 / PI * tip.tangent * delta * delta;
            assert!((force / cone - 1.0).abs() < 20.0 / delta, "{angle}: {force} {cone}");
        }
    }

    /// Truth: `at`. The table is right to 1e-7 of the force from a thousandth of R on.
    #[test]
    fn the_table_is_the_closed_form() {
        for angle in [10.0, 20.0, 45.0, 70.0] {
            let tip = SpheroCone::new(angle);
            let term = tip.term(2e9, 1e-8);
            let mut worst = 0.0f64;
            for n in 1..4000 {
                let (delta, force) = tip.at(0.03 * 1.002f64.powi(n));
                if delta > SPHERO_CONE_REACH {
                    break;
                }
                let [own, slope, _] = term.at(delta * 1e-8);
                worst = worst.max((own / (force * 2e9 * 1e-16) - 1.0).abs());
                assert!((slope / (4e9 * 1e-8 * 0.03 * 1.002f64.powi(n)) - 1.0).abs() < 1e-4, "{angle} {n}");
            }
            println!("{angle} degree: {worst:.1e}");
            assert!(worst < 1e-7, "{angle}: {worst:e}");
        }
    }
}

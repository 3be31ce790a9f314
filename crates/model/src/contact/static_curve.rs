//! Static force-indentation curves, as `afmsweep force` prints them.
//!
//! Both branches run as the tip does: `approach` towards the sample (indentation rises), `retract`
//! away from it (indentation falls). Where the force jumps, both of its values stand at the same
//! indentation, so that a line through the points shows the jump.

use super::{Contact, Law, SMALL_STRAIN};
use serde::Serialize;

/// Which way the tip moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum CurveBranch {
    Approach,
    Retract,
}

impl CurveBranch {
    /// `approach` or `retract`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Approach => "approach",
            Self::Retract => "retract",
        }
    }
}

/// One branch of one law; the lists have one length. `None` (JSON `null`): no such state.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StaticCurve {
    pub law: Law,
    pub branch: CurveBranch,
    /// m
    pub indentation_m: Vec<f64>,
    /// N
    pub force_n: Vec<Option<f64>>,
    /// m
    pub contact_radius_m: Vec<Option<f64>>,
}

/// What `afmsweep force --json` prints.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StaticCurves {
    pub curves: Vec<StaticCurve>,
}

/// Points on each smooth piece of a curve.
const POINTS: usize = 200;

impl Contact {
    /// Both branches over the indentations where this law has something to show: from outside the
    /// reach of adhesion to three times the depth at which the load balances it, and at least to the
    /// edge of small strain.
    pub fn curves(&self) -> StaticCurves {
        self.curves_to(self.telling_indentation())
    }

    /// Both branches, down to the indentation `deepest` (m).
    pub fn curves_to(&self, deepest: f64) -> StaticCurves {
        let (outside, inside) = (self.outside(deepest), self.inside(deepest));
        let (formation, release) = (self.law().formation(), self.law().release());
        let mut approach = Points::new(self, CurveBranch::Approach);
        let rising = outside.iter().chain(inside.iter().rev().filter(|delta| **delta >= 0.0));
        rising.filter(|delta| **delta < formation).for_each(|&delta| approach.push(delta, false));
        if self.law.has_hysteresis() {
            approach.push(formation, false);
        }
        inside
            .iter()
            .rev()
            .filter(|&&delta| delta >= formation)
            .for_each(|&delta| approach.push(delta, true));

        let mut retract = Points::new(self, CurveBranch::Retract);
        inside.iter().for_each(|&delta| retract.push(delta, true));
        outside.iter().rev().filter(|&&delta| delta <= release).for_each(|&delta| retract.push(delta, false));
        StaticCurves { curves: vec![approach.curve, retract.curve] }
    }

    /// Both branches at the indentations given (m), in their order.
    ///
    /// Under JKR the approach is out of contact (no force) at every negative indentation, and the
    /// retraction has no state beyond the fold: `None` there. So it is with a force that remembers, from where it forms to
    /// where it breaks. The other laws have one branch, told twice.
    pub fn curves_at(&self, indentations: &[f64]) -> StaticCurves {
        let mut approach = Points::new(self, CurveBranch::Approach);
        let mut retract = Points::new(self, CurveBranch::Retract);
        for &delta in indentations {
            approach.push(delta, self.next_contact(delta, false));
            let held = !self.law.has_hysteresis() || self.next_contact(delta, true);
            retract.push(delta, held.then_some(true));
        }
        StaticCurves { curves: vec![approach.curve, retract.curve] }
    }

    pub(super) fn telling_indentation(&self) -> f64 {
        (3.0 * self.law().zero_force()).max(SMALL_STRAIN * SMALL_STRAIN * self.radius)
    }

    /// Rising indentations outside the contact; the point 0 is left to the contact.
    pub(super) fn outside(&self, deepest: f64) -> Vec<f64> {
        let shares: Vec<f64> = (0..POINTS).map(|i| (POINTS - i) as f64 / POINTS as f64).collect();
        self.law().outside(deepest, &shares)
    }

    /// Falling indentations of the contact branch, from `deepest` to its end.
    pub(super) fn inside(&self, deepest: f64) -> Vec<f64> {
        let release = self.law().release();
        // Spacing that shrinks towards the end of the branch, where its slope or curvature is largest.
        let power = self.law().crowding();
        let mut points: Vec<f64> = (0..=POINTS)
            .map(|i| {
                let share = (POINTS - i) as f64 / POINTS as f64;
                release + (deepest - release) * share.powi(power)
            })
            .collect();
        if self.law.has_hysteresis() {
            // the touch belongs to both branches, and so does the place where contact begins
            for level in [0.0, self.law().formation()] {
                let place = points.partition_point(|&delta| delta > level);
                if points.get(place) != Some(&level) {
                    points.insert(place, level);
                }
            }
        }
        points
    }
}

/// A curve as it grows.
struct Points<'a> {
    contact: &'a Contact,
    curve: StaticCurve,
}

impl<'a> Points<'a> {
    fn new(contact: &'a Contact, branch: CurveBranch) -> Self {
        let curve = StaticCurve {
            law: contact.law,
            branch,
            indentation_m: Vec::new(),
            force_n: Vec::new(),
            contact_radius_m: Vec::new(),
        };
        Self { contact, curve }
    }

    /// The point at this indentation; none of `in_contact` where there is no such state.
    fn push(&mut self, delta: f64, in_contact: impl Into<Option<bool>>) {
        let in_contact = in_contact.into();
        self.curve.indentation_m.push(delta);
        self.curve.force_n.push(in_contact.map(|touching| self.contact.force(delta, touching)));
        self.curve
            .contact_radius_m
            .push(in_contact.map(|touching| self.contact.contact_radius(delta, touching)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{LawChoice, Params};

    fn contact(law: LawChoice) -> Contact {
        let mut params = Params::default();
        params.contact.law = law;
        Contact::new(&params)
    }

    #[test]
    fn contact_curves_show_the_largest_pull() {
        for law in [LawChoice::None, LawChoice::Hertz, LawChoice::Dmt, LawChoice::Jkr] {
            let contact = contact(law);
            for curve in contact.curves().curves {
                let least = curve.force_n.iter().flatten().fold(0f64, |a, &b| a.min(b));
                let deepest_pull = match (contact.law, curve.branch) {
                    (Law::Jkr, CurveBranch::Approach) => contact.law().pull_off() * (4.0 / 3.0) / 1.5,
                    _ => contact.law().pull_off(),
                };
                assert!((least - deepest_pull).abs() <= 1e-3 * deepest_pull.abs(), "{law:?} {least:e}");
            }
        }
    }

    #[test]
    fn contact_curves_join_without_gaps_except_at_jumps() {
        // JKR: two jumps in all, at touch (-4/3) and at the fold (-5/6)
        let StaticCurves { curves } = contact(LawChoice::Jkr).curves();
        let unit = contact(LawChoice::Jkr).jkr().map_or(f64::NAN, |law| law.force_scale());
        for (curve, jump) in curves.iter().zip([-4.0 / 3.0, 5.0 / 6.0]) {
            let jumps: Vec<f64> = (1..curve.force_n.len())
                .filter(|&i| curve.indentation_m[i] == curve.indentation_m[i - 1])
                .map(|i| {
                    (curve.force_n[i].unwrap_or(f64::NAN) - curve.force_n[i - 1].unwrap_or(f64::NAN)) / unit
                })
                .collect();
            assert_eq!(jumps.len(), 1, "{:?}", curve.branch);
            assert!((jumps[0] - jump).abs() < 1e-13, "{jumps:?}");
        }
    }
}

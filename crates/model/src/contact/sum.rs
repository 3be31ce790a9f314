//! A contact and the forces beside it.

use super::static_law::Shares;
use super::{Compact, Dmt, KernelUnits, Law, Passed, ShapedHertz, StaticLaw};
use crate::kernel::LENGTH;
use crate::kernel::contact::TERMS;
use crate::kernel::contact::force_table::{ForceTable, INVERSE, KNOTS};
use crate::scene::{LawChoice, TermForce, TipShape};

/// The force of a contact without adhesion or under DMT's attraction, or none, and up to four forces beside it.
///
/// Those beside it are tabulated: outside forces keep their value at touch inside, a table of the user goes on inside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ForceSum {
    /// Without attraction its work of adhesion is 0.
    pub(super) contact: Dmt<ShapedHertz>,
    terms: [Option<TermForce>; TERMS],
    /// The term that is the contact of a sphero-cone, and E*, Pa.
    cap: Option<(TermForce, f64)>,
}

impl From<&Compact> for ForceSum {
    fn from(of: &Compact) -> Self {
        // Beside a sample that relaxes the attraction is one of the terms.
        let pulls = of.choice == LawChoice::Dmt && of.law != Law::RelaxingSum;
        let work = if pulls { of.work } else { 0.0 };
        let contact = match of.choice {
            LawChoice::Sum => Dmt::from(&Compact { modulus: 0.0, work, ..*of }),
            _ => Dmt::from(&Compact { work, ..*of }),
        };
        let cap = of.terms[0].filter(|_| of.shape == TipShape::SpheroCone);
        Self { contact, terms: of.terms, cap: cap.map(|term| (term, 0.75 * of.modulus)) }
    }
}

impl ForceSum {
    /// The forces beside a contact, without it.
    pub(super) fn beside_contact(of: &Compact) -> Self {
        Self::from(&Compact { choice: LawChoice::Sum, ..*of })
    }

    /// The same without the last of the forces beside the contact.
    pub(super) fn without_last(mut self) -> Self {
        self.terms[TERMS - 1] = None;
        self
    }

    /// What the forces beside the contact come to: force, slope, energy.
    fn beside(&self, delta: f64) -> [f64; 3] {
        let add = |sum: [f64; 3], one: [f64; 3]| std::array::from_fn(|n| sum[n] + one[n]);
        self.terms.iter().flatten().fold([0.0; 3], |sum, term| add(sum, term.at(delta)))
    }

    /// The least and the largest force between two indentations; not numbers where these are none.
    pub(super) fn extremes(&self, low: f64, high: f64) -> [f64; 2] {
        self.extremes_of((low, high), |delta| self.force(delta, delta > 0.0))
    }

    /// The same of a `force` of which this one is a part.
    pub(super) fn extremes_of(&self, (low, high): (f64, f64), force: impl Fn(f64) -> f64) -> [f64; 2] {
        let reach = self.terms.iter().flatten().fold(self.contact.decay(), |least, term| {
            let inner = ForceTable::numbered(term.table).ends().1.abs().max(1.0);
            least.min(term.length * inner)
        });
        let mut places = vec![low, high];
        // Graded towards touch, where forces change within their shortest length.
        let (from, to) = ((low / reach).asinh(), (high / reach).asinh());
        places.extend(
            (1..POINTS).map(|n| reach * (from + (to - from) * f64::from(n) / f64::from(POINTS)).sinh()),
        );
        // Between the knots of the program's own tables nothing turns.
        for term in self.terms.iter().flatten().filter(|term| term.table > INVERSE) {
            let rows = &ForceTable::numbered(term.table).rows()[1..KNOTS];
            places.extend(rows.iter().map(|row| row[0] * term.length).filter(|at| (low..high).contains(at)));
        }
        places.push(0.0);
        places.retain(|place| (low..=high).contains(place));
        places.sort_by(f64::total_cmp);
        places.dedup();
        [1.0, -1.0].map(|sign| {
            let cost = |delta: f64| sign * force(delta);
            let best = (0..places.len()).min_by(|a, b| cost(places[*a]).total_cmp(&cost(places[*b])));
            let Some(best) = best else { return f64::NAN };
            let (mut left, mut right) =
                (places[best.saturating_sub(1)], places[(best + 1).min(places.len() - 1)]);
            for _ in 0..80 {
                let (one, other) = (left + (right - left) / 3.0, right - (right - left) / 3.0);
                if cost(one) < cost(other) { right = other } else { left = one }
            }
            let refined = 0.5 * (left + right);
            sign * cost(refined).min(cost(places[best]))
        })
    }

    /// The farthest that a force beside the contact or the attraction is told of, m.
    fn reach(&self) -> f64 {
        let longest = self.terms.iter().flatten().map(|term| {
            let far = -ForceTable::numbered(term.table).ends().0;
            term.length * far.clamp(1.0, 20.0)
        });
        longest.fold(9.0 * self.contact.decay(), f64::max)
    }
}

/// Places at which extremes are looked for first.
const POINTS: i32 = 64;

impl StaticLaw for ForceSum {
    fn force(&self, delta: f64, in_contact: bool) -> f64 {
        self.contact.force(delta, in_contact) + self.beside(delta)[0]
    }

    fn stiffness(&self, delta: f64, in_contact: bool) -> f64 {
        self.contact.stiffness(delta, in_contact) + self.beside(delta)[1]
    }

    fn energy(&self, delta: f64, in_contact: bool) -> f64 {
        self.contact.energy(delta, in_contact) + self.beside(delta)[2]
    }

    fn contact_radius(&self, delta: f64, in_contact: bool) -> f64 {
        match self.cap {
            Some((term, modulus)) if delta > 0.0 => term.at(delta)[1] / (2.0 * modulus),
            Some(_) => 0.0,
            // Of a table nothing is known.
            None => {
                Some(self.contact.contact_radius(delta, in_contact)).filter(|a| !a.is_nan()).unwrap_or(0.0)
            }
        }
    }

    fn constants(&self, units: KernelUnits) -> Vec<f64> {
        [self.contact.constants(units), self.term_constants(units)].concat()
    }

    fn tail_constants(&self, units: KernelUnits) -> Vec<f64> {
        self.contact.tail_constants(units)
    }

    fn term_constants(&self, units: KernelUnits) -> Vec<f64> {
        let none = TermForce { amplitude: 0.0, length: LENGTH, table: 0 };
        let of = |term: Option<TermForce>| {
            let term = term.unwrap_or(none);
            [term.amplitude * units.impulse, LENGTH / term.length, term.table as f64]
        };
        self.terms.into_iter().flat_map(of).collect()
    }

    /// What is left without the force at touch.
    fn elastic_force(&self, depth: f64) -> f64 {
        self.force(depth, true) - self.force(0.0, true)
    }

    fn collision_depth(&self, speed: f64, inverse_mass: f64) -> f64 {
        let work =
            |depth: f64| self.energy(depth, true) - self.energy(0.0, true) - self.force(0.0, true) * depth;
        super::static_law::first_depth(|depth| 2.0 * work(depth) * inverse_mass >= speed * speed)
    }

    fn forces(&self, passed: &Passed) -> (f64, f64) {
        self.extremes(passed.highest, passed.deepest).into()
    }

    fn zero_force(&self) -> f64 {
        match self.force(0.0, true) {
            pull if pull < 0.0 => self.depth_under(-pull),
            _ => 0.0,
        }
    }

    fn pull_off(&self) -> f64 {
        self.extremes(-self.reach(), self.zero_force())[0].min(0.0)
    }

    fn attraction_slope(&self) -> f64 {
        let steepest = |term: &TermForce| {
            let rows = &ForceTable::numbered(term.table).rows()[1..KNOTS];
            let outside = rows.iter().filter(|row| row[0] <= 0.0).map(|row| row[3].abs());
            (term.amplitude / term.length).abs() * outside.fold(0.0, f64::max)
        };
        self.contact.attraction_slope() + self.terms.iter().flatten().map(steepest).sum::<f64>()
    }

    /// Evenly spaced in the logarithm of the distance and a hundredth of the reach.
    fn outside(&self, _deepest: f64, shares: Shares) -> Vec<f64> {
        let reach = self.reach();
        shares.iter().map(|share| -0.01 * reach * (101f64.powf(*share) - 1.0)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::Contact;
    use crate::scene::{OutsideForce, Params};

    fn contact() -> Contact {
        let mut params = Params::default();
        params.contact.law = LawChoice::Dmt;
        params.contact.outside = vec![
            OutsideForce::Electrostatic { bias: 1.0, contact_potential: 0.0, cut_off: 1e-9, cone: None },
            OutsideForce::DoubleLayer {
                tip_charge: 0.01,
                sample_charge: 0.01,
                screening_length: 3e-9,
                permittivity: 78.4,
            },
        ];
        Contact::new(&params)
    }

    /// A motion that stopped being a number, or one without extent: some answer, no panic.
    #[test]
    fn forces_of_any_motion() {
        let values = [f64::NAN, f64::NEG_INFINITY, f64::INFINITY, -1e-9, 0.0, 2e-9];
        for highest in values {
            for deepest in values {
                let passed = Passed {
                    deepest,
                    highest,
                    held: deepest,
                    touched: true,
                    apart: true,
                    let_go: false,
                    forces: (f64::NAN, f64::NAN),
                };
                let (least, most) = contact().law().forces(&passed);
                if highest == deepest && deepest.is_finite() {
                    assert_eq!([least, most], [contact().force(deepest, deepest > 0.0); 2], "{deepest}");
                }
            }
        }
    }

    /// Truth: the force at 20,000 places, which has its least outside contact.
    #[test]
    fn extremes_are_those_of_a_dense_search() {
        let law = contact();
        let (low, high) = (-30e-9, 1e-9);
        let passed = Passed {
            deepest: high,
            highest: low,
            held: 0.0,
            touched: true,
            apart: true,
            let_go: true,
            forces: (f64::NAN, f64::NAN),
        };
        let places = (0..=20_000).map(|n| low + (high - low) * f64::from(n) / 20_000.0);
        let all: Vec<f64> = places.map(|delta| law.force(delta, delta > 0.0)).collect();
        let (least, most) = law.law().forces(&passed);
        let dense =
            [all.iter().copied().fold(f64::INFINITY, f64::min), all.iter().copied().fold(-1.0, f64::max)];
        let scale = dense[1] - dense[0];
        assert!(
            (least - dense[0]).abs() < 1e-6 * scale && (most - dense[1]).abs() < 1e-6 * scale,
            "{least:e} {most:e} {dense:?}"
        );
    }
}

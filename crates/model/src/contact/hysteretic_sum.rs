//! A sum of forces, one of which remembers.

use super::static_law::Shares;
use super::{Compact, ForceSum, KernelUnits, Passed, ShapedHertz, StaticLaw};

/// A [`ForceSum`] in which one force acts only from where it forms, an indentation passed on the way in, to where it breaks,
/// one passed on the way out: a liquid neck, or what a table says more on its way out.
///
/// Here `in_contact` tells whether that force acts.
///
/// ```
/// use afmsweep_model::contact::{Contact, StaticLaw};
/// use afmsweep_model::scene::{LawChoice, NeckModel, OutsideForce, Params};
/// let mut params = Params::default();
/// params.contact.law = LawChoice::Hertz;
/// let (strength, forms_at, breaks_at) = (10e-9, 1e-9, 4e-9);
/// let neck =
///     OutsideForce::Capillary { strength, forms_at, breaks_at, decay_length: None, model: NeckModel::InverseSquare };
/// params.contact.outside = vec![neck];
/// let contact = Contact::new(&params);
/// assert_eq!(contact.force(-2e-9, false), 0.0);
/// assert!((contact.force(-2e-9, true) / strength + 1.0 / 9.0).abs() < 1e-8);
/// assert!(!contact.next_contact(-2e-9, false) && contact.next_contact(-2e-9, true));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HystereticSum {
    /// With the force that remembers.
    joined: ForceSum,
    forms: f64,
    breaks: f64,
}

impl From<&Compact> for HystereticSum {
    fn from(of: &Compact) -> Self {
        Self { joined: of.into(), forms: of.neck[0], breaks: of.neck[1] }
    }
}

impl HystereticSum {
    fn sum(&self, joined: bool) -> ForceSum {
        if joined { self.joined } else { self.joined.without_last() }
    }

    /// The sum of powers that is its contact.
    pub(super) fn elastic(&self) -> &ShapedHertz {
        &self.joined.contact.elastic
    }
}

impl StaticLaw for HystereticSum {
    fn force(&self, delta: f64, in_contact: bool) -> f64 {
        self.sum(in_contact).force(delta, in_contact)
    }

    fn stiffness(&self, delta: f64, in_contact: bool) -> f64 {
        self.sum(in_contact).stiffness(delta, in_contact)
    }

    fn energy(&self, delta: f64, in_contact: bool) -> f64 {
        self.sum(in_contact).energy(delta, in_contact)
    }

    fn contact_radius(&self, delta: f64, in_contact: bool) -> f64 {
        self.joined.contact_radius(delta, in_contact)
    }

    fn constants(&self, units: KernelUnits) -> Vec<f64> {
        let mut all = self.joined.constants(units);
        all.extend([self.forms, self.breaks].map(|place| place / crate::kernel::LENGTH));
        all
    }

    fn elastic_force(&self, depth: f64) -> f64 {
        self.sum(false).elastic_force(depth)
    }

    fn collision_depth(&self, speed: f64, inverse_mass: f64) -> f64 {
        self.sum(false).collision_depth(speed, inverse_mass)
    }

    fn formation(&self) -> f64 {
        self.forms
    }

    fn release(&self) -> f64 {
        self.breaks
    }

    fn next_contact(&self, delta: f64, was_in_contact: bool) -> bool {
        if was_in_contact { delta >= self.breaks } else { delta >= self.forms }
    }

    fn forces(&self, passed: &Passed) -> (f64, f64) {
        let Passed { highest, deepest, held, let_go, apart, .. } = *passed;
        // Where it never acted nothing is the least indentation at which it did.
        let acted = held <= deepest;
        let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
        let mut take = |joined, from: f64, to: f64| {
            let [low, high] = self.sum(joined).extremes(from.min(to), to);
            (least, most) = (least.min(low), most.max(high));
        };
        if acted {
            take(true, if let_go { self.breaks } else { held.max(self.breaks) }, deepest);
        }
        if apart || !acted {
            take(false, highest, if acted { deepest.min(self.forms) } else { deepest });
        }
        (least, most)
    }

    fn zero_force(&self) -> f64 {
        self.joined.zero_force()
    }

    fn pull_off(&self) -> f64 {
        self.joined.pull_off().min(self.sum(false).pull_off())
    }

    fn attraction_slope(&self) -> f64 {
        self.joined.attraction_slope()
    }

    /// As those of the sum, with a place at which a neck breaks that has not formed again.
    fn outside(&self, deepest: f64, shares: Shares) -> Vec<f64> {
        let mut points = self.joined.outside(deepest, shares);
        if let Some(far) = points.first_mut() {
            *far = far.min(1.3 * self.breaks);
        }
        let place = points.partition_point(|&delta| delta < self.breaks);
        if self.breaks < 0.0 {
            points.insert(place, self.breaks);
        }
        points
    }
}

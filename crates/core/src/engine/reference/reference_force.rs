//! The force on the tip again: a contact law in a form of its own (`reference_law.rs`), and what acts beside it.

use super::reference_law::ReferenceLaw;
use super::reference_neck::{Branch, ReferenceNeck, beside, beside_contact};
use crate::contact::Contact;
use crate::kernel::contact::TERMS;
use crate::scene::TermForce;

/// A law with its constants, and up to four forces beside it, of which the last may remember; SI units.
#[derive(Clone, Copy, Debug)]
pub(super) struct ReferenceForce {
    pub law: ReferenceLaw,
    /// Whether it remembers two numbers, as lengths in m.
    pub remembers: bool,
    /// Whether the force may end before the tip is out: by the rate, or by what the sample remembers.
    pub viscous: bool,
    terms: [Option<TermForce>; TERMS],
    neck: Option<ReferenceNeck>,
}

impl ReferenceForce {
    /// The force of a contact and of what acts beside it.
    pub fn new(contact: &Contact) -> Self {
        let (law, terms) = (ReferenceLaw::new(contact), beside_contact(contact));
        let (remembers, viscous) = (contact.law.has_memory(), contact.law.is_viscous());
        Self { law, remembers, viscous, terms, neck: ReferenceNeck::of(contact) }
    }

    /// Force on the tip, N, on this branch. Each branch continues past its end, so that a step may overshoot before it is cut
    /// back there.
    ///
    /// `rate` gives the rate of indentation, m/s; only a law that needs the rate calls it. `memory` is the law's, if it has
    /// one.
    #[inline]
    pub fn at(&self, delta: f64, rate: impl FnOnce() -> f64, memory: [f64; 2], branch: Branch) -> f64 {
        let Branch { touching, joined } = branch;
        self.law.at(delta, rate, memory, touching) + self.beside(delta, touching, joined)
    }

    /// What acts beside the contact.
    #[inline]
    fn beside(&self, delta: f64, touching: bool, joined: bool) -> f64 {
        let neck = self.neck.filter(|_| joined).map(|neck| neck.force);
        // While JKR's neck holds a tip that is out of the surface, these forces go by the distance.
        let drawn_out = delta < 0.0 && self.law.form().level(true).is_some_and(|level| level < 0.0);
        let inside = touching && !drawn_out;
        self.terms.iter().flatten().chain(&neck).map(|term| beside(term, delta, inside)).sum()
    }

    /// Whether the force on a branch may be least or largest where the indentation is not.
    pub fn turns_anywhere(&self, branch: Branch) -> bool {
        let beside = self.neck.is_some() || self.terms.iter().any(Option::is_some);
        beside || (self.viscous && branch.touching)
    }

    /// Indentation at which the force that remembers begins to act, or ceases to.
    fn neck_level(&self, joined: bool) -> Option<f64> {
        Some(self.neck?.level(joined))
    }

    /// How far the indentation is from where the branch changes, positive before, and the branch behind there.
    pub fn change(&self, branch: Branch, delta: f64) -> Option<(f64, Branch)> {
        let Branch { touching, joined } = branch;
        let room = |level: f64, inside: bool| if inside { delta - level } else { level - delta };
        let contact = self.law.form().level(touching).map(|level| (room(level, touching), !touching, joined));
        let neck = self.neck_level(joined).map(|level| (room(level, joined), touching, !joined));
        // A neck may form at touch: both change at once.
        match (contact, neck) {
            (Some(one), Some(other)) if one.0 == other.0 => {
                Some((one.0, Branch { touching: one.1, joined: other.2 }))
            }
            _ => {
                let all = contact.into_iter().chain(neck);
                let nearest = all.min_by(|one, other| one.0.total_cmp(&other.0))?;
                Some((nearest.0, Branch { touching: nearest.1, joined: nearest.2 }))
            }
        }
    }

    /// The branch of a tip that starts at `delta`.
    pub fn branch_at(&self, delta: f64) -> Branch {
        let touching = self.law.form().touches(delta);
        Branch { touching, joined: self.neck_level(false).is_some_and(|forms| delta >= forms) }
    }

    /// The same where a law with hysteresis has this past.
    pub fn branch_after(&self, delta: f64, past: bool) -> Branch {
        let start = self.branch_at(delta);
        match self.neck {
            Some(_) => Branch { joined: past, ..start },
            None => Branch { touching: past, ..start },
        }
    }

    /// What a law with hysteresis remembers of its past.
    pub fn past(&self, branch: Branch) -> bool {
        if self.neck.is_some() { branch.joined } else { branch.touching }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Adhesion, LawChoice, Params};
    use std::f64::consts::PI;

    /// Both programs' laws, over and beyond the places where they change.
    #[test]
    fn forces_agree_with_the_closed_forms_of_the_contact_module() {
        for law in [LawChoice::Hertz, LawChoice::Dmt, LawChoice::Jkr] {
            for modulus in [1e6, 1e9, 1e11] {
                let mut params = Params::default();
                params.contact.law = law;
                params.sample.youngs_modulus = modulus;
                params.sample.adhesion = Adhesion::Work(0.05);
                let contact = Contact::new(&params);
                let force = ReferenceForce::new(&contact);
                let unit = PI * contact.work * contact.radius;
                let fold = force.law.form().level(true).unwrap_or(0.0);
                for step in 1..4000 {
                    let delta = fold + f64::from(step) * f64::from(step) * 1e-15;
                    for touching in [delta > 0.0 || law == LawChoice::Jkr, delta > 0.0] {
                        let (own, other) = (
                            force.at(delta, || 0.0, [0.0; 2], Branch { touching, joined: false }),
                            contact.force(delta, touching),
                        );
                        // Close to the fold the square root magnifies a rounding of the indentation.
                        let bound = 1e-12 * (unit + other.abs());
                        assert!(
                            (own - other).abs() <= bound,
                            "{law:?} {modulus:e} {delta:e}: {own:e}, {other:e}"
                        );
                    }
                }
                if let Some(pull) = force.law.form().deepest_pull() {
                    assert!(
                        (force.at(pull, || 0.0, [0.0; 2], Branch { touching: true, joined: false })
                            / (-1.5 * unit)
                            - 1.0)
                            .abs()
                            < 1e-13
                    );
                }
            }
        }
    }
}

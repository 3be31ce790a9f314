//! The contact laws again, in forms of their own: nothing here shares code with `contact` or the kernel.

use super::indenter::Indenter;
use super::reference_neck::{Branch, ReferenceNeck, beside, beside_contact};
use crate::contact::{Contact, Law};
use crate::kernel::LENGTH;
use crate::kernel::contact::TERMS;
use crate::scene::{LawChoice, TermForce};
use std::f64::consts::PI;

/// A law with its constants, and up to four forces beside it, of which the last may remember; SI units.
#[derive(Clone, Copy, Debug)]
pub(super) struct ReferenceForce {
    law: ReferenceLaw,
    terms: [Option<TermForce>; TERMS],
    neck: Option<ReferenceNeck>,
}

/// A contact law with its constants; SI units.
#[derive(Clone, Copy, Debug)]
enum ReferenceLaw {
    None,
    /// f = kappa delta^1.5 with kappa = K sqrt(R): Ha, Fung & Chen 2005, equation (14).
    Hertz {
        kappa: f64,
    },
    /// The same less the adhesion P = 2 pi w R; outside -P (D0/(D0 - delta))^2: equations (17), (18).
    Dmt {
        kappa: f64,
        adhesion: f64,
        decay: f64,
    },
    /// A tip of another shape (see [`Indenter`]), with DMT's attraction.
    Shaped {
        indenter: Indenter,
        adhesion: f64,
        decay: f64,
    },
    /// A viscous sample (Ting 1966, or the ad hoc form) of retardation time `tau`, s: kappa (delta^1.5 + 1.5 tau sqrt(delta) v)
    /// inward, kappa (delta + tau v)^1.5 outward, with DMT's attraction.
    Viscous {
        kappa: f64,
        tau: f64,
        ad_hoc: bool,
        adhesion: f64,
        decay: f64,
    },
    /// A standard linear solid: a half-space of springs `kappa` delta^1.5 at once, whose share `arm` relaxes within `tau`, s.
    /// It remembers how deep its dashpots are at the centre, y, and their sum S in units of delta^1.5 over the root of a
    /// kernel's length. While the contact widens beyond them, delta y^2 > S^2, kappa (delta^1.5 - arm S); within, kappa (delta
    /// - arm y)^1.5 (1 - arm y^3/S^2)^-0.5. DMT's attraction acts beside it.
    Relaxing {
        kappa: f64,
        arm: f64,
        tau: f64,
        adhesion: f64,
        decay: f64,
    },
    /// In the contact radius: delta = a^2/R - (2/3) sqrt(6 pi w a/K), f = K a^3/R - sqrt(6 pi w K a^3), equation (16).
    /// `radius` is a at the fold, `unit` a^2/R there.
    Jkr {
        elastic: f64,
        adhesive: f64,
        radius: f64,
        unit: f64,
    },
}

impl ReferenceLaw {
    /// The law of a contact, from its modulus, radius, work and decay length.
    fn new(contact: &Contact) -> Self {
        let (k, r, w) = (contact.modulus, contact.radius, contact.work);
        let (kappa, decay) = (k * r.sqrt(), contact.decay_length);
        // A law that is named after its forces has the attraction that the scene asked for.
        let pulls = match contact.law {
            Law::Dmt | Law::ViscousDmt | Law::ShapedDmt => true,
            law => law.is_sum() && contact.choice == LawChoice::Dmt,
        };
        let adhesion = if pulls { 2.0 * PI * w * r } else { 0.0 };
        match contact.law {
            Law::None => Self::None,
            Law::Hertz => Self::Hertz { kappa },
            Law::Dmt => Self::Dmt { kappa, adhesion, decay },
            Law::ShapedHertz | Law::ShapedDmt | Law::Sum | Law::HystereticSum => {
                Self::Shaped { indenter: Indenter::new(contact), adhesion, decay }
            }
            Law::ViscousHertz | Law::ViscousDmt | Law::ViscousSum => {
                Self::Viscous { kappa, tau: contact.retardation, ad_hoc: contact.ad_hoc, adhesion, decay }
            }
            Law::RelaxingHertz | Law::RelaxingSum => Self::Relaxing {
                kappa: contact.instantaneous * r.sqrt(),
                arm: 1.0 - k / contact.instantaneous,
                tau: contact.retardation * k / contact.instantaneous,
                adhesion,
                decay,
            },
            Law::Jkr | Law::JkrSum => {
                // d delta/da = 0: 2a/R = sqrt(6 pi w/(K a))/3
                let radius = (PI * w * r * r / (6.0 * k)).cbrt();
                Self::Jkr {
                    elastic: k / r,
                    adhesive: (6.0 * PI * w * k).sqrt(),
                    radius,
                    unit: radius * radius / r,
                }
            }
        }
    }

    /// Force on the tip, N, on its branch.
    #[inline]
    fn at(&self, delta: f64, rate: impl FnOnce() -> f64, memory: [f64; 2], touching: bool) -> f64 {
        match *self {
            Self::None => 0.0,
            Self::Hertz { kappa } => hertz(kappa, delta, touching),
            Self::Dmt { kappa, adhesion, decay } => {
                hertz(kappa, delta, touching) + attraction(adhesion, decay, delta, touching)
            }
            Self::Shaped { indenter, adhesion, decay } => {
                indenter.pressed(delta, touching) + attraction(adhesion, decay, delta, touching)
            }
            Self::Viscous { kappa, tau, ad_hoc, adhesion, decay } => {
                let pull = attraction(adhesion, decay, delta, touching);
                if !touching {
                    return pull;
                }
                let along = tau * rate();
                let pressed = match along < 0.0 && !ad_hoc {
                    true => hertz(kappa, delta + along, true),
                    false => hertz(kappa, delta, true) + 1.5 * kappa * delta.max(0.0).sqrt() * along,
                };
                pressed + pull
            }
            Self::Relaxing { kappa, arm, adhesion, decay, .. } => {
                let pull = attraction(adhesion, decay, delta, touching);
                let pressed = if touching { relaxing((kappa, arm), delta, memory) } else { 0.0 };
                pressed + pull
            }
            Self::Jkr { elastic, adhesive, radius, unit } => {
                if !touching {
                    return 0.0;
                }
                let a = radius * (1.0 + growth(delta / unit + 3.0));
                let cube = a * a * a;
                elastic * cube - adhesive * cube.sqrt()
            }
        }
    }
}

impl ReferenceForce {
    /// The force of a contact and of what acts beside it.
    pub fn new(contact: &Contact) -> Self {
        let (law, terms) = (ReferenceLaw::new(contact), beside_contact(contact));
        Self { law, terms, neck: ReferenceNeck::of(contact) }
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
        let drawn_out = delta < 0.0 && matches!(self.law, ReferenceLaw::Jkr { .. });
        let inside = touching && !drawn_out;
        self.terms.iter().flatten().chain(&neck).map(|term| beside(term, delta, inside)).sum()
    }

    /// Whether it remembers two numbers, as lengths in m.
    pub fn has_memory(&self) -> bool {
        matches!(self.law, ReferenceLaw::Relaxing { .. })
    }

    /// Rates (m/s) at which a law with a memory changes it.
    pub fn remembered(&self, delta: f64, touching: bool, [depth, sum]: [f64; 2]) -> [f64; 2] {
        let ReferenceLaw::Relaxing { kappa, arm, tau, .. } = self.law else { return [0.0; 2] };
        let force = if touching { relaxing((kappa, arm), delta, [depth, sum]) } else { 0.0 };
        let pressed = force / (kappa * LENGTH.sqrt());
        [(delta.max(arm * depth) - depth) / tau, (pressed - (1.0 - arm) * sum) / tau]
    }

    /// Whether the force may end before the tip is out: by the rate, or by what the sample remembers.
    pub fn is_viscous(&self) -> bool {
        matches!(self.law, ReferenceLaw::Viscous { .. } | ReferenceLaw::Relaxing { .. })
    }

    /// Whether the force on a branch may be least or largest where the indentation is not.
    pub fn turns_anywhere(&self, branch: Branch) -> bool {
        let beside = self.neck.is_some() || self.terms.iter().any(Option::is_some);
        beside || (self.is_viscous() && branch.touching)
    }

    /// Under a law that depends on the rate (m/s): positive where the sample presses on the tip, which may end before the tip
    /// is out.
    pub fn pressing(&self, delta: f64, rate: f64, memory: [f64; 2]) -> Option<f64> {
        match self.law {
            ReferenceLaw::Viscous { tau, ad_hoc, .. } if rate < 0.0 && !ad_hoc => {
                Some((delta + tau * rate).min(delta))
            }
            ReferenceLaw::Viscous { .. } => Some(delta),
            ReferenceLaw::Relaxing { arm, .. } => Some(delta - arm * memory[0]),
            _ => None,
        }
    }

    /// Indentation at which contact changes: touch from outside, release from inside; `None` without a sample.
    fn level(&self, touching: bool) -> Option<f64> {
        match self.law {
            ReferenceLaw::None => None,
            ReferenceLaw::Jkr { unit, .. } if touching => Some(-3.0 * unit),
            _ => Some(0.0),
        }
    }

    /// Indentation at which the force that remembers begins to act, or ceases to.
    fn neck_level(&self, joined: bool) -> Option<f64> {
        Some(self.neck?.level(joined))
    }

    /// How far the indentation is from where the branch changes, positive before, and the branch behind there.
    pub fn change(&self, branch: Branch, delta: f64) -> Option<(f64, Branch)> {
        let Branch { touching, joined } = branch;
        let room = |level: f64, inside: bool| if inside { delta - level } else { level - delta };
        let contact = self.level(touching).map(|level| (room(level, touching), !touching, joined));
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
        let touching = match self.law {
            ReferenceLaw::None => false,
            ReferenceLaw::Jkr { .. } => delta >= 0.0,
            _ => delta > 0.0,
        };
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

    /// Indentation of the largest pull within the contact branch, if there is one: df/da = 0 at a^3 = 9 a_s^3.
    pub fn deepest_pull(&self) -> Option<f64> {
        match self.law {
            ReferenceLaw::Jkr { unit, .. } => {
                let ratio = 9f64.cbrt();
                Some(unit * (ratio * ratio - 4.0 * ratio.sqrt()))
            }
            _ => None,
        }
    }
}

/// A sample that relaxes: `kappa` at once, of which the share `arm` relaxes.
fn relaxing((kappa, arm): (f64, f64), delta: f64, [depth, sum]: [f64; 2]) -> f64 {
    let sum = sum * LENGTH.sqrt();
    let above = delta - arm * depth;
    if above <= 0.0 {
        0.0
    } else if delta * depth * depth >= sum * sum {
        kappa * (delta * delta.sqrt() - arm * sum).max(0.0)
    } else {
        // However hollow: the kernel's bound.
        let least = (0.5 * (1.0 - arm)).min(0.1);
        let hollow = (1.0 - arm * depth * depth * depth / (sum * sum)).max(least);
        kappa * above * above.sqrt() / hollow.sqrt()
    }
}

fn attraction(adhesion: f64, decay: f64, delta: f64, touching: bool) -> f64 {
    if touching {
        -adhesion
    } else if delta < 0.0 {
        -adhesion * (decay / (decay - delta)).powi(2)
    } else {
        -adhesion * (1.0 + 2.0 * delta / decay)
    }
}

fn hertz(kappa: f64, delta: f64, touching: bool) -> f64 {
    if touching && delta > 0.0 {
        kappa * delta * delta.sqrt()
    } else if delta.is_nan() {
        delta
    } else {
        0.0
    }
}

/// The contact radius beyond that at the fold, in units of it, `rise` above the fold in units of a_s^2/R: e of e^2 (1 + 2/(s +
/// 1)^2) = rise, s = sqrt(1 + e), by Newton's method kept inside its bracket.
fn growth(rise: f64) -> f64 {
    if rise <= 0.0 {
        return 0.0;
    }
    // The factor lies between 1 (far) and 3/2 (at the fold).
    let (mut low, mut high) = ((rise / 1.5).sqrt(), rise.sqrt());
    let s = (1.0 + low).sqrt();
    let mut e = (rise / (1.0 + 2.0 / ((s + 1.0) * (s + 1.0)))).sqrt();
    for _ in 0..60 {
        let s = (1.0 + e).sqrt();
        let value = e * e * (1.0 + 2.0 / ((s + 1.0) * (s + 1.0))) - rise;
        if value < 0.0 {
            low = e;
        } else {
            high = e;
        }
        let slope = 2.0 * e * (s * s + s + 1.0) / ((s + 1.0) * s);
        let mut next = e - value / slope;
        if !(low..=high).contains(&next) {
            next = 0.5 * (low + high);
        }
        let moved = (next - e).abs();
        e = next;
        if moved <= 2.0 * f64::EPSILON * e || moved.is_nan() {
            break;
        }
    }
    e
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Adhesion, LawChoice, Params};

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
                let fold = force.level(true).unwrap_or(0.0);
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
                if let Some(pull) = force.deepest_pull() {
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

//! The forces of a contact as the independent program has them.

use crate::support::laws::{CHARGED_CONE, Law as Force, Neck, Outside, Tip};
use afmsweep::contact::{Contact, Law};
use afmsweep::kernel::contact::force_table::{EXPONENTIAL, INVERSE};
use afmsweep::plan::Plan;
use afmsweep::scene::{HydrationStrength, LawChoice, NeckModel, OutsideForce, TermForce, TipShape};
use std::f64::consts::PI;

/// The contact law in the independent program's words.
pub fn force_law(plan: &Plan, instance: usize) -> Force {
    let contact = plan.contact(instance as u32);
    let (k, r, w) = (contact.modulus, contact.radius, contact.work);
    match contact.law {
        Law::None => Force::None,
        Law::Hertz => Force::Hertz { k, r },
        Law::Dmt => Force::Dmt { k, r, w, d0: contact.decay_length },
        Law::Jkr if w == 0.0 => Force::Hertz { k, r },
        Law::Jkr => Force::Jkr { k, r, w },
        Law::ShapedHertz | Law::ShapedDmt | Law::Sum | Law::HystereticSum => {
            let tangent = contact.half_angle.to_radians().tan();
            let tip = match contact.shape {
                _ if contact.layer.is_some() => {
                    Tip::Layer { terms: *contact.shaped().unwrap().coefficients() }
                }
                TipShape::Paraboloid => Tip::Paraboloid { r },
                TipShape::Sphere => Tip::Sphere { r },
                TipShape::Cone => Tip::Cone { tangent },
                TipShape::Pyramid => Tip::Pyramid { tangent },
                TipShape::Punch => Tip::Punch { r },
                TipShape::Hyperboloid => Tip::Hyperboloid { r, tangent },
                TipShape::SpheroCone => Tip::SpheroCone { r, tangent },
            };
            let pull = if contact.choice == LawChoice::Dmt { 2.0 * PI * r * w } else { 0.0 };
            let (e, d0) = (0.75 * k, contact.decay_length);
            match contact.law {
                Law::Sum | Law::HystereticSum => {
                    Force::Beside { e, tip, pull, d0, outside: outside(contact), neck: neck(contact) }
                }
                _ => Force::Indenter { e, tip, pull, d0 },
            }
        }
        Law::JkrSum => Force::JkrBeside { k, r, w, outside: outside(contact) },
        Law::ViscousHertz | Law::ViscousDmt | Law::RelaxingHertz | Law::ViscousSum | Law::RelaxingSum => {
            unreachable!("the independent program has elastic samples")
        }
    }
}

/// The word of a scene whose contact, with what tests put beside it, has the law of this name.
pub fn law_word(law: &str) -> &str {
    match law.strip_prefix("sum") {
        Some("-jkr") => "jkr",
        Some(_) => "dmt",
        None => law.split('-').next().unwrap_or(law),
    }
}

/// The forces of tests of the laws that are sums: two, and a liquid neck where the law remembers.
pub fn outside_forces(law: &str) -> Vec<OutsideForce> {
    let mut all = vec![
        OutsideForce::Electrostatic { bias: 1.0, contact_potential: 0.2, cut_off: 0.5e-9, cone: None },
        OutsideForce::Hydration {
            strength: HydrationStrength::Force(0.3e-9),
            decay_length: 0.8e-9,
            period: Some(0.5e-9),
            phase: 20.0,
        },
    ];
    if law == Law::HystereticSum.name() {
        all.push(OutsideForce::Capillary {
            strength: 3e-9,
            forms_at: 0.4e-9,
            breaks_at: 2e-9,
            decay_length: None,
            model: NeckModel::InverseSquare,
        });
    }
    all
}

/// The one force of the tests that oscillates: strength (N), decay length and period (m), phase (degree).
pub const WAVE: [f64; 4] = [0.4e-9, 0.5e-9, 0.28e-9, 40.0];

/// The forces beside a contact. Of tables that are not the program's own the tests have [`WAVE`] and [`CHARGED_CONE`]. The first
/// force of a sphero-cone is the contact itself.
fn outside(contact: Contact) -> [Outside; 4] {
    let first = usize::from(contact.shape == TipShape::SpheroCone);
    std::array::from_fn(|n| {
        let term = contact.terms[n].filter(|_| n >= first);
        if let Some(term) = term.filter(|_| n == 3 && contact.law == Law::HystereticSum) {
            return neck_force(term);
        }
        let Some(TermForce { amplitude: at_touch, length, table }) = term else { return Outside::None };
        let [strength, decay, period, phase] = WAVE;
        match table {
            EXPONENTIAL => Outside::Decay { at_touch, length },
            INVERSE => Outside::Inverse { at_touch, length },
            _ if at_touch < 0.0 => {
                let [_, cut_off, r, half_angle, _] = CHARGED_CONE;
                let apart = cut_off + r * (1.0 - half_angle.to_radians().sin());
                assert!((length / apart - 1.0).abs() < 1e-12, "a table is no formula");
                Outside::Cone
            }
            _ => {
                assert_eq!((at_touch, length), (strength, decay), "a table is no formula");
                Outside::Wave { strength, length, period, phase: phase.to_radians() }
            }
        }
    })
}

/// Where a force that remembers forms and breaks.
fn neck(contact: Contact) -> Option<Neck> {
    let [forms, breaks] = contact.neck;
    (contact.law == Law::HystereticSum).then_some(Neck { forms, breaks, acts: false })
}

/// A liquid neck: its force is nothing at its length if it is a straight line.
fn neck_force(term: TermForce) -> Outside {
    let TermForce { amplitude: at_touch, length, .. } = term;
    match term.at(-length)[0] {
        0.0 => Outside::Straight { at_touch, length },
        _ => Outside::InverseSquare { at_touch, length },
    }
}

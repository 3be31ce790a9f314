//! What acts beside a contact, as the reference has it: forces at a distance, and one that remembers.

use crate::contact::{Contact, Law};
use crate::kernel::contact::TERMS;
use crate::kernel::contact::force_table::{EXPONENTIAL, ForceTable, INVERSE};
use crate::scene::{LawChoice, TermForce, TipShape};

/// A force that acts from where it forms on the way in to where it breaks on the way out, indentations in m.
#[derive(Clone, Copy, Debug)]
pub(super) struct ReferenceNeck {
    pub force: TermForce,
    forms: f64,
    breaks: f64,
}

/// Which branch of a law the tip is on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Branch {
    /// Whether the tip is in contact.
    pub touching: bool,
    /// Whether the force that remembers acts.
    pub joined: bool,
}

impl ReferenceNeck {
    /// That of a contact, if it has one.
    pub fn of(contact: &Contact) -> Option<Self> {
        let force = contact.terms[TERMS - 1].filter(|_| contact.law == Law::HystereticSum)?;
        Some(Self { force, forms: contact.neck[0], breaks: contact.neck[1] })
    }

    /// Indentation at which it begins to act, or ceases to.
    pub fn level(self, joined: bool) -> f64 {
        if joined { self.breaks } else { self.forms }
    }
}

/// The forces beside the contact that act always.
pub(super) fn beside_contact(contact: &Contact) -> [Option<TermForce>; TERMS] {
    let mut terms = contact.terms;
    if contact.law == Law::HystereticSum {
        terms[TERMS - 1] = None;
    }
    if contact.law == Law::RelaxingSum && contact.choice == LawChoice::Dmt {
        // The last of them is the attraction, which the law has in its closed form.
        terms.iter_mut().rev().find(|term| term.is_some()).map(Option::take);
    }
    if contact.shape == TipShape::SpheroCone {
        // Its first is the contact, which is the indenter's.
        terms[0] = None;
    }
    terms
}

/// The closed forms of the program's own tables; a user's table is its own.
pub(super) fn beside(term: &TermForce, delta: f64, touching: bool) -> f64 {
    let x = delta / term.length;
    let value = match (term.table, touching) {
        (EXPONENTIAL | INVERSE, true) => 1.0,
        (EXPONENTIAL, false) => x.min(1.0).exp(),
        (INVERSE, false) => 1.0 / (1.0 - x.min(0.5)),
        (table, _) => {
            let table = ForceTable::numbered(table);
            let ends_at_touch = table.ends().1 <= 0.0;
            table.at(if touching && ends_at_touch { x.max(0.0) } else { x })[0]
        }
    };
    term.amplitude * value
}

//! Contacts that many instances share, each stored once.

use super::ensemble::Contacts;
use super::interning::Codes;
use crate::contact::Compact;
use crate::scene::Cases;
use std::collections::HashMap;

/// Most contacts that are stored. If there are more, each is made from the scene's case on demand.
const MAX_SHARED_CONTACTS: usize = 1 << 16;

/// The constants of a contact, bit by bit.
type Key = [u64; Compact::CONSTANTS];

/// The contacts of an ensemble while it is built.
pub(super) struct SharedContacts {
    all: Vec<Compact>,
    /// Their numbers by their constants.
    known: HashMap<Key, Vec<u32>>,
    /// By instance so far: the number of its contact. `None` if too many are distinct.
    of: Option<Codes>,
}

impl SharedContacts {
    pub fn new() -> Self {
        Self { all: Vec::new(), known: HashMap::new(), of: Some(Codes::zeros(0)) }
    }

    /// Adds the contact of one more instance.
    pub fn push(&mut self, contact: Compact) {
        if self.of.is_none() {
            return;
        }
        let key = contact.constants().map(f64::to_bits);
        let same = self.known.entry(key).or_default();
        let number = match same.iter().find(|number| self.all[**number as usize] == contact) {
            Some(number) => *number,
            None => {
                same.push(self.all.len() as u32);
                self.all.push(contact);
                self.all.len() as u32 - 1
            }
        };
        match &mut self.of {
            Some(of) if self.all.len() <= MAX_SHARED_CONTACTS => of.push(number),
            of => *of = None,
        }
    }

    /// The contacts of all instances of a scene.
    pub fn end(self, cases: Cases) -> Contacts {
        match self.of {
            Some(of) => Contacts::Shared { of, all: self.all },
            None => Contacts::Made(Box::new(cases)),
        }
    }
}

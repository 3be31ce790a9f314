//! Contacts that many instances share, each stored once.

use super::ensemble::Contacts;
use super::interning::Codes;
use crate::contact::Compact;
use crate::scene::{Cases, Layout};
use std::collections::HashMap;

/// Most contacts that are stored. If there are more, each is made from the scene's case on demand.
const MAX_SHARED_CONTACTS: usize = 1 << 16;
/// A longer list whose first contacts, this many, are all distinct is taken to repeat none.
const DISTINCT_AT_FIRST: usize = 1 << 10;

/// The constants of a contact, bit by bit.
type Key = [u64; Compact::CONSTANTS];

/// The contacts of an ensemble while it is built.
pub(super) struct SharedContacts {
    all: Vec<Compact>,
    /// Their numbers by their constants.
    known: HashMap<Key, Vec<u32>>,
    /// By instance so far: the number of its contact. `None` if too many are distinct.
    of: Option<Codes>,
    /// Whether the instances are a list that is longer than what can be stored.
    long_list: bool,
}

impl SharedContacts {
    /// None yet, of so many instances that form a list or a grid.
    pub fn new(instances: usize, layout: Layout) -> Self {
        let long_list = layout == Layout::List && instances > MAX_SHARED_CONTACTS;
        Self { all: Vec::new(), known: HashMap::new(), of: Some(Codes::zeros(0)), long_list }
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
        let most = if self.long_list && self.of.as_ref().is_some_and(|of| of.len() + 1 == self.all.len()) {
            DISTINCT_AT_FIRST
        } else {
            MAX_SHARED_CONTACTS
        };
        match &mut self.of {
            Some(of) if self.all.len() <= most => of.push(number),
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

//! Contacts that many instances share, each held once.

use crate::contact::{Compact, Contact};
use std::collections::HashMap;

/// Contacts that are looked for again, at most: where all are different, nothing is gained by it.
const MOST: usize = 1 << 16;

/// The contacts of an ensemble while it is built.
#[derive(Default)]
pub(super) struct Contacts {
    pub all: Vec<Compact>,
    /// Numbers of the latest by what they are made of.
    known: HashMap<[u64; 5], u32>,
}

impl Contacts {
    /// The number of a contact.
    pub fn number(&mut self, contact: Contact) -> u32 {
        let Contact { modulus, radius, work, decay_length, tabor, .. } = contact;
        let contact = Compact::from(&contact);
        let key = [modulus, radius, work, decay_length, tabor].map(f64::to_bits);
        if let Some(number) = self.known.get(&key)
            && self.all[*number as usize] == contact
        {
            return *number;
        }
        let number = self.all.len() as u32;
        self.all.push(contact);
        if self.known.len() >= MOST {
            self.known.clear();
        }
        self.known.insert(key, number);
        number
    }
}

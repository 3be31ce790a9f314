//! Contacts begun per drive period, averaged over the measured ones.

use super::{Entry, Observable, Scale, Value, Wants};

pub(super) const ENTRY: Entry = Entry {
    observable: Observable::Contacts,
    name: "contacts",
    units: "1",
    long_name: "contacts begun per period",
    wants: Wants::CONTACT,
    scale: Scale::One,
    value: Value::One(|measured| measured.contacts),
};

//! Share of the period in contact: indentation above zero, for JKR from touch to fold.

use super::{Entry, Observable, Scale, Value, Wants};

pub(super) const ENTRY: Entry = Entry {
    observable: Observable::ContactTime,
    name: "contact_time",
    units: "1",
    long_name: "share of the period in contact",
    wants: Wants::CONTACT,
    scale: Scale::One,
    value: Value::One(|measured| measured.contact_time),
};

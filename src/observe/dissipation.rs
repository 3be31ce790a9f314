//! Energy the tip loses to the sample per period, minus the integral of force times speed.

use super::{Entry, Observable, Value, Wants};

pub(super) const ENTRY: Entry = Entry {
    observable: Observable::Dissipation,
    name: "dissipation",
    units: "J",
    long_name: "energy lost in the sample per period",
    wants: Wants::ENERGY,
    value: Value::One(|measured| measured.dissipation),
};

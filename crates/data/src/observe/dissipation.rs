//! Energy the tip loses to the sample per period, minus the integral of force times speed.

use super::{Entry, Observable, Scale, Value, Wants};

pub(super) const ENTRY: Entry = Entry {
    observable: Observable::Dissipation,
    name: "dissipation",
    units: "J",
    long_name: "energy lost in the sample per period",
    wants: Wants::ENERGY,
    scale: Scale::Work,
    value: Value::One(|measured| measured.dissipation),
};

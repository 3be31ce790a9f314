//! Mean of force times tip travel, from which the frequency shift follows.

use super::{Entry, Observable, Scale, Value, Wants};

pub(super) const ENTRY: Entry = Entry {
    observable: Observable::Virial,
    name: "virial",
    units: "J",
    long_name: "virial: mean of tip force times tip travel",
    wants: Wants::ENERGY,
    scale: Scale::WorkOrItself,
    value: Value::One(|measured| measured.virial),
};

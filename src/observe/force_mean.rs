//! Mean force over the measured periods.

use super::{Entry, Observable, Value, Wants};

pub(super) const ENTRY: Entry = Entry {
    observable: Observable::ForceMean,
    name: "force_mean",
    units: "N",
    long_name: "mean tip force",
    wants: Wants::ENERGY,
    value: Value::One(|measured| measured.force_mean),
};

//! Mean force over the measured periods.

use super::{Entry, Observable, Scale, Value, Wants};

pub(super) const ENTRY: Entry = Entry {
    observable: Observable::ForceMean,
    name: "force_mean",
    units: "N",
    long_name: "mean tip force",
    wants: Wants::ENERGY,
    scale: Scale::Force,
    value: Value::One(|measured| measured.force_mean),
};

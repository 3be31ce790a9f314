//! Smallest force on the tip: the largest pull where it is negative.

use super::{Entry, Observable, Scale, Value, Wants};

pub(super) const ENTRY: Entry = Entry {
    observable: Observable::ForceMin,
    name: "force_min",
    units: "N",
    long_name: "smallest tip force",
    wants: Wants::EXTREMES,
    scale: Scale::Force,
    value: Value::One(|measured| measured.force_min),
};

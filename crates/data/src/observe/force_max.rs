//! Largest force on the tip; positive pushes away.

use super::{Entry, Observable, Scale, Value, Wants};

pub(super) const ENTRY: Entry = Entry {
    observable: Observable::ForceMax,
    name: "force_max",
    units: "N",
    long_name: "largest tip force",
    wants: Wants::EXTREMES,
    scale: Scale::Force,
    value: Value::One(|measured| measured.force_max),
};

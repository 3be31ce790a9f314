//! Distance from the tip at rest to the surface: given, or what a set-point leads to.

use super::{Entry, Observable, Scale, Value, Wants};

pub(super) const ENTRY: Entry = Entry {
    observable: Observable::Gap,
    name: "gap",
    units: "m",
    long_name: "gap between the tip at rest and the surface",
    wants: Wants::FUNDAMENTAL,
    scale: Scale::Length,
    value: Value::One(|measured| measured.gap),
};

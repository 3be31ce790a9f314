//! Largest indentation; NaN where the tip never was in contact.

use super::{Entry, Observable, Scale, Value, Wants};

pub(super) const ENTRY: Entry = Entry {
    observable: Observable::IndentationMax,
    name: "indentation_max",
    units: "m",
    long_name: "largest indentation",
    wants: Wants::EXTREMES,
    scale: Scale::Depth,
    value: Value::One(|measured| measured.indentation_max),
};

//! Lag of the fundamental behind the drive's sine, 0 to 360 degrees.

use super::{Entry, Observable, Scale, Value, Wants};

pub(super) const ENTRY: Entry = Entry {
    observable: Observable::Phase,
    name: "phase",
    units: "degree",
    long_name: "phase lag of the tip's travel behind the drive",
    wants: Wants::FUNDAMENTAL,
    scale: Scale::Phase,
    value: Value::One(|measured| measured.phase),
};

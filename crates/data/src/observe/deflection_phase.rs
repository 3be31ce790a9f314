//! Lag of the deflection's fundamental behind the drive's sine, 0 to 360 degrees.

use super::{Entry, Observable, Scale, Value, Wants};

pub(super) const ENTRY: Entry = Entry {
    observable: Observable::DeflectionPhase,
    name: "deflection_phase",
    units: "degree",
    long_name: "phase lag of the deflection behind the drive",
    wants: Wants::FUNDAMENTAL,
    scale: Scale::DeflectionPhase,
    value: Value::One(|measured| measured.deflection_phase),
};

//! Lag of the free oscillation behind the drive's sine: what phases are mostly told against.

use super::{Entry, Observable, Scale, Value, Wants};

pub(super) const ENTRY: Entry = Entry {
    observable: Observable::FreePhase,
    name: "free_phase",
    units: "degree",
    long_name: "phase lag of the free tip's travel behind the drive",
    wants: Wants::FUNDAMENTAL,
    scale: Scale::One,
    value: Value::One(|measured| measured.free_phase),
};

//! Amplitude of the tip's travel at the drive frequency: what a lock-in amplifier shows.

use super::{Entry, Observable, Scale, Value, Wants};

pub(super) const ENTRY: Entry = Entry {
    observable: Observable::Amplitude,
    name: "amplitude",
    units: "m",
    long_name: "amplitude of the tip's travel, fundamental",
    wants: Wants::FUNDAMENTAL,
    scale: Scale::Length,
    value: Value::One(|measured| measured.harmonics[0]),
};

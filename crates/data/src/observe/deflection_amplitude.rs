//! Amplitude of the tip against the base at the drive frequency: what a lock-in amplifier behind a photodiode shows.

use super::{Entry, Observable, Scale, Value, Wants};

pub(super) const ENTRY: Entry = Entry {
    observable: Observable::DeflectionAmplitude,
    name: "deflection_amplitude",
    units: "m",
    long_name: "amplitude of the deflection, fundamental",
    wants: Wants::FUNDAMENTAL,
    scale: Scale::Length,
    value: Value::One(|measured| measured.deflection_amplitude),
};

//! Amplitudes of the tip's travel at whole multiples of the drive frequency.

use super::{Entry, Observable, Scale, Value, Wants};

pub(super) const ENTRY: Entry = Entry {
    observable: Observable::HarmonicAmplitude,
    name: "harmonic_amplitude",
    units: "m",
    long_name: "amplitude of the tip's travel by harmonic",
    wants: Wants::HARMONIC,
    scale: Scale::Length,
    value: Value::Harmonics(|measured| &measured.harmonics),
};

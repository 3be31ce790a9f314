//! By how much the sample's force shifts the resonance of the lever's first mode: what frequency modulation shows, told for
//! any orbit.

use super::{Entry, Observable, Scale, Value, Wants};

pub(super) const ENTRY: Entry = Entry {
    observable: Observable::FrequencyShift,
    name: "frequency_shift",
    units: "Hz",
    long_name: "shift of the resonance by the sample's force",
    wants: Wants::FUNDAMENTAL,
    scale: Scale::Shift,
    value: Value::One(|measured| measured.frequency_shift),
};

//! Mean of the tip against the base: the mean force times what a steady force bends.

use super::{Entry, Observable, Scale, Value, Wants};

pub(super) const ENTRY: Entry = Entry {
    observable: Observable::DeflectionMean,
    name: "deflection_mean",
    units: "m",
    long_name: "mean deflection",
    wants: Wants::ENERGY,
    scale: Scale::Length,
    value: Value::One(|measured| measured.deflection_mean),
};

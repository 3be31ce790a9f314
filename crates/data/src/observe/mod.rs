//! What is measured on each instance, with its name, unit and meaning in the results file.
//!
//! One observable, one file; adding one is its file, a variant and a line in `ENTRIES`, and what docs/extending.md lists.

mod amplitude;
mod contact_time;
mod contacts;
mod deflection_amplitude;
mod deflection_mean;
mod deflection_phase;
mod dissipation;
mod force_max;
mod force_mean;
mod force_min;
mod free_phase;
mod frequency_shift;
mod gap;
mod harmonic_amplitude;
mod indentation_max;
mod phase;
mod status;
mod virial;

pub use crate::kernel::{HARMONICS, Wants};
pub use status::Status;

use std::ops::Range;

/// A quantity a scene can ask for (`[output] observables`).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Observable {
    Amplitude,
    Phase,
    ForceMax,
    ForceMin,
    ForceMean,
    IndentationMax,
    ContactTime,
    Dissipation,
    Virial,
    Contacts,
    HarmonicAmplitude,
    DeflectionAmplitude,
    DeflectionPhase,
    DeflectionMean,
    FreePhase,
    FrequencyShift,
    Gap,
}

/// What all of these observables need an engine to sum.
pub fn wants(observables: &[Observable]) -> Wants {
    observables.iter().fold(Wants::FUNDAMENTAL, |all, observable| all.or(observable.entry().wants))
}

/// One instance's measurements, SI units, over the measured periods. What was not wanted is NaN.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// Amplitude of the tip's travel by harmonic, m.
    pub harmonics: [f64; HARMONICS],
    /// Degree.
    pub phase: f64,
    /// N
    pub force_max: f64,
    /// N
    pub force_min: f64,
    /// N
    pub force_mean: f64,
    /// m
    pub indentation_max: f64,
    /// Share of the period.
    pub contact_time: f64,
    /// J per period.
    pub dissipation: f64,
    /// J
    pub virial: f64,
    /// Per period.
    pub contacts: f64,
    /// m
    pub deflection_amplitude: f64,
    /// Degree.
    pub deflection_phase: f64,
    /// m
    pub deflection_mean: f64,
    /// Degree.
    pub free_phase: f64,
    /// Hz
    pub frequency_shift: f64,
    /// m
    pub gap: f64,
}

impl Measured {
    /// Nothing measured.
    pub const NONE: Self = Self {
        harmonics: [f64::NAN; HARMONICS],
        phase: f64::NAN,
        force_max: f64::NAN,
        force_min: f64::NAN,
        force_mean: f64::NAN,
        indentation_max: f64::NAN,
        contact_time: f64::NAN,
        dissipation: f64::NAN,
        virial: f64::NAN,
        contacts: f64::NAN,
        deflection_amplitude: f64::NAN,
        deflection_phase: f64::NAN,
        deflection_mean: f64::NAN,
        free_phase: f64::NAN,
        frequency_shift: f64::NAN,
        gap: f64::NAN,
    };

    /// How many numbers it is.
    pub const WIDTH: usize = HARMONICS + 15;

    /// All of its numbers, in an order that a run's journal has too.
    pub fn numbers(&self) -> [f64; Self::WIDTH] {
        let mut numbers = [f64::NAN; Self::WIDTH];
        numbers[..HARMONICS].copy_from_slice(&self.harmonics);
        numbers[HARMONICS..].copy_from_slice(&[
            self.phase,
            self.force_max,
            self.force_min,
            self.force_mean,
            self.indentation_max,
            self.contact_time,
            self.dissipation,
            self.virial,
            self.contacts,
            self.deflection_amplitude,
            self.deflection_phase,
            self.deflection_mean,
            self.free_phase,
            self.frequency_shift,
            self.gap,
        ]);
        numbers
    }

    /// What these are the [`Measured::numbers`] of.
    pub fn of_numbers(numbers: &[f64; Self::WIDTH]) -> Self {
        let mut harmonics = [f64::NAN; HARMONICS];
        harmonics.copy_from_slice(&numbers[..HARMONICS]);
        let number = |place: usize| numbers[HARMONICS + place];
        Self {
            harmonics,
            phase: number(0),
            force_max: number(1),
            force_min: number(2),
            force_mean: number(3),
            indentation_max: number(4),
            contact_time: number(5),
            dissipation: number(6),
            virial: number(7),
            contacts: number(8),
            deflection_amplitude: number(9),
            deflection_phase: number(10),
            deflection_mean: number(11),
            free_phase: number(12),
            frequency_shift: number(13),
            gap: number(14),
        }
    }

    /// Whether anything was.
    pub fn is_any(&self) -> bool {
        let mut row = [f64::NAN; HARMONICS];
        Observable::all().any(|observable| {
            let row = &mut row[..observable.width()];
            observable.write(self, row);
            row.iter().any(|value| !value.is_nan())
        })
    }
}

/// On what an observable's errors count.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// Lengths.
    Length,
    /// Lengths; where only one of two results has the observable, its whole value is the error: one of them just misses the
    /// sample.
    Depth,
    /// Forces.
    Force,
    /// Work.
    Work,
    /// Work, or the observable itself where that is more.
    WorkOrItself,
    /// Its own unit.
    One,
    /// An angle, in degree, of the fundamental of the travel.
    Phase,
    /// An angle, in degree, of the fundamental of the deflection.
    DeflectionPhase,
    /// A shift of the resonance, in Hz.
    Shift,
}

impl Scale {
    /// In words, for those who read a results file.
    pub fn words(self) -> &'static str {
        match self {
            Self::Length | Self::Depth => "free tip amplitude",
            Self::Force => "larger of the sizes of force_max and force_min",
            Self::Work => "drive_work",
            Self::WorkOrItself => "drive_work, or the value itself if larger",
            Self::One => "1",
            Self::Phase => "one radian, times the share of the free amplitude that is left",
            Self::Shift => {
                "what an error of the free tip amplitude in the fundamental makes of it, to first order"
            }
            Self::DeflectionPhase => {
                "one radian, times deflection_amplitude over the free tip amplitude, at most 1"
            }
        }
    }
}

/// How an observable follows from the measurements.
enum Value {
    One(fn(&Measured) -> f64),
    Harmonics(fn(&Measured) -> &[f64; HARMONICS]),
}

/// One line of the list of observables.
struct Entry {
    observable: Observable,
    name: &'static str,
    units: &'static str,
    long_name: &'static str,
    /// What must be summed for it.
    wants: Wants,
    scale: Scale,
    value: Value,
}

/// The list: every observable there is.
static ENTRIES: &[Entry] = &[
    amplitude::ENTRY,
    phase::ENTRY,
    force_max::ENTRY,
    force_min::ENTRY,
    force_mean::ENTRY,
    indentation_max::ENTRY,
    contact_time::ENTRY,
    dissipation::ENTRY,
    virial::ENTRY,
    contacts::ENTRY,
    harmonic_amplitude::ENTRY,
    deflection_amplitude::ENTRY,
    deflection_phase::ENTRY,
    deflection_mean::ENTRY,
    free_phase::ENTRY,
    frequency_shift::ENTRY,
    gap::ENTRY,
];

impl Observable {
    /// Every observable there is.
    pub fn all() -> impl Iterator<Item = Self> {
        ENTRIES.iter().map(|entry| entry.observable)
    }

    fn entry(self) -> &'static Entry {
        // Every variant has its line; a test holds the two together.
        ENTRIES.iter().find(|entry| entry.observable == self).unwrap_or(&ENTRIES[0])
    }

    /// Keyword in the scene file and variable name in the results file.
    pub fn name(self) -> &'static str {
        self.entry().name
    }

    /// SI unit as the results file writes it.
    pub fn units(self) -> &'static str {
        self.entry().units
    }

    /// Label for people.
    pub fn long_name(self) -> &'static str {
        self.entry().long_name
    }

    /// The observable of that keyword.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::all().find(|observable| observable.name() == name)
    }

    /// On what its errors count.
    pub fn scale(self) -> Scale {
        self.entry().scale
    }

    /// Numbers per instance: 1, or one per harmonic.
    pub fn width(self) -> usize {
        match self.entry().value {
            Value::One(_) => 1,
            Value::Harmonics(_) => HARMONICS,
        }
    }

    /// Where its numbers stand among all: see [`Measured::numbers`].
    pub fn places(self) -> Range<usize> {
        let counted = Measured::of_numbers(&std::array::from_fn(|place| place as f64));
        let mut row = [0.0; HARMONICS];
        self.write(&counted, &mut row[..self.width()]);
        let first = row[0] as usize;
        first..first + self.width()
    }

    /// Writes this observable's numbers into `row`, which has [`Observable::width`] places.
    pub fn write(self, measured: &Measured, row: &mut [f64]) {
        match self.entry().value {
            Value::One(value) => row[0] = value(measured),
            Value::Harmonics(values) => row.copy_from_slice(values(measured)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_observable_has_its_own_line() {
        for observable in [
            Observable::Amplitude,
            Observable::Phase,
            Observable::ForceMax,
            Observable::ForceMin,
            Observable::ForceMean,
            Observable::IndentationMax,
            Observable::ContactTime,
            Observable::Dissipation,
            Observable::Virial,
            Observable::Contacts,
            Observable::HarmonicAmplitude,
            Observable::DeflectionAmplitude,
            Observable::DeflectionPhase,
            Observable::DeflectionMean,
            Observable::FreePhase,
            Observable::FrequencyShift,
            Observable::Gap,
        ] {
            assert_eq!(observable.entry().observable, observable);
            assert_eq!(Observable::from_name(observable.name()), Some(observable));
        }
        assert_eq!(Observable::all().count(), 17);
    }

    /// An observable's numbers are some of those that are measured, as they are.
    #[test]
    fn every_observable_has_its_place() {
        let numbers: [f64; Measured::WIDTH] = std::array::from_fn(|place| (place * place) as f64 - 0.5);
        for observable in Observable::all() {
            let mut row = vec![f64::NAN; observable.width()];
            observable.write(&Measured::of_numbers(&numbers), &mut row);
            assert_eq!(row, numbers[observable.places()], "{}", observable.name());
        }
    }
}

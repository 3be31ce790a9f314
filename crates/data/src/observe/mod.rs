//! What is measured on each instance, with its name, unit and meaning in the results file.
//!
//! Two lists say all of it: `observables!` what a scene can ask for, `measured!` the numbers that it follows from.

mod status;

use crate::kernel::PeriodSums;
pub use crate::kernel::{HARMONICS, Wants};
pub use status::Status;

use std::ops::Range;

/// From the list of observables: keyword in the scene file and variable name in the results file, SI unit as that writes it,
/// label for people, what must be summed for it, on what its errors count, how it follows from the measurements.
macro_rules! observables {
    ($($(#[$doc:meta])* $variant:ident, $name:ident, $units:literal, $long_name:literal, $wants:ident, $scale:ident $(= $value:expr)?;)*) => {
        /// A quantity a scene can ask for (`[output] observables`).
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum Observable {
            $($(#[$doc])* $variant,)*
        }

        /// Every observable there is, in the order of the variants.
        static ENTRIES: &[Entry] = &[$(Entry {
            observable: Observable::$variant,
            name: stringify!($name),
            units: $units,
            long_name: $long_name,
            wants: Wants::$wants,
            scale: Scale::$scale,
            value: value!($name $(= $value)?),
        }),*];
    };
}

/// What an observable is: the number of its name, or as it says itself.
macro_rules! value {
    ($name:ident) => {
        Value::One(|of| of.$name)
    };
    ($name:ident = $value:expr) => {
        $value
    };
}

observables! {
    /// Amplitude of the tip's travel at the drive frequency: what a lock-in amplifier shows.
    Amplitude, amplitude, "m", "amplitude of the tip's travel, fundamental",
        FUNDAMENTAL, Length = Value::One(|of| of.harmonics[0]);
    /// Lag of the fundamental behind the drive's sine, 0 to 360 degrees.
    Phase, phase, "degree", "phase lag of the tip's travel behind the drive", FUNDAMENTAL, Phase;
    /// Largest force on the tip; positive pushes away.
    ForceMax, force_max, "N", "largest tip force", EXTREMES, Force;
    /// Smallest force on the tip: the largest pull where it is negative.
    ForceMin, force_min, "N", "smallest tip force", EXTREMES, Force;
    /// Mean force over the measured periods.
    ForceMean, force_mean, "N", "mean tip force", ENERGY, Force;
    /// Largest indentation; NaN where the tip never was in contact.
    IndentationMax, indentation_max, "m", "largest indentation", EXTREMES, Depth;
    /// Share of the period in contact: indentation above zero, for JKR from touch to fold.
    ContactTime, contact_time, "1", "share of the period in contact", CONTACT, One;
    /// Energy the tip loses to the sample per period, minus the integral of force times speed.
    Dissipation, dissipation, "J", "energy lost in the sample per period", ENERGY, Work;
    /// Mean of force times tip travel, from which the frequency shift follows.
    Virial, virial, "J", "virial: mean of tip force times tip travel", ENERGY, WorkOrItself;
    /// Contacts begun per drive period, averaged over the measured ones.
    Contacts, contacts, "1", "contacts begun per period", CONTACT, One;
    /// Amplitudes of the tip's travel at whole multiples of the drive frequency.
    HarmonicAmplitude, harmonic_amplitude, "m", "amplitude of the tip's travel by harmonic",
        HARMONIC, Length = Value::Harmonics(|of| &of.harmonics);
    /// Amplitude of the tip against the base at the drive frequency: what a lock-in amplifier behind a photodiode
    /// shows.
    DeflectionAmplitude, deflection_amplitude, "m", "amplitude of the deflection, fundamental", FUNDAMENTAL, Length;
    /// Lag of the deflection's fundamental behind the drive's sine, 0 to 360 degrees.
    DeflectionPhase, deflection_phase, "degree", "phase lag of the deflection behind the drive",
        FUNDAMENTAL, DeflectionPhase;
    /// Mean of the tip against the base: the mean force times what a steady force bends.
    DeflectionMean, deflection_mean, "m", "mean deflection", ENERGY, Length;
    /// Lag of the free oscillation behind the drive's sine: what phases are mostly told against.
    FreePhase, free_phase, "degree", "phase lag of the free tip's travel behind the drive", FUNDAMENTAL, One;
    /// By how much the sample's force shifts the resonance of the lever's first mode: what frequency modulation
    /// shows, told for any orbit.
    FrequencyShift, frequency_shift, "Hz", "shift of the resonance by the sample's force", FUNDAMENTAL, Shift;
    /// Distance from the tip at rest to the surface: given, or what a set-point leads to.
    Gap, gap, "m", "gap between the tip at rest and the surface", FUNDAMENTAL, Length;
}

/// From the list of numbers beside the harmonics, in an order that a run's journal has too: a new one is its last. One that
/// follows from sums of a period names their group and says how.
macro_rules! measured {
    ($($(#[$doc:meta])* $field:ident $(= $group:ident, $value:expr)?;)*) => {
        /// One instance's measurements, SI units, over the measured periods. What was not wanted is NaN.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct Measured {
            /// Amplitude of the tip's travel by harmonic, m.
            pub harmonics: [f64; HARMONICS],
            $($(#[$doc])* pub $field: f64,)*
        }

        impl Measured {
            /// Nothing measured.
            pub const NONE: Self = Self { harmonics: [f64::NAN; HARMONICS], $($field: f64::NAN),* };

            /// How many numbers it is.
            pub const WIDTH: usize = HARMONICS + [$(stringify!($field)),*].len();

            /// All of its numbers.
            pub fn numbers(&self) -> [f64; Self::WIDTH] {
                let mut numbers = [f64::NAN; Self::WIDTH];
                numbers[..HARMONICS].copy_from_slice(&self.harmonics);
                numbers[HARMONICS..].copy_from_slice(&[$(self.$field),*]);
                numbers
            }

            /// What these are the [`Measured::numbers`] of.
            pub fn of_numbers(numbers: &[f64; Self::WIDTH]) -> Self {
                let mut measured = Self::NONE;
                measured.harmonics.copy_from_slice(&numbers[..HARMONICS]);
                let fields = [$(&mut measured.$field),*];
                fields.into_iter().zip(&numbers[HARMONICS..]).for_each(|(field, number)| *field = *number);
                measured
            }

            /// Sets those that follow from sums, as far as they are wanted; without sums, in free motion, to 0.
            pub fn take_sums(&mut self, sums: Option<&MeasuredSums>, wants: Wants) {
                $($(if wants.$group {
                    let value: fn(&MeasuredSums) -> f64 = $value;
                    self.$field = sums.map_or(0.0, value);
                })?)*
            }
        }
    };
}

/// The sums of a run's measured periods, and what turns them into SI units.
#[derive(Clone, Copy, Debug)]
pub struct MeasuredSums {
    pub sums: PeriodSums<f64>,
    /// Measured periods; and their steps, or their length in the unit of time over which an engine integrates.
    pub periods: f64,
    pub span: f64,
    /// The sum of impulses under 1 N over one unit of `span`.
    pub force: f64,
    /// The unit of length, m.
    pub length: f64,
    /// Deflection under a steady force, m/N.
    pub bending: f64,
}

impl MeasuredSums {
    /// N
    fn mean_force(&self) -> f64 {
        self.sums.impulse / self.span / self.force
    }
}

measured! {
    /// Degree.
    phase;
    /// N
    force_max;
    /// N
    force_min;
    /// N
    force_mean = energy, |of| of.mean_force();
    /// m
    indentation_max;
    /// Share of the period.
    contact_time = contact, |of| of.sums.time / of.span;
    /// J per period.
    dissipation = energy, |of| -of.sums.work / of.periods / of.force * of.length;
    /// J
    virial = energy, |of| of.sums.virial / of.span / of.force * of.length;
    /// Per period.
    contacts = contact, |of| of.sums.begun / of.periods;
    /// m
    deflection_amplitude;
    /// Degree.
    deflection_phase;
    /// m
    deflection_mean = energy, |of| of.bending * of.mean_force();
    /// Degree.
    free_phase;
    /// Hz
    frequency_shift;
    /// m
    gap;
}

/// What all of these observables need an engine to sum.
pub fn wants(observables: &[Observable]) -> Wants {
    observables.iter().fold(Wants::FUNDAMENTAL, |all, observable| all.or(observable.entry().wants))
}

impl Measured {
    /// Whether anything was.
    pub fn is_any(&self) -> bool {
        self.numbers().iter().any(|number| !number.is_nan())
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

impl Observable {
    /// Every observable there is.
    pub fn all() -> impl Iterator<Item = Self> {
        ENTRIES.iter().map(|entry| entry.observable)
    }

    fn entry(self) -> &'static Entry {
        &ENTRIES[self as usize]
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

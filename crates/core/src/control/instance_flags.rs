//! What a run holds in memory for each instance, in one byte.

use crate::observe::Status;
use crate::plan::Precision;

/// Status and a few flags of an instance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct InstanceFlags(u8);

/// The facts that the flags encode.
pub(super) struct InstanceFacts {
    pub status: Status,
    /// Whether it needed steps.
    pub stepped: bool,
    /// Whether it has any measurement.
    pub measured: bool,
    pub estimate: f64,
    /// The arithmetic of its last run.
    pub precision: Precision,
}

const STATUS: u8 = 7;
const STEPPED: u8 = 1 << 3;
const MEASURED: u8 = 1 << 4;
const ESTIMATED: u8 = 1 << 5;
const DOUBLE: u8 = 1 << 6;

// All statuses fit.
const _: () = assert!(Status::ALL.len() <= STATUS as usize + 1);

impl InstanceFlags {
    /// Flags of an instance that was not run, in this precision.
    pub(super) fn not_run(precision: Precision) -> Self {
        Self(Status::NotRun as u8 | flag(DOUBLE, precision == Precision::F64))
    }

    /// Flags of a finished instance. Ok becomes accuracy_not_met if the estimate is above the requested accuracy.
    pub(super) fn of(seen: InstanceFacts, accuracy: f64) -> Self {
        let InstanceFacts { status, stepped, measured, estimate, precision } = seen;
        let mark = Self(
            status as u8
                | flag(STEPPED, stepped)
                | flag(MEASURED, measured)
                | flag(ESTIMATED, !estimate.is_nan())
                | flag(DOUBLE, precision == Precision::F64),
        );
        match status {
            Status::Ok if stepped && estimate > accuracy => mark.called(Status::AccuracyNotMet),
            _ => mark,
        }
    }

    /// The same flags with another status.
    pub(super) fn called(self, status: Status) -> Self {
        Self(self.0 & !STATUS | status as u8)
    }

    fn has(self, flag: u8) -> bool {
        self.0 & flag != 0
    }

    /// Status of the instance.
    pub fn status(self) -> Status {
        Status::ALL[usize::from(self.0 & STATUS)]
    }

    /// Whether it needed steps. An instance that feels no sample needs none.
    pub fn stepped(self) -> bool {
        self.has(STEPPED)
    }

    /// Whether it has any measurement.
    pub fn measured(self) -> bool {
        self.has(MEASURED)
    }

    /// Whether its error was estimated.
    pub fn estimated(self) -> bool {
        self.has(ESTIMATED)
    }

    /// The arithmetic of its last run.
    pub fn precision(self) -> Precision {
        if self.has(DOUBLE) { Precision::F64 } else { Precision::F32 }
    }
}

fn flag(flag: u8, holds: bool) -> u8 {
    if holds { flag } else { 0 }
}

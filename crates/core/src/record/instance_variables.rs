//! The variables and flags over all instances: their names, units and sources.

use super::instance_rows::RowView;
use super::warnings::WARNINGS;
use crate::compare::Scales;
use crate::contact::Law;
use crate::observe::{Observable, Status};
use crate::plan::Precision;
use crate::store::{Flags, Variable};

/// Meanings of the codes of the flag `branch`.
pub const BRANCHES: [&str; 3] = ["none", "attractive", "repulsive"];

/// Meanings of the codes of the flag `jump`.
pub const JUMPS: [&str; 2] = ["continuous", "jump"];

/// Branch of a tapping point, by the sign of its mean force: negative is attractive, positive repulsive (Garcia & San Paulo,
/// Phys. Rev. B 60 (1999) 4961). 0 without a steady state or a force.
pub(super) fn branch(status: Status, force: f64) -> u8 {
    match status {
        status if status.is_steady() && force < 0.0 => 1,
        status if status.is_steady() && force > 0.0 => 2,
        _ => 0,
    }
}

/// A variable over all instances.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum InstanceVariable {
    Observable(Observable),
    Tabor,
    /// Scale of dissipation and virial, if one of them is requested.
    DriveWork,
    Estimate,
    Multiplier,
    Periods,
}

impl InstanceVariable {
    /// The variable without data.
    pub fn variable(self) -> Variable {
        let (name, units, long_name) = match self {
            Self::Observable(observable) => {
                return Variable {
                    name: observable.name().into(),
                    units: observable.units().into(),
                    long_name: observable.long_name().into(),
                    harmonics: (observable == Observable::HarmonicAmplitude).then_some(observable.width()),
                    error_scale: observable.scale().words().into(),
                    data: Vec::new(),
                };
            }
            Self::Tabor => ("tabor_parameter", "1", "Tabor's parameter of the contact"),
            Self::DriveWork => (
                "drive_work",
                "J",
                "work of the drive per period, or the loss if larger: the scale of errors of both",
            ),
            Self::Estimate => {
                ("error_estimate", "1", "estimated error of the worst observable, on the scale of accuracy")
            }
            Self::Multiplier => (
                "multiplier",
                "1",
                "modulus of the period map's largest multiplier, below 1 for a stable state",
            ),
            Self::Periods => (
                "periods_stepped",
                "1",
                "drive periods stepped in the last run, those of the search among them",
            ),
        };
        Variable {
            name: name.into(),
            units: units.into(),
            long_name: long_name.into(),
            harmonics: None,
            error_scale: String::new(),
            data: Vec::new(),
        }
    }

    /// Numbers for each instance.
    pub fn width(self) -> usize {
        if let Self::Observable(observable) = self { observable.width() } else { 1 }
    }

    /// Whether it needs more than the plan.
    pub fn is_read(self) -> bool {
        self != Self::Tabor
    }

    /// Its values for a group of instances.
    pub fn of(self, some: &RowView) -> Vec<f64> {
        let work = |n: usize| match some.measured(n) {
            measured if measured.phase.is_nan() => f64::NAN,
            measured => Scales::of(some.plan(), n, &measured).work,
        };
        match self {
            Self::Observable(observable) => some.observed(observable),
            Self::Tabor => some.map(|n| some.tabor(n)),
            Self::DriveWork => some.map(work),
            Self::Estimate => some.estimates(),
            Self::Multiplier => some.multipliers(),
            Self::Periods => some.periods().into_iter().map(f64::from).collect(),
        }
    }
}

/// A flag over all instances.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum InstanceFlag {
    Law,
    Warnings,
    Precision,
    Branch,
    Jump,
}

impl InstanceFlag {
    /// The flags without data.
    pub fn flags(self) -> Flags {
        let words = |all: &[&str]| -> Vec<String> { all.iter().map(|word| (*word).to_owned()).collect() };
        let (name, long_name, meanings) = match self {
            Self::Law => ("contact_law", "contact law used", words(&Law::ALL.map(Law::name))),
            Self::Warnings => (
                "contact_warnings",
                "where the contact law is used outside its assumptions",
                words(&WARNINGS),
            ),
            Self::Precision => (
                "precision",
                "arithmetic of the instance's last run",
                words(&[Precision::F32, Precision::F64].map(Precision::name)),
            ),
            Self::Branch => {
                ("branch", "branch of the periodic state, by the sign of its mean force", words(&BRANCHES))
            }
            Self::Jump => {
                ("jump", "whether the state was reached continuously from the point before", words(&JUMPS))
            }
        };
        Flags {
            name: name.into(),
            long_name: long_name.into(),
            meanings,
            bits: self == Self::Warnings,
            data: Vec::new(),
        }
    }

    /// Whether it needs more than the plan and the flags in memory.
    pub fn is_read(self) -> bool {
        matches!(self, Self::Branch | Self::Jump)
    }

    /// Its values for a group of instances. Warnings come from elsewhere.
    pub fn of(self, some: &RowView) -> Vec<u8> {
        let precision = |n: usize| u8::from(some.precision(n) == Precision::F64);
        match self {
            Self::Law => some.map(|n| some.law(n).code()),
            Self::Warnings => vec![0; some.count()],
            Self::Precision => (0..some.count()).map(precision).collect(),
            Self::Branch => {
                let forces = some.observed(Observable::ForceMean).into_iter().enumerate();
                forces.map(|(n, force)| branch(some.status(n), force)).collect()
            }
            Self::Jump => some.jumps().into_iter().map(u8::from).collect(),
        }
    }
}

//! The numbers of a results file over all instances, one variable at a time.

use super::file_frame::FileFrame;
use super::instance_rows::InstanceRows;
use super::instance_variables::InstanceFlag;
use super::orbit_variables;
use super::warnings::LawWarnings;
use crate::control::SecondOrbits;
use crate::engine::EngineError;
use crate::store::{self, StateSet, Unread};
use std::borrow::Cow;

/// The numbers of a run.
pub struct RecordVariables<'a> {
    frame: &'a FileFrame,
    rows: InstanceRows<'a>,
    warned: &'a LawWarnings,
    others: Option<&'a SecondOrbits>,
}

impl<'a> RecordVariables<'a> {
    pub(super) fn new(
        frame: &'a FileFrame,
        (rows, warned): (InstanceRows<'a>, &'a LawWarnings),
        others: Option<&'a SecondOrbits>,
    ) -> Self {
        Self { frame, rows, warned, others }
    }

    /// The numbers of a run with this frame.
    pub fn of_run(
        frame: &'a FileFrame,
        (run, warned): (&'a crate::control::JournaledRun<'a>, &'a LawWarnings),
        others: Option<&'a SecondOrbits>,
    ) -> Self {
        Self::new(frame, (InstanceRows::Run(run), warned), others)
    }

    fn second(&self) -> orbit_variables::SecondVariables<'_> {
        let others = self.others.map_or(&[][..], |others| &others.orbits);
        orbit_variables::SecondVariables { plan: self.rows.plan(), others }
    }
}

fn unread(error: EngineError) -> Unread {
    Unread(error.to_string())
}

fn none() -> Unread {
    Unread("there is no such variable".into())
}

impl store::VariableSource for RecordVariables<'_> {
    fn count(&self) -> usize {
        self.rows.count()
    }

    fn variable(&self, of: StateSet, number: usize) -> Result<Cow<'_, [f64]>, Unread> {
        if of == StateSet::Second {
            return self.second().variable(number).map(Cow::from).ok_or_else(none);
        }
        let number = *self.frame.variables.get(number).ok_or_else(none)?;
        let all = self.rows.column((number.width(), number.is_read()), &|some| number.of(some));
        all.map(Cow::from).map_err(unread)
    }

    fn status(&self, of: StateSet) -> Result<Cow<'_, [u8]>, Unread> {
        Ok(match of {
            StateSet::First => self.rows.statuses(),
            StateSet::Second => self.second().status(),
        }
        .into())
    }

    fn steps(&self, of: StateSet) -> Result<Cow<'_, [u32]>, Unread> {
        if of == StateSet::Second {
            return Ok(self.second().steps().into());
        }
        self.rows.column((1, true), &|some| some.steps()).map(Cow::from).map_err(unread)
    }

    fn flags(&self, of: StateSet, number: usize) -> Result<Cow<'_, [u8]>, Unread> {
        if of == StateSet::Second {
            return Ok(self.second().branch().into());
        }
        match *self.frame.flags.get(number).ok_or_else(none)? {
            InstanceFlag::Warnings if self.warned.bits.is_empty() => Ok(vec![0; self.count()].into()),
            InstanceFlag::Warnings => Ok(self.warned.bits.as_slice().into()),
            code => {
                self.rows.column((1, code.is_read()), &|some| code.of(some)).map(Cow::from).map_err(unread)
            }
        }
    }
}

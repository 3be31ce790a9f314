//! The numbers of a results file over all instances, one variable after the other.

use super::column::Code;
use super::frame::Frame;
use super::rows::Rows;
use super::search;
use super::warnings::Warned;
use crate::control::Others;
use crate::engine::EngineError;
use crate::store::{self, States, Unread};
use std::borrow::Cow;

/// The numbers of a run.
pub struct Numbers<'a> {
    frame: &'a Frame,
    rows: Rows<'a>,
    warned: &'a Warned,
    others: Option<&'a Others>,
}

impl<'a> Numbers<'a> {
    pub(super) fn new(
        frame: &'a Frame,
        (rows, warned): (Rows<'a>, &'a Warned),
        others: Option<&'a Others>,
    ) -> Self {
        Self { frame, rows, warned, others }
    }

    /// Of a run that has this frame.
    pub fn of_run(
        frame: &'a Frame,
        (run, warned): (&'a crate::control::Ran<'a>, &'a Warned),
        others: Option<&'a Others>,
    ) -> Self {
        Self::new(frame, (Rows::Run(run), warned), others)
    }

    fn second(&self) -> search::Second<'_> {
        let others = self.others.map_or(&[][..], |others| &others.states);
        search::Second { plan: self.rows.plan(), others }
    }
}

fn unread(error: EngineError) -> Unread {
    Unread(error.to_string())
}

fn none() -> Unread {
    Unread("there is no such variable".into())
}

impl store::Numbers for Numbers<'_> {
    fn count(&self) -> usize {
        self.rows.count()
    }

    fn variable(&self, of: States, number: usize) -> Result<Cow<'_, [f64]>, Unread> {
        if of == States::Second {
            return self.second().variable(number).map(Cow::from).ok_or_else(none);
        }
        let number = *self.frame.variables.get(number).ok_or_else(none)?;
        let all = self.rows.column((number.width(), number.is_read()), &|some| number.of(some));
        all.map(Cow::from).map_err(unread)
    }

    fn status(&self, of: States) -> Result<Cow<'_, [u8]>, Unread> {
        Ok(match of {
            States::First => self.rows.statuses(),
            States::Second => self.second().status(),
        }
        .into())
    }

    fn steps(&self, of: States) -> Result<Cow<'_, [u32]>, Unread> {
        if of == States::Second {
            return Ok(self.second().steps().into());
        }
        self.rows.column((1, true), &|some| some.steps()).map(Cow::from).map_err(unread)
    }

    fn flags(&self, of: States, number: usize) -> Result<Cow<'_, [u8]>, Unread> {
        if of == States::Second {
            return Ok(self.second().branch().into());
        }
        match *self.frame.flags.get(number).ok_or_else(none)? {
            Code::Warnings if self.warned.bits.is_empty() => Ok(vec![0; self.count()].into()),
            Code::Warnings => Ok(self.warned.bits.as_slice().into()),
            code => {
                self.rows.column((1, code.is_read()), &|some| code.of(some)).map(Cow::from).map_err(unread)
            }
        }
    }
}

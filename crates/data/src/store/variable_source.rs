//! Numbers over all instances, which need not all lie in memory.

use super::{BranchTable, Results, Variable};
use std::borrow::Cow;

/// Whose numbers are meant: those of the instances' states, or of second states beside them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StateSet {
    First,
    Second,
}

/// Why numbers cannot be had, in words.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct Unread(pub String);

/// The numbers of [`Results`] that are as many as the instances. What a file is written from asks for one variable after the
/// other, so that a single one lies in memory.
pub trait VariableSource {
    /// How many instances there are.
    fn count(&self) -> usize;

    /// The numbers of a variable, by its place among the variables.
    ///
    /// # Errors
    /// They cannot be had; likewise below.
    fn variable(&self, of: StateSet, number: usize) -> Result<Cow<'_, [f64]>, Unread>;

    /// One code per instance.
    fn status(&self, of: StateSet) -> Result<Cow<'_, [u8]>, Unread>;

    /// Steps per period.
    fn steps(&self, of: StateSet) -> Result<Cow<'_, [u32]>, Unread>;

    /// The codes of flags, by their place among the flags.
    fn flags(&self, of: StateSet, number: usize) -> Result<Cow<'_, [u8]>, Unread>;
}

/// Those that lie in memory.
impl VariableSource for Results {
    fn count(&self) -> usize {
        self.status.len()
    }

    fn variable(&self, of: StateSet, number: usize) -> Result<Cow<'_, [f64]>, Unread> {
        let all: &[Variable] = match of {
            StateSet::First => &self.variables,
            StateSet::Second => &second(self)?.variables,
        };
        all.get(number).map(|one| one.data.as_slice().into()).ok_or_else(none)
    }

    fn status(&self, of: StateSet) -> Result<Cow<'_, [u8]>, Unread> {
        Ok(match of {
            StateSet::First => self.status.as_slice().into(),
            StateSet::Second => second(self)?.status.as_slice().into(),
        })
    }

    fn steps(&self, of: StateSet) -> Result<Cow<'_, [u32]>, Unread> {
        Ok(match of {
            StateSet::First => self.steps_per_period.as_slice().into(),
            StateSet::Second => second(self)?.steps_per_period.as_slice().into(),
        })
    }

    fn flags(&self, of: StateSet, number: usize) -> Result<Cow<'_, [u8]>, Unread> {
        let all = match of {
            StateSet::First => &self.flags,
            StateSet::Second => &second(self)?.flags,
        };
        all.get(number).map(|one| one.data.as_slice().into()).ok_or_else(none)
    }
}

fn none() -> Unread {
    Unread("there is no such variable".into())
}

fn second(results: &Results) -> Result<&BranchTable, Unread> {
    results.other_branch.as_ref().ok_or_else(none)
}

impl Results {
    /// With the numbers that it leaves empty, all of them in memory.
    ///
    /// # Errors
    /// They cannot be had.
    pub fn with_numbers(mut self, numbers: &dyn VariableSource) -> Result<Self, Unread> {
        for (n, one) in self.variables.iter_mut().enumerate() {
            one.data = numbers.variable(StateSet::First, n)?.into_owned();
        }
        for (n, one) in self.flags.iter_mut().enumerate() {
            one.data = numbers.flags(StateSet::First, n)?.into_owned();
        }
        self.status = numbers.status(StateSet::First)?.into_owned();
        self.steps_per_period = numbers.steps(StateSet::First)?.into_owned();
        if let Some(branch) = &mut self.other_branch {
            for (n, one) in branch.variables.iter_mut().enumerate() {
                one.data = numbers.variable(StateSet::Second, n)?.into_owned();
            }
            for (n, one) in branch.flags.iter_mut().enumerate() {
                one.data = numbers.flags(StateSet::Second, n)?.into_owned();
            }
            branch.status = numbers.status(StateSet::Second)?.into_owned();
            branch.steps_per_period = numbers.steps(StateSet::Second)?.into_owned();
        }
        Ok(self)
    }
}

//! Numbers over all instances, which need not all lie in memory.

use super::{Branch, Results, Variable};
use std::borrow::Cow;

/// Whose numbers are meant: those of the instances' states, or of second states beside them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum States {
    First,
    Second,
}

/// Why numbers cannot be had, in words.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct Unread(pub String);

/// The numbers of [`Results`] that are as many as the instances. What a file is written from asks for one variable after the
/// other, so that a single one lies in memory.
pub trait Numbers {
    /// How many instances there are.
    fn count(&self) -> usize;

    /// The numbers of a variable, by its place among the variables.
    ///
    /// # Errors
    /// They cannot be had; likewise below.
    fn variable(&self, of: States, number: usize) -> Result<Cow<'_, [f64]>, Unread>;

    /// One code per instance.
    fn status(&self, of: States) -> Result<Cow<'_, [u8]>, Unread>;

    /// Steps per period.
    fn steps(&self, of: States) -> Result<Cow<'_, [u32]>, Unread>;

    /// The codes of flags, by their place among the flags.
    fn flags(&self, of: States, number: usize) -> Result<Cow<'_, [u8]>, Unread>;
}

/// Those that lie in memory.
impl Numbers for Results {
    fn count(&self) -> usize {
        self.status.len()
    }

    fn variable(&self, of: States, number: usize) -> Result<Cow<'_, [f64]>, Unread> {
        let all: &[Variable] = match of {
            States::First => &self.variables,
            States::Second => &second(self)?.variables,
        };
        all.get(number).map(|one| one.data.as_slice().into()).ok_or_else(none)
    }

    fn status(&self, of: States) -> Result<Cow<'_, [u8]>, Unread> {
        Ok(match of {
            States::First => self.status.as_slice().into(),
            States::Second => second(self)?.status.as_slice().into(),
        })
    }

    fn steps(&self, of: States) -> Result<Cow<'_, [u32]>, Unread> {
        Ok(match of {
            States::First => self.steps_per_period.as_slice().into(),
            States::Second => second(self)?.steps_per_period.as_slice().into(),
        })
    }

    fn flags(&self, of: States, number: usize) -> Result<Cow<'_, [u8]>, Unread> {
        let all = match of {
            States::First => &self.flags,
            States::Second => &second(self)?.flags,
        };
        all.get(number).map(|one| one.data.as_slice().into()).ok_or_else(none)
    }
}

fn none() -> Unread {
    Unread("there is no such variable".into())
}

fn second(results: &Results) -> Result<&Branch, Unread> {
    results.other_branch.as_ref().ok_or_else(none)
}

impl Results {
    /// With the numbers that it leaves empty, all of them in memory.
    ///
    /// # Errors
    /// They cannot be had.
    pub fn with_numbers(mut self, numbers: &dyn Numbers) -> Result<Self, Unread> {
        for (n, one) in self.variables.iter_mut().enumerate() {
            one.data = numbers.variable(States::First, n)?.into_owned();
        }
        for (n, one) in self.flags.iter_mut().enumerate() {
            one.data = numbers.flags(States::First, n)?.into_owned();
        }
        self.status = numbers.status(States::First)?.into_owned();
        self.steps_per_period = numbers.steps(States::First)?.into_owned();
        if let Some(branch) = &mut self.other_branch {
            for (n, one) in branch.variables.iter_mut().enumerate() {
                one.data = numbers.variable(States::Second, n)?.into_owned();
            }
            for (n, one) in branch.flags.iter_mut().enumerate() {
                one.data = numbers.flags(States::Second, n)?.into_owned();
            }
            branch.status = numbers.status(States::Second)?.into_owned();
            branch.steps_per_period = numbers.steps(States::Second)?.into_owned();
        }
        Ok(self)
    }
}

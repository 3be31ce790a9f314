//! Numbers over all instances, which need not all lie in memory.

use super::{BranchTable, Flags, Results, Variable};
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
        let (variables, ..) = self.states(of).ok_or_else(none)?;
        variables.get(number).map(|one| one.data.as_slice().into()).ok_or_else(none)
    }

    fn status(&self, of: StateSet) -> Result<Cow<'_, [u8]>, Unread> {
        self.states(of).map(|(_, status, ..)| status.into()).ok_or_else(none)
    }

    fn steps(&self, of: StateSet) -> Result<Cow<'_, [u32]>, Unread> {
        self.states(of).map(|(_, _, steps, _)| steps.into()).ok_or_else(none)
    }

    fn flags(&self, of: StateSet, number: usize) -> Result<Cow<'_, [u8]>, Unread> {
        let (.., flags) = self.states(of).ok_or_else(none)?;
        flags.get(number).map(|one| one.data.as_slice().into()).ok_or_else(none)
    }
}

fn none() -> Unread {
    Unread("there is no such variable".into())
}

/// Variables, status codes, steps and flags of such states.
pub(super) type States<'a> = (&'a [Variable], &'a [u8], &'a [u32], &'a [Flags]);

impl Results {
    /// Those of such states, if there are any.
    pub(super) fn states(&self, of: StateSet) -> Option<States<'_>> {
        match of {
            StateSet::First => Some((&self.variables, &self.status, &self.steps_per_period, &self.flags)),
            StateSet::Second => {
                let BranchTable { variables, status, steps_per_period, flags } =
                    self.other_branch.as_ref()?;
                Some((variables, status, steps_per_period, flags))
            }
        }
    }

    /// With the numbers that it leaves empty, all of them in memory.
    ///
    /// # Errors
    /// They cannot be had.
    pub fn with_numbers(mut self, numbers: &dyn VariableSource) -> Result<Self, Unread> {
        let fill = |of, variables: &mut [Variable], flags: &mut [Flags]| -> Result<_, Unread> {
            for (n, one) in variables.iter_mut().enumerate() {
                one.data = numbers.variable(of, n)?.into_owned();
            }
            for (n, one) in flags.iter_mut().enumerate() {
                one.data = numbers.flags(of, n)?.into_owned();
            }
            Ok((numbers.status(of)?.into_owned(), numbers.steps(of)?.into_owned()))
        };
        (self.status, self.steps_per_period) = fill(StateSet::First, &mut self.variables, &mut self.flags)?;
        if let Some(branch) = &mut self.other_branch {
            (branch.status, branch.steps_per_period) =
                fill(StateSet::Second, &mut branch.variables, &mut branch.flags)?;
        }
        Ok(self)
    }
}

//! What a file is made of: results, and where the numbers over all instances are, of which one variable at a time is asked for.

use super::super::checksums;
use super::super::consistency::check_numbers;
use super::super::{BranchTable, Results, StateSet, States, Unread, VariableSource};
use std::borrow::Cow;
use std::cell::RefCell;
use std::collections::HashMap;

/// Results with their numbers.
pub(super) struct FileContents<'a> {
    pub frame: &'a Results,
    numbers: &'a dyn VariableSource,
    /// Sums of what was asked for, by name.
    sums: RefCell<HashMap<String, u64>>,
}

fn missing() -> Unread {
    Unread("there is no such variable".into())
}

/// The name of a variable beside others.
fn name(of: StateSet, name: &str) -> String {
    match of {
        StateSet::First => name.to_owned(),
        StateSet::Second => format!("other_branch/{name}"),
    }
}

impl<'a> FileContents<'a> {
    pub fn new(frame: &'a Results, numbers: &'a dyn VariableSource) -> Self {
        Self { frame, numbers, sums: RefCell::default() }
    }

    /// How many instances there are.
    pub fn count(&self) -> usize {
        self.numbers.count()
    }

    /// Numbers whose sum is noted, if they are as many as there should be: `width` of each instance.
    fn noted<T: Clone>(
        &self,
        (of, one): (StateSet, &str),
        width: usize,
        numbers: Result<Cow<'a, [T]>, Unread>,
        sum: impl Fn(&[T]) -> u64,
    ) -> Result<Cow<'a, [T]>, Unread> {
        let (numbers, name) = (numbers?, name(of, one));
        let checked = check_numbers(&name, numbers.len(), (self.count(), width));
        checked.map_err(|error| Unread(error.to_string()))?;
        self.sums.borrow_mut().insert(name, sum(&numbers));
        Ok(numbers)
    }

    pub fn variable(&self, of: StateSet, number: usize) -> Result<Cow<'a, [f64]>, Unread> {
        let one = self.states(of)?.0.get(number).ok_or_else(missing)?;
        let sum = |data: &[f64]| checksums::of_variable(one, data);
        self.noted((of, &one.name), one.harmonics.unwrap_or(1), self.numbers.variable(of, number), sum)
    }

    pub fn flags(&self, of: StateSet, number: usize) -> Result<Cow<'a, [u8]>, Unread> {
        let one = self.states(of)?.3.get(number).ok_or_else(missing)?;
        self.noted((of, &one.name), 1, self.numbers.flags(of, number), |data| checksums::of_flags(one, data))
    }

    fn states(&self, of: StateSet) -> Result<States<'a>, Unread> {
        self.frame.states(of).ok_or_else(missing)
    }

    pub fn status(&self, of: StateSet) -> Result<Cow<'a, [u8]>, Unread> {
        self.noted((of, "status"), 1, self.numbers.status(of), checksums::of_codes)
    }

    pub fn steps(&self, of: StateSet) -> Result<Cow<'a, [u32]>, Unread> {
        self.noted((of, "steps_per_period"), 1, self.numbers.steps(of), checksums::of_steps)
    }

    /// The second states' variables and flags.
    pub fn second(&self) -> Option<&'a BranchTable> {
        self.frame.other_branch.as_ref()
    }

    /// The sums of all that the file holds, once it was asked for.
    pub fn sums(&self) -> String {
        checksums::text(self.frame, &self.sums.borrow())
    }
}

//! What a file is made of: results, and where the numbers over all instances are, of which one variable at a time is asked for.

use super::super::checksums;
use super::super::consistency::check_numbers;
use super::super::{BranchTable, Flags, Results, StateSet, Variable, VariableSource};
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

fn unread(error: impl std::fmt::Display) -> hdf5::Error {
    hdf5::Error::from(error.to_string())
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

    /// Notes the sum of so many numbers, if they are as many as there should be.
    fn noted(&self, name: String, (found, width): (usize, usize), sum: u64) -> hdf5::Result<()> {
        check_numbers(&name, found, (self.count(), width)).map_err(unread)?;
        self.sums.borrow_mut().insert(name, sum);
        Ok(())
    }

    pub fn variable(&self, of: StateSet, number: usize, one: &Variable) -> hdf5::Result<Cow<'a, [f64]>> {
        let data = self.numbers.variable(of, number).map_err(unread)?;
        let width = one.harmonics.unwrap_or(1);
        self.noted(name(of, &one.name), (data.len(), width), checksums::of_variable(one, &data))?;
        Ok(data)
    }

    pub fn flags(&self, of: StateSet, number: usize, one: &Flags) -> hdf5::Result<Cow<'a, [u8]>> {
        let data = self.numbers.flags(of, number).map_err(unread)?;
        self.noted(name(of, &one.name), (data.len(), 1), checksums::of_flags(one, &data))?;
        Ok(data)
    }

    pub fn status(&self, of: StateSet) -> hdf5::Result<Cow<'a, [u8]>> {
        let data = self.numbers.status(of).map_err(unread)?;
        self.noted(name(of, "status"), (data.len(), 1), checksums::of_codes(&data))?;
        Ok(data)
    }

    pub fn steps(&self, of: StateSet) -> hdf5::Result<Cow<'a, [u32]>> {
        let data = self.numbers.steps(of).map_err(unread)?;
        self.noted(name(of, "steps_per_period"), (data.len(), 1), checksums::of_steps(&data))?;
        Ok(data)
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

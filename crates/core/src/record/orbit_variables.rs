//! Variables of second periodic states.

use super::instance_variables::{InstanceFlag, InstanceVariable, branch};
use crate::control::SecondOrbit;
use crate::plan::Plan;
use crate::store::{BranchTable, NO_STATE};

/// The variables of second states.
fn numbers(plan: &Plan) -> impl Iterator<Item = InstanceVariable> {
    let observables = plan.observables.iter().map(|one| InstanceVariable::Observable(*one));
    observables.chain([InstanceVariable::Estimate, InstanceVariable::Multiplier])
}

/// Second states over all instances, without data.
pub(super) fn second_states(plan: &Plan) -> BranchTable {
    BranchTable {
        variables: numbers(plan).map(InstanceVariable::variable).collect(),
        flags: vec![InstanceFlag::Branch.flags()],
        ..BranchTable::default()
    }
}

/// Second states of some instances of a plan, spread over all instances.
pub(super) struct SecondVariables<'a> {
    pub plan: &'a Plan,
    pub others: &'a [SecondOrbit],
}

impl SecondVariables<'_> {
    fn all<T: Copy>(&self, none: T, of: impl Fn(&SecondOrbit) -> T) -> Vec<T> {
        let mut all = vec![none; self.plan.len()];
        self.others.iter().for_each(|other| all[other.instance as usize] = of(other));
        all
    }

    /// Values of the variable of this number.
    pub fn variable(&self, number: usize) -> Option<Vec<f64>> {
        let number = numbers(self.plan).nth(number)?;
        Some(match number {
            InstanceVariable::Observable(observable) => {
                let width = number.width();
                let mut all = vec![f64::NAN; self.plan.len() * width];
                for other in self.others {
                    let row = &mut all[other.instance as usize * width..][..width];
                    observable.write(&other.finished.measured, row);
                }
                all
            }
            InstanceVariable::Multiplier => self.all(f64::NAN, |other| other.multiplier),
            _ => self.all(f64::NAN, |other| other.estimate),
        })
    }

    pub fn status(&self) -> Vec<u8> {
        self.all(NO_STATE, |other| other.finished.status as u8)
    }

    pub fn steps(&self) -> Vec<u32> {
        self.all(0, |other| other.steps)
    }

    pub fn branch(&self) -> Vec<u8> {
        self.all(0, |other| branch(other.finished.status, other.finished.measured.force_mean))
    }
}

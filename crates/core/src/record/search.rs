//! What a search for periodic states adds to the file.

use super::audit::estimate_of;
use super::observables;
use crate::control::{Other, Others};
use crate::engine::{Columns, Finished};
use crate::plan::Plan;
use crate::steady::States;
use crate::store::{Branch, Flags, NO_STATE, Results, Variable};

/// What the codes of the flag `branch` mean.
pub const BRANCHES: [&str; 3] = ["none", "attractive", "repulsive"];

/// What the codes of the flag `jump` mean.
pub const JUMPS: [&str; 2] = ["continuous", "jump"];

/// The branch of a tapping point, by its mean force: attractive below zero, repulsive above (Garcia & San Paulo,
/// Phys. Rev. B 60 (1999) 4961); none without a steady state or a force.
fn branch(one: &Finished) -> u8 {
    let force = one.measured.force_mean;
    match one.status {
        status if status.is_steady() && force < 0.0 => 1,
        status if status.is_steady() && force > 0.0 => 2,
        _ => 0,
    }
}

/// Adds `branch`, `multiplier` and `periods_stepped` to the results of a searched run, and the group `other_branch`
/// if second states were looked for.
pub fn search(
    results: &mut Results,
    plan: &Plan,
    finished: &Columns,
    (found, periods): (&States, &[u32]),
    others: Option<&Others>,
) {
    // Nothing is found where nothing was searched for, or nothing yet.
    results.variables.push(multipliers((0..finished.len()).map(|i| found.multiplier(i)).collect()));
    results.variables.push(Variable {
        name: "periods_stepped".into(),
        units: "1".into(),
        long_name: "drive periods stepped in the last run, those of the search among them".into(),
        harmonics: None,
        error_scale: String::new(),
        data: periods.iter().map(|count| f64::from(*count)).collect(),
    });
    results.flags.push(branch_flags(finished.iter().map(|one| branch(&one)).collect()));
    results.other_branch = others.map(|others| branches(plan, &others.states));
}

/// Adds the flag `jump` to the results of curves.
pub fn jumps(results: &mut Results, jumps: &[bool]) {
    if !jumps.is_empty() {
        results.flags.push(Flags {
            name: "jump".into(),
            long_name: "whether the state was reached continuously from the point before".into(),
            meanings: JUMPS.iter().map(|word| (*word).to_owned()).collect(),
            bits: false,
            data: jumps.iter().map(|jump| u8::from(*jump)).collect(),
        });
    }
}

/// Second states over all instances.
fn branches(plan: &Plan, others: &[Other]) -> Branch {
    let count = plan.len();
    let mut variables = observables(plan, others.iter().map(|other| other.finished));
    variables.push(estimate_of(others.iter().map(|other| other.estimate).collect()));
    variables.push(multipliers(others.iter().map(|other| other.multiplier).collect()));
    for variable in &mut variables {
        let width = variable.harmonics.unwrap_or(1);
        let mut all = vec![f64::NAN; count * width];
        for (row, other) in variable.data.chunks_exact(width).zip(others) {
            all[other.instance as usize * width..][..width].copy_from_slice(row);
        }
        variable.data = all;
    }
    let (mut status, mut steps) = (vec![NO_STATE; count], vec![0; count]);
    let mut codes = vec![0; count];
    for other in others {
        let i = other.instance as usize;
        status[i] = other.finished.status as u8;
        steps[i] = other.steps;
        codes[i] = branch(&other.finished);
    }
    Branch { variables, status, steps_per_period: steps, flags: vec![branch_flags(codes)] }
}

fn branch_flags(data: Vec<u8>) -> Flags {
    Flags {
        name: "branch".into(),
        long_name: "branch of the periodic state, by the sign of its mean force".into(),
        meanings: BRANCHES.iter().map(|word| (*word).to_owned()).collect(),
        bits: false,
        data,
    }
}

fn multipliers(data: Vec<f64>) -> Variable {
    Variable {
        name: "multiplier".into(),
        units: "1".into(),
        long_name: "modulus of the period map's largest multiplier, below 1 for a stable state".into(),
        harmonics: None,
        error_scale: String::new(),
        data,
    }
}

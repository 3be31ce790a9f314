//! What a search for periodic states adds to the file.

use super::observables;
use crate::control::Other;
use crate::engine::Finished;
use crate::observe::Status;
use crate::plan::Plan;
use crate::steady::PeriodicState;
use crate::store::{Flags, Listed, Results, Variable};

/// What the codes of the flag `branch` mean.
pub const BRANCHES: [&str; 3] = ["none", "attractive", "repulsive"];

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
    finished: &[Finished],
    (found, periods): (&[Option<Box<PeriodicState>>], &[u32]),
    others: &[Other],
) {
    let multiplier =
        |place: &Option<Box<PeriodicState>>| place.as_ref().map_or(f64::NAN, |one| one.spectrum.multiplier);
    results.variables.push(multipliers(found.iter().map(multiplier).collect()));
    results.variables.push(Variable {
        name: "periods_stepped".into(),
        units: "1".into(),
        long_name: "drive periods stepped in the last run, those of the search among them".into(),
        harmonics: None,
        data: periods.iter().map(|count| f64::from(*count)).collect(),
    });
    results.flags.push(Flags {
        name: "branch".into(),
        long_name: "branch of the periodic state, by the sign of its mean force".into(),
        meanings: BRANCHES.iter().map(|word| (*word).to_owned()).collect(),
        bits: false,
        data: finished.iter().map(branch).collect(),
    });
    if !others.is_empty() {
        let finished: Vec<Finished> = others.iter().map(|other| other.finished).collect();
        let mut variables = observables(plan, &finished);
        variables.push(multipliers(others.iter().map(|other| other.multiplier).collect()));
        variables.push(Variable {
            name: "branch".into(),
            units: "1".into(),
            long_name: "branch of this state, by the codes of branch".into(),
            harmonics: None,
            data: finished.iter().map(|one| f64::from(branch(one))).collect(),
        });
        let instances = others.iter().map(|other| u64::from(other.instance)).collect();
        results.other_branch = Some(Listed { instances, variables });
    }
}

fn multipliers(data: Vec<f64>) -> Variable {
    Variable {
        name: "multiplier".into(),
        units: "1".into(),
        long_name: "modulus of the period map's largest multiplier, below 1 for a stable state".into(),
        harmonics: None,
        data,
    }
}

//! What searches from the lever at rest have found in a whole run.

use super::second_orbit::SecondState;
use crate::engine::{Finished, ResultColumns};
use crate::orbit::{OrbitTable, PeriodicState};
use crate::plan::Plan;

/// States beside the first ones, by instance.
#[derive(Clone, Debug, Default)]
pub(super) struct SecondOrbitTable {
    results: Option<ResultColumns>,
    states: OrbitTable,
}

impl SecondOrbitTable {
    /// Of the plan's instances, of which nothing was found yet.
    pub fn none_of(plan: &Plan) -> Self {
        let results = Some(ResultColumns::of_observables(plan.len(), &plan.observables));
        Self { results, states: OrbitTable::none_of(plan.len()) }
    }

    /// Takes in what was found of an instance.
    pub fn put(&mut self, instance: usize, finished: &Finished, state: &PeriodicState) {
        if let Some(results) = &mut self.results {
            results.set(instance, finished);
            self.states.put(instance, Some(state));
        }
    }

    /// Whether there are any to be asked for.
    pub fn is_empty(&self) -> bool {
        self.states.is_empty()
    }

    /// That of an instance.
    pub fn get(&self, instance: u32) -> Option<SecondState> {
        let place = Box::new(self.states.get(instance as usize)?);
        Some(SecondState { finished: self.results.as_ref()?.get(instance as usize), orbit: place })
    }
}

//! Results of the searches from the lever at rest in a whole run.

use super::second_orbit::SecondState;
use crate::engine::{Finished, ResultColumns};
use crate::orbit::{OrbitTable, PeriodicState};
use crate::plan::Plan;

/// Second states by instance.
#[derive(Clone, Debug, Default)]
pub(super) struct SecondOrbitTable {
    results: Option<ResultColumns>,
    states: OrbitTable,
}

impl SecondOrbitTable {
    /// A table for the plan's instances, without any state yet.
    pub fn none_of(plan: &Plan) -> Self {
        let results = Some(ResultColumns::of_observables(plan.len(), &plan.observables));
        Self { results, states: OrbitTable::none_of(plan.len()) }
    }

    /// Stores the state of an instance.
    pub fn put(&mut self, instance: usize, finished: &Finished, state: &PeriodicState) {
        if let Some(results) = &mut self.results {
            results.set(instance, finished);
            self.states.put(instance, Some(state));
        }
    }

    /// Whether there is no table.
    pub fn is_empty(&self) -> bool {
        self.states.is_empty()
    }

    /// The state of an instance.
    pub fn get(&self, instance: u32) -> Option<SecondState> {
        let place = Box::new(self.states.get(instance as usize)?);
        Some(SecondState { finished: self.results.as_ref()?.get(instance as usize), orbit: place })
    }
}

//! What searches from the lever at rest have found in a whole run.

use super::other::Second;
use crate::engine::Columns;
use crate::plan::Plan;
use crate::steady::States;

/// States beside the first ones, by instance.
#[derive(Clone, Debug, Default)]
pub(super) struct Seconds {
    results: Option<Columns>,
    states: States,
}

impl Seconds {
    /// Takes in what was found of a portion of the plan.
    pub fn take(&mut self, plan: &Plan, portion: &[u32], all: &[Option<Second>]) {
        let count = plan.len();
        if self.states.is_empty() {
            self.states = States::none_of(count);
        }
        let results = self.results.get_or_insert_with(|| Columns::of_observables(count, &plan.observables));
        for (place, second) in portion.iter().zip(all) {
            let Some(Second { finished, place: state }) = second else { continue };
            results.set(*place as usize, finished);
            self.states.put(*place as usize, Some(state));
        }
    }

    /// Whether there are any to be asked for.
    pub fn is_empty(&self) -> bool {
        self.states.is_empty()
    }

    /// That of an instance.
    pub fn get(&self, instance: u32) -> Option<Second> {
        let place = Box::new(self.states.get(instance as usize)?);
        Some(Second { finished: self.results.as_ref()?.get(instance as usize), place })
    }
}

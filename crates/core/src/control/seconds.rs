//! What searches from the lever at rest have found in a whole run.

use super::other::Second;
use crate::engine::Columns;
use crate::steady::States;

/// States beside the first ones, by instance.
#[derive(Clone, Debug, Default)]
pub(super) struct Seconds {
    results: Option<Columns>,
    states: States,
}

impl Seconds {
    /// Takes in what was found of a portion of so many instances.
    pub fn take(&mut self, count: usize, portion: &[u32], all: &[Option<Second>]) {
        if self.states.is_empty() {
            self.states = States::none_of(count);
        }
        let results = self.results.get_or_insert_with(|| Columns::not_run(count));
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

//! Basis rules of very many instances, few of which differ.

use crate::plan::BasisRule;
use std::collections::HashMap;

/// A rule for each instance. Equal rules are stored once, and each instance stores a number.
pub(super) struct BasisRuleTable {
    known: Vec<BasisRule>,
    numbers: HashMap<[u64; 2], u32>,
    of: Vec<u32>,
}

impl BasisRuleTable {
    /// The same rule for `count` instances.
    pub fn of(count: usize, rule: BasisRule) -> Self {
        Self { known: vec![rule], numbers: HashMap::from([(rule.key(), 0)]), of: vec![0; count] }
    }

    /// Sets the rule of an instance.
    pub fn put(&mut self, instance: u32, rule: BasisRule) {
        let Self { known, numbers, of } = self;
        of[instance as usize] = *numbers.entry(rule.key()).or_insert_with(|| {
            known.push(rule);
            known.len() as u32 - 1
        });
    }

    /// The rule of an instance.
    pub fn get(&self, instance: u32) -> BasisRule {
        self.known[self.of[instance as usize] as usize]
    }
}

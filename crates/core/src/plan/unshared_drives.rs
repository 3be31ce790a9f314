//! A plan that shares no drives with others.

use super::Plan;
use std::collections::HashMap;
use std::sync::Arc;

impl Plan {
    /// With drives and bases of its own, to the bit those that it had: what threads share they hinder one another by, each time
    /// that one of them notes or forgets that it holds it.
    #[must_use]
    pub fn with_own_drives(mut self) -> Self {
        let (mut drives, mut bases) = (HashMap::new(), HashMap::new());
        for driven in &mut self.drives {
            driven.drive = Arc::clone(
                drives.entry(Arc::as_ptr(&driven.drive)).or_insert_with(|| Arc::new((*driven.drive).clone())),
            );
            driven.kept = Arc::clone(
                bases.entry(Arc::as_ptr(&driven.kept)).or_insert_with(|| Arc::new((*driven.kept).clone())),
            );
        }
        self
    }
}

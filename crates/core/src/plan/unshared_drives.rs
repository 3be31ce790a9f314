//! A plan that shares no drives with others.

use super::Plan;
use std::collections::HashMap;
use std::sync::Arc;

impl Plan {
    /// Copies its drives and bases, bit by bit. Threads that clone one `Arc` contend for its counter, so each chunk has its
    /// own.
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

//! Portions that are kept in memory.

use super::bytes::portion_to_bytes;
use super::portion::{Keep, Portion};
use std::collections::HashMap;
use std::ops::ControlFlow;
use std::sync::{Arc, Mutex, PoisonError};

/// Nothing is known before, and portions that end are kept in memory.
#[derive(Debug, Default)]
pub struct InMemory {
    portions: Mutex<HashMap<usize, Arc<Vec<u8>>>>,
}

impl Keep for InMemory {
    fn ended(&self, number: usize, portion: &Portion) -> ControlFlow<()> {
        let bytes = Arc::new(portion_to_bytes(number, portion));
        self.portions.lock().unwrap_or_else(PoisonError::into_inner).insert(number, bytes);
        ControlFlow::Continue(())
    }

    fn bytes(&self, number: usize) -> Result<Arc<Vec<u8>>, String> {
        let portions = self.portions.lock().unwrap_or_else(PoisonError::into_inner);
        portions.get(&number).cloned().ok_or_else(|| format!("portion {number} was not kept"))
    }
}

//! Chunks kept in memory.

use super::chunk::ChunkJournal;
use std::collections::HashMap;
use std::ops::{ControlFlow, Range};
use std::sync::{Mutex, PoisonError};

/// A journal in memory. It starts empty and keeps the chunks of this run.
#[derive(Debug, Default)]
pub struct MemoryJournal {
    portions: Mutex<HashMap<usize, Vec<u8>>>,
}

impl ChunkJournal for MemoryJournal {
    fn ended(&self, number: usize, _whole: bool, bytes: Vec<u8>) -> ControlFlow<()> {
        self.portions.lock().unwrap_or_else(PoisonError::into_inner).insert(number, bytes);
        ControlFlow::Continue(())
    }

    fn bytes(&self, number: usize, range: Range<usize>) -> Result<Vec<u8>, String> {
        let portions = self.portions.lock().unwrap_or_else(PoisonError::into_inner);
        let some = portions.get(&number).and_then(|bytes| bytes.get(range));
        some.map(<[u8]>::to_vec).ok_or_else(|| format!("portion {number} was not kept"))
    }
}

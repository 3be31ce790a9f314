//! Whether another program is at a file.

use std::fs::{File, TryLockError};

/// Whether another program holds the file for itself, as HDF5 does to write. Where nobody locks, nobody does.
pub(super) fn is_locked(file: &File) -> bool {
    let ignored =
        std::env::var_os("HDF5_USE_FILE_LOCKING").is_some_and(|told| told == "FALSE" || told == "0");
    !ignored && matches!(file.try_lock_shared(), Err(TryLockError::WouldBlock))
}

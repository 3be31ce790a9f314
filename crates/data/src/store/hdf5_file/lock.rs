//! Whether another program is at a file.

use std::fs::{File, TryLockError};
use std::time::Duration;

/// How often and how long to wait for a lock: a program that this one starts has a copy of every lock until it begins.
const TRIES: u32 = 10;
const PAUSE: Duration = Duration::from_millis(10);

/// Whether another program holds the file for itself, as HDF5 does to write. Where nobody locks, nobody does.
pub(super) fn is_locked(file: &File) -> bool {
    let ignored =
        std::env::var_os("HDF5_USE_FILE_LOCKING").is_some_and(|told| told == "FALSE" || told == "0");
    let held = || matches!(file.try_lock_shared(), Err(TryLockError::WouldBlock));
    !ignored
        && (0..TRIES).all(|number| {
            std::thread::sleep(PAUSE * number.min(1));
            held()
        })
}

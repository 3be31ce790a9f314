//! The number of threads of a run, and the thread that watches it.

use super::EngineError;
use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::Duration;

/// Runs `work`, and all that it starts, on this many threads; without a number on the caller's, by default one per core.
///
/// Planning, stepping, audits and recording all use the threads of their caller: only this function sets their number.
///
/// # Errors
/// The system cannot provide the threads.
pub fn on_threads<T: Send>(
    threads: Option<usize>,
    work: impl FnOnce() -> T + Send,
) -> Result<T, EngineError> {
    let Some(threads) = threads else { return Ok(work()) };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    let pool = pool.map_err(|error| EngineError::Threads { threads, why: error.to_string() })?;
    Ok(pool.install(work))
}

/// Runs `work`. Meanwhile another thread calls `watch` after each interval. WebAssembly has no threads: there nothing watches,
/// and a page ends a run by ending its worker.
pub fn while_watched<T>(interval: Duration, mut watch: impl FnMut() + Send, work: impl FnOnce() -> T) -> T {
    if cfg!(target_family = "wasm") {
        return work();
    }
    let (end, ended) = mpsc::channel::<()>();
    std::thread::scope(|scope| {
        scope.spawn(move || {
            while ended.recv_timeout(interval) == Err(RecvTimeoutError::Timeout) {
                watch();
            }
        });
        let done = work();
        drop(end);
        done
    })
}

/// The number of the calling pool's threads, in words.
pub(super) fn described() -> String {
    match rayon::current_num_threads() {
        1 => "1 thread".into(),
        threads => format!("{threads} threads"),
    }
}

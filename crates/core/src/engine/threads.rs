//! How many threads a run has.

use super::EngineError;

/// Does `work`, and all that it starts, on so many threads; without a number on as many as there are cores.
///
/// Planning, stepping, audits and recording all take the threads they are called on: this is the one place that says
/// how many there are.
///
/// # Errors
/// The system has no such threads to give.
pub fn on_threads<T: Send>(
    threads: Option<usize>,
    work: impl FnOnce() -> T + Send,
) -> Result<T, EngineError> {
    let Some(threads) = threads else { return Ok(work()) };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    let pool = pool.map_err(|error| EngineError::Threads { threads, why: error.to_string() })?;
    Ok(pool.install(work))
}

/// The calling thread's share of the machine, in words.
pub(super) fn described() -> String {
    match rayon::current_num_threads() {
        1 => "1 thread".into(),
        threads => format!("{threads} threads"),
    }
}

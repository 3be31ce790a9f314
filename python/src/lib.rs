//! afmsweep for Python: scenes and buffers in, labelled buffers and JSON out. The package's Python files make arrays,
//! data sets and classes of them.

mod exception;
mod key_paths;
mod labelled_arrays;
mod python_observer;
mod run_call;
mod scene_call;
mod study_call;

use pyo3::prelude::*;
use std::ffi::OsString;

/// Does the work on threads that end with it. Threads that stayed behind would be missing in a process that is forked
/// later, and its work would wait for them for ever.
fn on_own_threads<T: Send>(threads: Option<usize>, work: impl FnOnce() -> T + Send) -> PyResult<T> {
    let threads = threads.or_else(|| std::thread::available_parallelism().map(usize::from).ok());
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.unwrap_or(1)).build();
    Ok(pool.map_err(|error| exception::failed(&error.to_string()))?.install(work))
}

/// The program, with its arguments after its name. Gives the exit code.
#[pyfunction]
fn command(py: Python<'_>, arguments: Vec<OsString>) -> u8 {
    let arguments = std::iter::once("afmsweep".into()).chain(arguments);
    py.detach(|| afmsweep::cli::main(arguments))
}

#[pymodule]
mod _afmsweep {
    #[pymodule_export]
    use super::command;
    #[pymodule_export]
    use super::exception::SceneError;
    #[pymodule_export]
    use super::run_call::{opened, run};
    #[pymodule_export]
    use super::scene_call::{force, keys, length, modes, nearest, plan, points, problem, units};
    #[pymodule_export]
    use super::study_call::{infer, report, stats};
}

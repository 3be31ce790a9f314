//! Errors as exceptions of Python, without words of the command line.

use crate::key_paths::keyed;
use afmsweep::Error;
use afmsweep::engine::EngineError;
use afmsweep::scene::SceneError as Refusal;
use afmsweep::stats::StatsError;
use afmsweep::store::StoreError;
use pyo3::create_exception;
use pyo3::exceptions::{PyFileExistsError, PyFileNotFoundError, PyOSError, PyRuntimeError, PyValueError};
use pyo3::prelude::*;

create_exception!(
    afmsweep,
    SceneError,
    PyValueError,
    "What is wrong with a scene: its text marked, what was expected and what to do.\n\n\
     Attributes: line, column (from 1; None where the scene as a whole is at fault), title and help (of the first mistake)."
);

/// A run that failed for another reason than its scene.
pub fn failed(text: &str) -> PyErr {
    PyRuntimeError::new_err(plain(text))
}

/// An argument that cannot be used.
pub fn refused(text: &str) -> PyErr {
    PyValueError::new_err(plain(text))
}

pub fn of_scene(error: &Refusal) -> PyErr {
    let text = keyed(&error.render(false), &error.path().to_string_lossy(), error.source());
    let raised = SceneError::new_err(plain(&text));
    Python::attach(|py| {
        let (line, column) = error.line_column().unzip();
        let value = raised.value(py);
        let told = [("line", line), ("column", column)];
        told.iter().try_for_each(|(name, number)| value.setattr(*name, *number))?;
        value.setattr("title", error.title())?;
        value.setattr("help", error.help().map(plain))
    })
    .map_or_else(|error| error, |()| raised)
}

pub fn of_run(error: &Error) -> PyErr {
    match error {
        Error::Scene(error) => of_scene(error),
        Error::Store(error) => of_store(error),
        Error::Engine(error) => of_engine(error),
        Error::NoGpuEngine => refused(&error.to_string()),
        other => failed(&other.to_string()),
    }
}

pub fn of_engine(error: &EngineError) -> PyErr {
    failed(&error.to_string())
}

pub fn of_store(error: &StoreError) -> PyErr {
    let text = plain(&error.to_string());
    match error {
        StoreError::Unresumed { partial, kept } => PyFileExistsError::new_err(format!(
            "{} holds {kept} portions of a run of this scene: resume=True goes on with them; or remove it",
            partial.display()
        )),
        StoreError::Missing { .. } | StoreError::Unfinished { .. } => PyFileNotFoundError::new_err(text),
        StoreError::OtherScene { .. } | StoreError::Occupied { .. } | StoreError::PartialTaken { .. } => {
            PyFileExistsError::new_err(text)
        }
        StoreError::Foreign { .. }
        | StoreError::Damaged { .. }
        | StoreError::Changed { .. }
        | StoreError::Inconsistent { .. } => PyValueError::new_err(text),
        _ => PyOSError::new_err(text),
    }
}

/// Whatever stopped a command.
pub fn of_command(error: &anyhow::Error) -> PyErr {
    if let Some(error) = error.downcast_ref::<Refusal>() {
        return of_scene(error);
    }
    if let Some(error) = error.downcast_ref::<Error>() {
        return of_run(error);
    }
    if let Some(error) = error.downcast_ref::<StoreError>() {
        return of_store(error);
    }
    match error.downcast_ref::<StatsError>() {
        Some(error) => refused(&error.to_string()),
        None => refused(&format!("{error:#}")),
    }
}

/// A message whose advice is of the command line, without that: clauses that name a command go, options become arguments.
pub fn plain(text: &str) -> String {
    text.lines().map(line).collect::<Vec<_>>().join("\n")
}

fn line(text: &str) -> String {
    // What is wrong comes first, what to do after it.
    let is_of_shell =
        |clause: &str| ["`afmsweep ", "--overwrite", "-o "].iter().any(|word| clause.contains(word));
    let clauses = text.split("; ").enumerate().filter(|(n, clause)| *n == 0 || !is_of_shell(clause));
    let clauses: Vec<&str> = clauses.map(|(_, clause)| clause).collect();
    let mut words = Vec::new();
    for word in clauses.join("; ").split(' ') {
        let open = word.len() - word.trim_start_matches('(').len();
        words.push(match word[open..].strip_prefix("--") {
            Some(option) if option.starts_with(|first: char| first.is_ascii_lowercase()) => {
                format!("{}{}", &word[..open], option.replace('-', "_"))
            }
            _ if word == "-o" => "output".to_owned(),
            _ => word.to_owned(),
        });
    }
    words.join(" ")
}

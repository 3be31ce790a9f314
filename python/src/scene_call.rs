//! What a scene says before it runs, as JSON.

use crate::exception::{of_command, of_scene, refused};
use crate::key_paths::keyed_line;
use crate::on_own_threads;
use crate::run_call::{RunOptions, SampleBuffers, copied, scene};
use afmsweep::cli;
use afmsweep::design::{Design, DesignDescription};
use afmsweep::scene::{Meant, QUANTITIES, design_of, meant, nearest as nearest_word, schema};
use afmsweep::units::{Dimension, parse};
use pyo3::prelude::*;
use pyo3::types::PyByteArray;
use serde_json::Value;
use std::collections::HashMap;

/// The SI unit of each quantity of a scene, by its path; `#` stands for a number, and "" for no unit.
#[pyfunction]
pub fn units() -> HashMap<&'static str, String> {
    QUANTITIES.iter().map(|one| (one.path, one.dimension.si_unit().to_string())).collect()
}

/// Where a name is that several sections have, the likeliest first.
const HOMES: [&str; 4] = ["sample.", "instrument.cantilever.", "instrument.tip.", "drive."];

/// The known word that a mistyped one is nearest to, that it is the end of, or that it is another name for.
#[pyfunction]
pub fn nearest(word: &str, known: Vec<String>) -> Option<String> {
    let word = word.trim().replace(' ', "_");
    let (parent, name) = word.rsplit_once('.').unwrap_or(("", &word));
    let named = match meant(name) {
        Some(Meant::Name(name)) => ended(name, parent, &known),
        _ => None,
    };
    let close = || nearest_word(&word, known.iter().map(String::as_str));
    ended(&word, "", &known).or(named).or_else(close).map(str::to_owned)
}

/// The known word that ends with these, of several the one below the parent or the likeliest.
fn ended<'a>(end: &str, parent: &str, known: &'a [String]) -> Option<&'a str> {
    let below = |one: &str| one.strip_suffix(end).is_some_and(|rest| rest.is_empty() || rest.ends_with('.'));
    let rank = |one: &&str| {
        let is_below = !parent.is_empty() && one.starts_with(parent);
        let home = HOMES.iter().position(|home| one.starts_with(home)).unwrap_or(HOMES.len());
        (!is_below, one.contains(".modes."), home)
    };
    known.iter().map(String::as_str).filter(|one| below(one)).min_by_key(rank)
}

/// The modes of a scene's first instance.
#[pyfunction]
pub fn modes(py: Python<'_>, text: &str, name: &str) -> PyResult<String> {
    json(py, None, || cli::modes::answer(&scene(text, name, Vec::new())?).map_err(|error| of_scene(&error)))
}

/// The static curves of an instance's contact; with `lever` over the base.
#[pyfunction]
pub fn force(
    py: Python<'_>,
    text: &str,
    name: &str,
    instance: usize,
    indentations: Vec<f64>,
    lever: bool,
) -> PyResult<String> {
    json(py, None, || {
        let scene = scene(text, name, Vec::new())?;
        if instance >= scene.len() {
            return Err(refused(&format!("there is no instance {instance}: the scene has {}", scene.len())));
        }
        cli::force::answer(&scene, instance, &indentations, lever).map_err(|error| of_command(&error))
    })
}

/// What a run would do; with `forecast` some instances are run, for the time of all.
#[pyfunction]
pub fn plan(
    py: Python<'_>,
    text: &str,
    name: &str,
    samples: SampleBuffers,
    options: RunOptions,
    forecast: bool,
) -> PyResult<String> {
    let samples = copied(py, &samples)?;
    json(py, options.threads(), || {
        let scene = scene(text, name, samples)?;
        let source = scene.source.clone();
        let mut answer =
            cli::plan::answer(&options.sweep(scene)?, forecast).map_err(|error| of_command(&error))?;
        for warning in answer["warnings"].as_array_mut().into_iter().flatten() {
            let told = warning.as_str().map(|line| keyed_line(line, name, &source));
            *warning = told.map_or(Value::Null, Value::String);
        }
        Ok(answer)
    })
}

/// The design of a text's `[uncertain]` and `[design]` as results tell of it.
#[pyfunction]
pub fn problem(text: &str) -> PyResult<String> {
    let design = design_of(text).map_err(|error| of_scene(&error))?;
    // Only tables, which have no distributions, are told by the ends of their columns.
    let ends = vec![(f64::NAN, f64::NAN); design.parameters.len()];
    let described = DesignDescription::new(&design, &ends);
    serde_json::to_string(&described).map_err(|error| refused(&error.to_string()))
}

/// The values of each of its parameters, by path, over its rows.
#[pyfunction]
pub fn points<'py>(py: Python<'py>, text: &str) -> PyResult<Vec<(String, Bound<'py, PyByteArray>)>> {
    let read = || design_of(text).map(|design| (design.columns(), design));
    let (columns, Design { parameters, .. }) =
        py.detach(|| on_own_threads(None, read))?.map_err(|error| of_scene(&error))?;
    let bytes = |values: &Vec<f64>| PyByteArray::new(py, bytemuck::cast_slice(values));
    Ok(parameters.iter().zip(&columns).map(|(one, values)| (one.path.clone(), bytes(values))).collect())
}

fn json(
    py: Python<'_>,
    threads: Option<usize>,
    work: impl FnOnce() -> PyResult<Value> + Send,
) -> PyResult<String> {
    Ok(py.detach(|| on_own_threads(threads, work))??.to_string())
}

/// The keys of a scene by their paths, without the numbers of listed modes.
#[pyfunction]
pub fn keys() -> Vec<String> {
    let mut found = Vec::new();
    walk(&schema(&|_| String::new()), "", &mut found);
    found
}

fn walk(object: &Value, path: &str, found: &mut Vec<String>) {
    if let Some(properties) = object["properties"].as_object() {
        for (key, value) in properties {
            let path = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
            walk(value, &path, found);
            found.push(path);
        }
    }
    ["items", "anyOf", "oneOf"].iter().for_each(|kind| match &object[*kind] {
        Value::Array(all) => all.iter().for_each(|one| walk(one, path, found)),
        one @ Value::Object(_) => walk(one, path, found),
        _ => {}
    });
}

/// A length in m, from a text with its unit.
#[pyfunction]
pub fn length(text: &str) -> PyResult<f64> {
    parse(text, Dimension::Length).map_err(|error| refused(&error.to_string()))
}

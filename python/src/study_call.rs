//! Studies: the samples of a data set, back as results that statistics take.

use crate::exception::{failed, of_command, plain, refused};
use crate::on_own_threads;
use afmsweep::Status;
use afmsweep::cli;
use afmsweep::report::{self as pages, ViewRequest};
use afmsweep::stats::{Study, SummaryOptions};
use afmsweep::store::{Attribute, Coordinate, Flags, Results, Variable};
use pyo3::buffer::PyBuffer;
use pyo3::prelude::*;
use serde_json::{Value, json};
use std::path::PathBuf;
use std::sync::Arc;

/// What statistics need of a data set.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct StudyData {
    title: String,
    list: bool,
    design: Option<String>,
    axes: Vec<AxisData>,
    variables: Vec<VariableData>,
    status: PyBuffer<u8>,
    flags: Vec<(String, PyBuffer<u8>)>,
}

#[derive(FromPyObject)]
#[pyo3(from_item_all)]
struct AxisData {
    name: String,
    units: String,
    long_name: String,
    scene_path: String,
    words: Vec<String>,
    values: PyBuffer<f64>,
    columns: Vec<AxisData>,
}

#[derive(FromPyObject)]
#[pyo3(from_item_all)]
struct VariableData {
    name: String,
    units: String,
    long_name: String,
    error_scale: String,
    harmonics: Option<usize>,
    values: PyBuffer<f64>,
}

impl AxisData {
    fn coordinate(self, py: Python<'_>) -> PyResult<Coordinate> {
        let values = Arc::new(self.values.to_vec(py)?);
        let columns = self.columns.into_iter().map(|one| one.coordinate(py)).collect::<PyResult<_>>()?;
        let Self { name, units, long_name, scene_path, words, .. } = self;
        Ok(Coordinate { name, units, long_name, scene_path, words, values, columns })
    }
}

impl StudyData {
    fn study(self, py: Python<'_>) -> PyResult<Study> {
        let variable = |one: VariableData| {
            let data = one.values.to_vec(py)?;
            let VariableData { name, units, long_name, error_scale, harmonics, .. } = one;
            Ok(Variable { name, units, long_name, harmonics, error_scale, data })
        };
        let flags = |(name, codes): (String, PyBuffer<u8>)| {
            Ok(Flags { name, data: codes.to_vec(py)?, ..Flags::default() })
        };
        let design = self.design.map(|text| ("design".into(), Attribute::Text(text)));
        let results = Results {
            title: self.title,
            list: self.list,
            axes: self.axes.into_iter().map(|one| one.coordinate(py)).collect::<PyResult<_>>()?,
            variables: self.variables.into_iter().map(variable).collect::<PyResult<_>>()?,
            flags: self.flags.into_iter().map(flags).collect::<PyResult<_>>()?,
            status: self.status.to_vec(py)?,
            attributes: design.into_iter().collect(),
            ..Results::default()
        };
        Study::of(&results).map_err(|error| refused(&error.to_string()))
    }
}

/// The statistics of observables, as JSON. `left_out`: largest share of failed rows; `kept`: statuses that count beside ok.
#[pyfunction]
pub fn stats(
    py: Python<'_>,
    data: StudyData,
    names: Vec<String>,
    left_out: f64,
    kept: Vec<String>,
) -> PyResult<String> {
    let status = |word: &String| {
        let found = Status::ALL.into_iter().find(|status| status.meaning() == word);
        found.ok_or_else(|| refused(&format!("{word:?} is no status")))
    };
    let kept = kept.iter().map(status).collect::<PyResult<Vec<Status>>>()?;
    let (study, options) = (data.study(py)?, SummaryOptions { most_left_out: left_out, kept });
    let work = || cli::stats::answer(&study, &names, &options);
    let answer = py.detach(|| on_own_threads(None, work))?;
    answer.map(|answer| answer.to_string()).map_err(|error| refused(&error.to_string()))
}

/// What observed values or a measured curve tell, as JSON: a list of points and one of doubts. `words`: as the command
/// takes them.
#[pyfunction]
pub fn infer(py: Python<'_>, data: StudyData, words: Vec<String>) -> PyResult<String> {
    let study = data.study(py)?;
    let answer = py.detach(|| on_own_threads(None, || cli::infer::answer(&study, &words)))?;
    let (points, doubts): (Vec<Value>, Vec<String>) = answer.map_err(|error| of_command(&error))?;
    let doubts: Vec<String> = doubts.iter().map(|doubt| plain(doubt)).collect();
    Ok(json!([points, doubts]).to_string())
}

/// How results are shown, see the command `report`.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct ReportView {
    x: Option<String>,
    y: Option<String>,
    curves: Option<String>,
    at: Vec<(String, String)>,
    below: Vec<(String, String)>,
    above: Vec<(String, String)>,
    branch: Option<String>,
}

/// Writes the page of a results file and its pictures; gives the page's path.
#[pyfunction]
pub fn report(py: Python<'_>, file: PathBuf, output: Option<PathBuf>, view: ReportView) -> PyResult<PathBuf> {
    let ReportView { x, y, curves, at, below, above, branch } = view;
    let wish = ViewRequest { x, y, curves, at, below, above, branch, engine: None };
    let write = || pages::write(&file, output.as_deref(), &wish);
    let written = py.detach(|| on_own_threads(None, write))?;
    written.map(|report| report.folder.join("index.html")).map_err(|error| failed(&error.to_string()))
}

//! Runs: the work on threads of its own, while the calling thread hears signals and tells Python how far it is.

use crate::exception::{self, failed, refused};
use crate::labelled_arrays::{LabelledGroup, groups, to_python};
use crate::on_own_threads;
use crate::python_observer::PythonObserver;
use afmsweep::cli::run::finished;
use afmsweep::control::MemoryJournal;
use afmsweep::engine::Progress;
use afmsweep::scene::SampleArrays;
use afmsweep::store::{self, Attribute, ExistingFile, RunFile};
use afmsweep::sweep::{JournaledOutcome, RunJournal, Share, read_header};
use afmsweep::{Audit, Backend, Precision, Scene, Sweep};
use pyo3::buffer::PyBuffer;
use pyo3::prelude::*;
use pyo3::types::PyList;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// Between two looks at Python's signals.
const LOOK: Duration = Duration::from_millis(50);
/// What results say of how they were called.
const CALLED: &str = "none: run by afmsweep in Python";

/// Buffers of numbers by the paths of their quantities.
pub type SampleBuffers = Vec<(String, PyBuffer<f64>)>;

/// How a scene is run.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct RunOptions {
    backend: String,
    precision: Option<String>,
    threads: Option<usize>,
    audit: Option<u32>,
    portion: Option<usize>,
    output: Option<PathBuf>,
    resume: bool,
}

impl RunOptions {
    pub fn threads(&self) -> Option<usize> {
        self.threads
    }

    /// The sweep of a scene with these options.
    pub fn sweep(&self, scene: Scene) -> PyResult<Sweep> {
        let backend = match self.backend.as_str() {
            "auto" => Backend::Auto,
            "gpu" => Backend::Gpu,
            "cpu" => Backend::Cpu,
            "reference" => Backend::Reference,
            other => {
                return Err(refused(&format!("backend {other:?}: expected auto, gpu, cpu or reference")));
            }
        };
        let precision = match self.precision.as_deref() {
            None => None,
            Some("f32") => Some(Precision::F32),
            Some("f64") => Some(Precision::F64),
            Some(other) => return Err(refused(&format!("precision {other:?}: expected f32 or f64"))),
        };
        let audit = match self.audit {
            None => Audit::Auto,
            Some(0) => Audit::None,
            Some(count) => Audit::Instances(count),
        };
        if self.portion == Some(0) {
            return Err(refused("portion 0: expected 1 instance or more"));
        }
        let sweep =
            Sweep::new(scene).backend(backend).precision(precision).audit(audit).portion(self.portion);
        Ok(sweep.command_line(CALLED.into()))
    }
}

/// Copies of the samples' buffers.
pub fn copied(py: Python<'_>, samples: &SampleBuffers) -> PyResult<SampleArrays> {
    samples.iter().map(|(path, values)| Ok((path.clone(), values.to_vec(py)?))).collect()
}

/// A scene from its text, with samples if there are some.
pub fn scene(text: &str, name: &str, samples: SampleArrays) -> PyResult<Scene> {
    let read = match samples.is_empty() {
        true => Scene::parse(Path::new(name), text),
        false => Scene::parse_with_samples(Path::new(name), text, samples),
    };
    read.map_err(|error| exception::of_scene(&error))
}

/// Runs a scene. `report` is called with `("progress", (phase, share))` and with messages: `("warning", text)`,
/// `("info", text)`, `("debug", text)`. What it raises stops the run and is raised here; what is done by then is its
/// attribute `partial`.
#[pyfunction]
pub fn run<'py>(
    py: Python<'py>,
    text: &str,
    name: &str,
    samples: SampleBuffers,
    options: RunOptions,
    report: Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyList>> {
    let samples = copied(py, &samples)?;
    let (watch, observer) = (Arc::new(Progress::default()), PythonObserver::default());
    let (done, stopped) = std::thread::scope(|scope| {
        let (send, receive) = channel();
        let (watch, observer, options) = (&watch, &observer, &options);
        scope.spawn(move || {
            let work = || scene(text, name, samples).and_then(|scene| swept(scene, options, watch, observer));
            send.send(on_own_threads(options.threads, work).flatten())
        });
        wait(py, receive, watch, &|| told(py, observer, &report))
    });
    match (done, stopped) {
        (done, None) => {
            told(py, &observer, &report)?;
            to_python(py, done?)
        }
        (Ok(groups), Some(stop)) => {
            // Not every exception takes attributes; it is raised all the same.
            let _ = stop.value(py).setattr("partial", to_python(py, groups)?);
            Err(stop)
        }
        (Err(_), Some(stop)) => Err(stop),
    }
}

/// What the work gave, and what Python raised meanwhile.
type Waited<T> = (PyResult<T>, Option<PyErr>);

/// Waits for the work. Signals are the calling thread's alone, and so is what Python is told.
fn wait<T: Send>(
    py: Python<'_>,
    receive: Receiver<PyResult<T>>,
    watch: &Progress,
    tell: &dyn Fn() -> PyResult<()>,
) -> Waited<T> {
    let (receive, mut stopped) = (Mutex::new(receive), None);
    loop {
        let next = || receive.lock().unwrap_or_else(PoisonError::into_inner).recv_timeout(LOOK);
        match py.detach(next) {
            Ok(done) => return (done, stopped),
            Err(RecvTimeoutError::Disconnected) => return (Err(failed("the run ended by itself")), stopped),
            Err(RecvTimeoutError::Timeout) => {}
        }
        if stopped.is_none()
            && let Err(error) = py.check_signals().and_then(|()| tell())
        {
            stopped = Some(error);
            watch.stop();
        }
    }
}

fn told(py: Python<'_>, observer: &PythonObserver, report: &Bound<'_, PyAny>) -> PyResult<()> {
    for (kind, message) in observer.fetched() {
        report.call1((kind, message))?;
    }
    if let Some(phase) = observer.progressed() {
        report.call1(("progress", phase.into_pyobject(py)?))?;
    }
    Ok(())
}

fn swept(
    scene: Scene,
    options: &RunOptions,
    watch: &Arc<Progress>,
    observer: &PythonObserver,
) -> PyResult<Vec<LabelledGroup>> {
    observer.begin(&scene);
    if let Some(output) = options.output.as_deref() {
        return swept_into(output, scene, options, watch, observer);
    }
    let sweep = options.sweep(scene)?.watched_by(watch);
    let memory = MemoryJournal::default();
    let swept = sweep.run_in(&memory, observer).map_err(|error| exception::of_run(&error))?;
    observer.end(&swept);
    groups(&swept.frame.results, &swept.numbers())
}

/// Runs into a file, beside which its journal grows.
fn swept_into(
    output: &Path,
    scene: Scene,
    options: &RunOptions,
    watch: &Arc<Progress>,
    observer: &PythonObserver,
) -> PyResult<Vec<LabelledGroup>> {
    if options.resume && finished(output, &scene).is_some() {
        return of_file(output);
    }
    let earlier = if options.resume { ExistingFile::GoneOnWith } else { ExistingFile::Kept };
    let of_store = |error| exception::of_store(&error);
    let of_run = |error| exception::of_run(&error);
    let (file, journal) = RunFile::create(output, &scene.source, earlier).map_err(of_store)?;
    let keeper = RunJournal::of_run(file, journal, Share::ALL, false).map_err(of_run)?;
    let sweep = options.sweep(scene)?.watched_by(watch);
    let swept = sweep.run_into(&keeper, observer).map_err(of_run)?;
    observer.end(&swept);
    let partial = store::partial_path(output);
    if !swept.missing.is_empty() {
        if !watch.stopped() {
            let why = "instances were left behind; resume=True goes on with";
            return Err(failed(&format!("{why} {}", partial.display())));
        }
        return groups(&swept.frame.results, &swept.numbers());
    }
    let image = swept.laid_out(&partial).map_err(of_run)?;
    drop::<JournaledOutcome>(swept);
    let file = keeper.into_file().ok_or_else(|| failed("the run has no file"))?;
    file.finish_image(&image).map_err(of_store)?;
    of_file(output)
}

/// What a results file holds, or the journal of a run that is not whole.
#[pyfunction]
pub fn opened<'py>(py: Python<'py>, path: PathBuf) -> PyResult<Bound<'py, PyList>> {
    let is_journal = store::open_journal(&path).is_ok();
    let read = || if is_journal { of_journal(&path) } else { of_file(&path) };
    to_python(py, py.detach(|| on_own_threads(None, read))??)
}

fn of_file(path: &Path) -> PyResult<Vec<LabelledGroup>> {
    let of_store = |error| exception::of_store(&error);
    let mut results = store::read(path).map_err(of_store)?;
    let history = store::history_of(path).map_err(of_store)?;
    results.attributes.push(("history".into(), Attribute::Text(history)));
    groups(&results, &results)
}

fn of_journal(path: &Path) -> PyResult<Vec<LabelledGroup>> {
    let of_run = |error| exception::of_run(&error);
    let journal = store::open_journal(path).map_err(|error| exception::of_store(&error))?;
    let (recipe, share) = read_header(journal.header()).map_err(of_run)?;
    // Nothing is run: any engine will do.
    let sweep = Sweep::new(recipe.scene().map_err(of_run)?).told_as(&recipe).backend(Backend::Cpu);
    let keeper = RunJournal::of_journals(vec![journal], share).map_err(of_run)?;
    let swept = sweep.look_into(&keeper).map_err(of_run)?;
    groups(&swept.frame.results, &swept.numbers())
}

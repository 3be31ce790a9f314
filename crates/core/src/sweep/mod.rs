//! A whole run as `afmsweep run` does it: from a scene to its results, in memory or in a journal.
//!
//! ```
//! use afmsweep_core::sweep::Sweep;
//! use afmsweep_model::scene::Scene;
//!
//! let scene = Scene::parse("example.toml".as_ref(), r#"
//! [instrument.cantilever]
//! stiffness = "10 N/m"
//! frequency = "75 kHz"
//! quality_factor = 30
//! [sample]
//! surface_energy = "20 mJ/m^2"
//! [contact]
//! law = "dmt"
//! [drive]
//! on = "tip"
//! frequency = "resonance"
//! free_amplitude = "20 nm"
//! [approach]
//! gap = "15 nm"
//! [sweep]
//! "sample.youngs_modulus" = { values = ["1 GPa", "2 GPa", "4 GPa"] }
//! "#)?;
//! let swept = Sweep::new(scene).run()?;
//! let amplitude = swept.results.observable("amplitude").expect("the scene asks for it");
//! assert_eq!(amplitude.shape, [3]);
//! assert_eq!(amplitude.axes[0].name, "sample_youngs_modulus");
//! assert!(amplitude.values.iter().all(|metres| *metres > 10e-9 && *metres < 20e-9));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod audit_budget;
mod engine_choice;
mod engine_selection;
mod execution;
#[cfg(feature = "hdf5")]
mod followup_index;
mod forecast;
mod observer;
mod planned_sweep;
mod recipe;
#[cfg(feature = "hdf5")]
mod run_journal;
mod sweep_error;
mod sweep_outcome;
mod sweep_phase;

pub use audit_budget::{AUDIT_SECONDS, AUDIT_SHARE, CONTACT_SEARCH_SECONDS as AUDIT_CONTACT};
pub use engine_choice::EngineChoice;
pub use forecast::Forecast;
pub use observer::{Observer, Silent};
pub use recipe::Recipe;
#[cfg(feature = "hdf5")]
pub use run_journal::{RunJournal, Share, command_of, is_of_merge, read_header};
pub use sweep_error::Error;
pub use sweep_outcome::{JournaledOutcome, SweepOutcome};
pub use sweep_phase::SweepPhase;

use crate::control::{Course, MemoryJournal};
use crate::engine::{Engine, Progress, on_threads, while_watched};
use crate::plan::{Plan, Policy, Precision};
use crate::scene::Scene;
use planned_sweep::PlannedSweep;
use std::sync::Arc;
use std::time::Duration;

/// The engine that steps the instances.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Backend {
    /// A real GPU if there is one and the run integrates long enough to profit from it, else the CPU.
    #[default]
    Auto,
    /// Any GPU adapter, even a software driver.
    Gpu,
    Cpu,
    /// Adaptive steps with located contact events: slow and exact.
    Reference,
}

/// How many instances the reference engine redoes after the run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Audit {
    /// As many as a tenth of the run's time allows, or [`AUDIT_SECONDS`], and at least one that touches the sample.
    #[default]
    Auto,
    /// This many.
    Instances(u32),
    None,
}

/// A scene with its run options.
#[derive(Clone, Debug)]
pub struct Sweep {
    scene: Scene,
    options: Options,
    prepared: Option<Recipe>,
    progress: Arc<Progress>,
}

#[derive(Clone, Debug)]
struct Options {
    backend: Backend,
    device: Option<String>,
    precision: Option<Precision>,
    threads: Option<usize>,
    estimate: bool,
    cold: bool,
    policy: Policy,
    audit: Audit,
    portion: Option<usize>,
    command_line: String,
}

impl Sweep {
    /// A sweep with error control, a default audit and a trial of precision, on all cores or a GPU.
    pub fn new(scene: Scene) -> Self {
        let options = Options {
            backend: Backend::Auto,
            device: None,
            precision: None,
            threads: None,
            estimate: true,
            cold: false,
            policy: Policy::STANDARD,
            audit: Audit::Auto,
            portion: None,
            command_line: "none: run by the library".into(),
        };
        Self { scene, options, prepared: None, progress: Arc::default() }
    }

    /// Sets the engine.
    #[must_use]
    pub fn backend(mut self, backend: Backend) -> Self {
        self.options.backend = backend;
        self
    }

    /// Sets the GPU adapter by its index or part of its name, several of one kind separated by commas, or `all` of the best
    /// one's kind. None leaves the choice to the run. Results do not depend on the number of devices.
    #[must_use]
    pub fn device(mut self, device: Option<String>) -> Self {
        self.options.device = device;
        self
    }

    /// Sets the arithmetic of the inner loop. None leaves it to a trial of both.
    #[must_use]
    pub fn precision(mut self, precision: Option<Precision>) -> Self {
        self.options.precision = precision;
        self
    }

    /// Sets the numbers of error control in place of [`Policy::STANDARD`]. The results carry them.
    #[must_use]
    pub fn policy(mut self, policy: Policy) -> Self {
        self.options.policy = policy;
        self
    }

    /// Sets the threads of the whole run: planning, stepping, audit, recording. None uses the caller's pool.
    #[must_use]
    pub fn threads(mut self, threads: Option<usize>) -> Self {
        self.options.threads = threads;
        self
    }

    /// Sets the steps per drive period of every instance. None leaves them to the scene and the plan.
    #[must_use]
    pub fn steps_per_period(mut self, steps: Option<u32>) -> Self {
        if steps.is_some() {
            self.scene.run.steps_per_period = steps;
        }
        self
    }

    /// Sets whether errors are estimated and instances refined. If not, each instance runs once as planned.
    #[must_use]
    pub fn estimate(mut self, estimate: bool) -> Self {
        self.options.estimate = estimate;
        self
    }

    /// Sets whether each search starts from the instance's own free oscillation. If not, the searches of a large sweep start
    /// from their neighbours' states.
    #[must_use]
    pub fn cold(mut self, cold: bool) -> Self {
        self.options.cold = cold;
        self
    }

    /// Sets the audit by the reference engine.
    #[must_use]
    pub fn audit(mut self, audit: Audit) -> Self {
        self.options.audit = audit;
        self
    }

    /// Sets the number of instances that run and are stored together. None leaves it to the run. Results do not depend on it.
    #[must_use]
    pub fn portion(mut self, instances: Option<usize>) -> Self {
        self.options.portion = instances;
        self
    }

    /// Runs with choices made before.
    #[must_use]
    pub fn prepared(mut self, prepared: Option<Recipe>) -> Self {
        self.prepared = prepared.or(self.prepared);
        self
    }

    /// Takes engine, precision, steps and error control from the run that made these choices.
    #[must_use]
    pub fn told_as(mut self, prepared: &Recipe) -> Self {
        prepared.put_into(&mut self.options, &mut self.scene);
        self.prepared(Some(prepared.clone()))
    }

    /// Sets attribute `command_line` of the results: how the program was called.
    #[must_use]
    pub fn command_line(mut self, text: String) -> Self {
        self.options.command_line = text;
        self
    }

    /// Progress of the run, from any thread. [`Progress::stop`] ends the run early.
    pub fn progress(&self) -> Arc<Progress> {
        Arc::clone(&self.progress)
    }

    /// Uses the caller's progress to watch and stop the run.
    #[must_use]
    pub fn watched_by(mut self, progress: &Arc<Progress>) -> Self {
        self.progress = Arc::clone(progress);
        self
    }

    /// The scene with its changes.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The plan of a run, and its engine.
    ///
    /// # Errors
    /// The instrument cannot be reduced, or the device does not exist.
    pub fn plan(&self, observer: &dyn Observer) -> Result<(Plan, Box<dyn Engine>), Error> {
        let precision = self.options.precision.unwrap_or(Precision::F64);
        let mut plan = Plan::new(&self.scene, precision).map_err(|error| error.in_scene(&self.scene))?;
        plan.precision_open = self.options.precision.is_none();
        plan.policy = self.options.policy;
        plan.cold = self.options.cold;
        let engine = engine_selection::engine(&self.options, &mut plan, observer)?;
        Ok((plan, engine))
    }

    /// Runs the sweep.
    ///
    /// # Errors
    /// See [`Error`]. A run that is stopped after some instances returns these; [`SweepOutcome::missing`] says what they
    /// lack.
    pub fn run(&self) -> Result<SweepOutcome, Error> {
        self.run_with(&Silent)
    }

    /// Runs the sweep and reports to the observer.
    ///
    /// # Errors
    /// Those of [`Sweep::run`].
    pub fn run_with(&self, observer: &dyn Observer) -> Result<SweepOutcome, Error> {
        self.run_in(&MemoryJournal::default(), observer)?.gathered()
    }

    /// Runs like [`Sweep::run_with`], but everything beyond a few bytes for each instance stays packed in the journal.
    ///
    /// # Errors
    /// Those of [`Sweep::run`].
    pub fn run_in<'k>(
        &self,
        memory: &'k MemoryJournal,
        observer: &dyn Observer,
    ) -> Result<JournaledOutcome<'k>, Error> {
        let of_all = |run: &mut PlannedSweep| run.run_all(memory);
        self.watched(observer, || self.execute(observer, memory, &of_all))
    }

    /// Makes the choices for a run of the scene: bases, first steps, precision, chunk size.
    ///
    /// # Errors
    /// Those of [`Sweep::run`].
    pub fn prepare(&self, observer: &dyn Observer) -> Result<Recipe, Error> {
        self.watched(observer, || self.begun(observer)?.recipe())
    }

    /// Runs with a journal, which provides earlier results and stores new ones. Memory holds a few bytes for each instance; the
    /// journal has the rest.
    ///
    /// # Errors
    /// Those of [`Sweep::run`]; the journal has other choices; its disk fails.
    #[cfg(feature = "hdf5")]
    pub fn run_into<'k>(
        &self,
        keeper: &'k RunJournal,
        observer: &dyn Observer,
    ) -> Result<JournaledOutcome<'k>, Error> {
        let kept = |run: &mut PlannedSweep| run.run_journaled(keeper);
        let done = self.watched(observer, || self.execute(observer, keeper, &kept));
        keeper.failure().map_or(done, Err)
    }

    /// Runs one share into its journal. True if the share is complete.
    ///
    /// # Errors
    /// Those of [`Sweep::run_into`].
    #[cfg(feature = "hdf5")]
    pub fn run_share(&self, keeper: &RunJournal, observer: &dyn Observer) -> Result<bool, Error> {
        self.watched(observer, || {
            let run = self.begun(observer)?.run_journaled(keeper)?;
            Ok(!self.progress.stopped() && run.is_run(|number| keeper.share().has(number)))
        })
    }

    /// Results of what a journal holds, without running anything. Memory holds a few bytes for each instance.
    ///
    /// # Errors
    /// Those of [`Sweep::run_into`].
    #[cfg(feature = "hdf5")]
    pub fn look_into<'k>(&self, keeper: &'k RunJournal) -> Result<JournaledOutcome<'k>, Error> {
        self.execute(&Silent, keeper, &|run| {
            let prepared = run.journal_recipe(keeper)?;
            self.progress.stop();
            run.run_by(prepared, keeper)
        })
    }

    /// Does the work on the requested threads and reports its progress to the observer.
    fn watched<T: Send>(
        &self,
        observer: &dyn Observer,
        work: impl FnOnce() -> Result<T, Error> + Send,
    ) -> Result<T, Error> {
        let watch = || {
            if observer.progress(&self.progress.phase()).is_break() {
                self.progress.stop();
            }
        };
        on_threads(self.options.threads, || while_watched(Duration::from_millis(50), watch, work))?
    }

    /// Plans the sweep for an engine.
    fn begun(&self, observer: &dyn Observer) -> Result<PlannedSweep<'_>, Error> {
        let course = Recipe::course(&self.options, &self.scene);
        let (mut plan, engine) = self.plan(observer)?;
        plan.precision_open &= course == Course::Controlled;
        observer.planned(&plan, engine.as_ref());
        if self.progress.stopped() {
            return Err(Error::Stopped(SweepPhase::Planning));
        }
        Ok(PlannedSweep { sweep: self, course, plan, engine })
    }
}

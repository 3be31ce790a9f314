//! The choices for a scene as text. A run with this text repeats the run that made the choices.

use super::{Backend, Error, Options};
use crate::control::{Choices, Course};
use crate::plan::Policy;
use crate::scene::Scene;
use serde::{Deserialize, Serialize};

/// Version of the text format.
const FORMAT: u32 = 1;

/// The choices for a scene, with the scene, program, options and device they belong to.
/// [`Sweep::prepare`](super::Sweep::prepare) makes them.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub struct Recipe {
    format: u32,
    /// Version of the program and revision of its sources.
    program: String,
    /// CRC-32 of the scene's text and of every number that it sweeps.
    scene_sum: String,
    /// Options of the user beside the scene.
    options: RecipeOptions,
    /// The device, and the kind of engine, which determines the last bits.
    device: String,
    engine: String,
    /// File of the scene, and its text.
    pub(super) scene_file: String,
    scene: String,
    pub(super) choices: Choices,
}

/// Options of a run that affect its results.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize, Serialize)]
struct RecipeOptions {
    course: Course,
    precision: String,
    steps_per_period: String,
    policy: String,
}

impl RecipeOptions {
    fn of(options: &Options, scene: &Scene) -> Self {
        let steps = scene.run.steps_per_period.map_or("the plan's".to_owned(), |steps| steps.to_string());
        let precision = options.precision.map_or("open", |precision| precision.name());
        let policy = match options.policy == Policy::STANDARD {
            true => "standard".to_owned(),
            false => options.policy.lines().join(", "),
        };
        let course = match (options.backend, options.estimate) {
            (Backend::Reference, _) => Course::Reference,
            (_, true) => Course::Controlled,
            (_, false) => Course::Once,
        };
        Self { course, precision: precision.into(), steps_per_period: steps, policy }
    }

    /// The options as text.
    fn words(&self) -> String {
        let Self { course, precision, steps_per_period, policy } = self;
        let course = match course {
            Course::Controlled => "errors controlled",
            Course::Once => "no estimates",
            Course::Reference => "by the reference engine",
        };
        format!("{course}, precision {precision}, steps per period {steps_per_period}, policy {policy}")
    }
}

/// CRC-32 of a scene's text, and of every number that it sweeps or that its table of forces has: they may come from another
/// file.
fn sum(scene: &Scene) -> String {
    let mut sum = crc32fast::Hasher::new();
    sum.update(scene.source.as_bytes());
    for axis in scene.sweep.quantities() {
        sum.update(axis.path.as_bytes());
        axis.values.iter().for_each(|value| sum.update(&value.to_bits().to_le_bytes()));
    }
    if let Some(table) = &scene.base.contact.table {
        let out = table.retraction.iter().flat_map(|out| &out.forces);
        let numbers = table.indentations.iter().chain(&table.forces).chain(out);
        numbers.for_each(|number| sum.update(&number.to_bits().to_le_bytes()));
    }
    format!("{:08x}", sum.finalize())
}

/// Name of this program in a [`Recipe`].
fn program() -> String {
    format!("afmsweep {} ({})", env!("CARGO_PKG_VERSION"), crate::record::SOURCE_REVISION)
}

impl Recipe {
    pub(super) fn new(
        scene: &Scene,
        options: &Options,
        (device, engine): (String, String),
        choices: Choices,
    ) -> Self {
        Self {
            format: FORMAT,
            program: program(),
            scene_sum: sum(scene),
            options: RecipeOptions::of(options, scene),
            device,
            engine,
            scene_file: scene.path.to_string_lossy().into_owned(),
            scene: scene.source.clone(),
            choices,
        }
    }

    /// How the options want each instance to get its result.
    pub(super) fn course(options: &Options, scene: &Scene) -> Course {
        RecipeOptions::of(options, scene).course
    }

    /// Writes the text for [`Recipe::from_toml`].
    ///
    /// # Errors
    /// None is known.
    pub fn to_toml(&self) -> Result<String, Error> {
        toml::to_string(self).map_err(|error| Error::Prepared { what: error.to_string() })
    }

    /// Reads the text of [`Recipe::to_toml`].
    ///
    /// # Errors
    /// The text is something else, or another version of the program wrote it.
    pub fn from_toml(text: &str) -> Result<Self, Error> {
        let wrong = |what: String| Error::Prepared { what };
        #[derive(Deserialize)]
        struct Head {
            format: u32,
        }
        let head: Head = toml::from_str(text)
            .map_err(|_| wrong("this is no text of choices; `afmsweep prepare SCENE` writes one".into()))?;
        if head.format != FORMAT {
            let what = format!("these choices have format {} and this program reads {FORMAT}", head.format);
            return Err(wrong(what));
        }
        let place = |error: toml::de::Error| error.message().to_owned();
        toml::from_str(text).map_err(|error| wrong(format!("these choices are spoilt: {}", place(error))))
    }

    /// The device of the run that made the choices.
    pub fn device(&self) -> &str {
        &self.device
    }

    /// The text of the scene.
    pub fn scene_text(&self) -> &str {
        &self.scene
    }

    /// Reads the scene again, with the files that it names.
    ///
    /// # Errors
    /// The scene cannot be read, or a file that it reads has changed.
    pub fn scene(&self) -> Result<Scene, Error> {
        let path = std::path::Path::new(&self.scene_file);
        let scene = Scene::parse(path, &self.scene)?;
        match sum(&scene) == self.scene_sum {
            true => Ok(scene),
            false => Err(Error::Prepared {
                what: "what the scene sweeps is not what it was when the run was prepared".into(),
            }),
        }
    }

    /// Sets engine, precision and steps as in the run that made the choices.
    pub(super) fn put_into(&self, options: &mut Options, scene: &mut Scene) {
        use crate::plan::Precision;
        let all = [Precision::F32, Precision::F64];
        options.precision = all.into_iter().find(|one| one.name() == self.options.precision);
        options.estimate = self.options.course != Course::Once;
        options.backend = match self.options.course {
            Course::Reference => Backend::Reference,
            _ if self.engine.starts_with("gpu ") => Backend::Gpu,
            _ => Backend::Cpu,
        };
        scene.run.steps_per_period = self.options.steps_per_period.parse().ok();
    }

    /// Refuses choices made for another scene, with other options or by another version of the program, or for an engine with
    /// other last bits. `anyway` accepts another version or engine.
    pub(super) fn check(
        &self,
        scene: &Scene,
        options: &Options,
        engine: &str,
        anyway: bool,
    ) -> Result<(), Error> {
        let wrong = |what: String| Err(Error::Prepared { what });
        let (theirs, ours) = (&self.scene_sum, sum(scene));
        if self.scene != scene.source {
            return wrong(format!(
                "the choices are of another scene (its sum is {theirs}, this one's {ours})"
            ));
        }
        if *theirs != ours {
            return wrong(format!(
                "a file that the scene names, of forces or of samples, is not what it was when the run began (the sum of \
                 all is {ours}, it was {theirs}): put the old file back, or begin the run anew"
            ));
        }
        let told = RecipeOptions::of(options, scene);
        if told != self.options {
            return wrong(format!(
                "the choices are of a run with other options ({}; this one: {})",
                self.options.words(),
                told.words()
            ));
        }
        if self.program != program() && !anyway {
            return wrong(format!(
                "the run was begun by {} and this is {}: their last bits may differ; --resume=anyway goes on all the same",
                self.program,
                program()
            ));
        }
        if self.engine != engine && !anyway {
            return Err(Error::OtherEngine { theirs: self.engine.clone(), ours: engine.into() });
        }
        Ok(())
    }

    /// Whether both come from the same choice. Shares of one run are recognised by it.
    pub fn is_of_one_run_with(&self, other: &Self) -> bool {
        let bare = |one: &Self| Self { device: String::new(), scene_file: String::new(), ..one.clone() };
        let text = |one: &Self| bare(one).to_toml().ok();
        text(self).is_some() && text(self) == text(other)
    }
}

//! What the user wrote: the scene file, its sweep, and the cases it stands for.

mod address;
mod array_samples;
mod axes;
mod axis_zip;
mod cases;
mod curve_section;
mod design_section;
mod draft;
mod drive_rules;
mod file;
mod json_schema;
mod levers;
mod output;
mod outside_params;
mod outside_rules;
mod outside_section;
mod params;
mod paths;
mod plausibility;
mod provenance;
mod quantities;
mod quantity;
mod rules;
mod sample_rules;
mod sample_table;
mod scene_echo;
mod scene_error;
mod scene_reader;
mod scene_schema;
mod setpoint_rules;
mod sweep_section;
mod synonyms;
mod table_file;
mod tabulated_force;
mod tip_params;
mod tip_rules;
mod uncertain_section;
mod values;

pub use crate::suggestion::nearest;
pub use address::Address;
pub use cases::Cases;
pub use design_section::design_of;
pub use draft::SampleArrays;
pub use levers::{LEVERS, MakersLever};
pub use params::*;
use paths::LAW;
pub use quantities::QUANTITIES;
pub use quantity::{Domain, Quantity};
pub use scene_error::SceneError;
pub use scene_schema::schema;
pub use synonyms::{Meant, meant};

use crate::design::Design;
use crate::observe::Observable;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Most modes an instance can be stepped with (`[run] modes`).
pub const STEPPED_MODES: usize = crate::kernel::MODES_MAX;

/// A scene as read, checked and ready to plan.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Where it was read from.
    pub path: PathBuf,
    /// The TOML text as read.
    pub source: String,
    pub title: String,
    /// The case before the sweep's values are put in.
    pub base: Params,
    pub sweep: SweptAxes,
    pub run: Run,
    pub output: Output,
    /// The maker's lever that it names as its preset.
    pub lever: Option<&'static MakersLever>,
    /// Where its samples come from.
    pub drawn: Drawn,
    /// What the file says, and where.
    said: Vec<draft::Said>,
}

/// Where the samples of a scene come from, if not from its own lists.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Drawn {
    /// `[uncertain]` and `[design]`.
    pub design: Option<Box<Design>>,
    /// The file of a table.
    pub file: Option<TableFile>,
    /// Whether they are arrays of the caller, which no text has.
    pub arrays: bool,
    /// What is odd about them: a place of the scene and a line.
    odd: Vec<(std::ops::Range<usize>, String)>,
}

/// A file of samples.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TableFile {
    /// As the scene names it, from its own folder.
    pub file: String,
    /// Paths of its columns, where it has no header.
    pub names: Option<Vec<String>>,
}

impl Scene {
    /// Reads and checks a scene file.
    ///
    /// # Errors
    /// The file cannot be read, is not UTF-8 or not TOML, or says something that is unknown, impossible,
    /// half said or said twice; the error knows the place and renders it.
    pub fn load(path: &Path) -> Result<Self, SceneError> {
        file::load(path)
    }

    /// Checks a scene's text; `path` is named in messages and gives the default title.
    ///
    /// # Errors
    /// As [`Scene::load`], reading apart.
    pub fn parse(path: &Path, text: &str) -> Result<Self, SceneError> {
        scene_reader::parse(path, text, None)
    }

    /// Likewise with arrays in place of `[samples]`, which the text then must not have: as many values of each quantity, in SI
    /// units. [`Scene::source`] gets a line that tells of them.
    ///
    /// # Errors
    /// As [`Scene::parse`]; arrays of different lengths, or impossible values.
    pub fn parse_with_samples(path: &Path, text: &str, samples: SampleArrays) -> Result<Self, SceneError> {
        scene_reader::parse(path, text, Some(samples))
    }

    /// Number of instances; 1 without a sweep.
    pub fn len(&self) -> usize {
        self.sweep.len()
    }

    /// A scene always has an instance.
    pub fn is_empty(&self) -> bool {
        self.sweep.is_empty()
    }

    /// Instance `index` (below [`Scene::len`]): the base case with the sweep's values put in. No text is parsed.
    pub fn instance(&self, index: usize) -> Params {
        Cases::of(self).instance(index)
    }

    /// Whether the amplitude, the deflection or the phase is held at a set-point, in some instances or in all.
    pub fn holds_motion(&self) -> bool {
        let held = self.base.approach.held.is_some_and(|held| !matches!(held, Held::Force(_)));
        held || self.sweep.quantities().any(|axis| axis.path == "approach.setpoint")
    }

    /// The swept values of an instance, as ` (sample.youngs_modulus = "1 GPa", ...)`; nothing without a sweep.
    pub fn described(&self, index: usize) -> String {
        let written = |(axis, at): (&Axis, usize)| axis.written(at);
        let values: Vec<String> =
            self.sweep.axes.iter().zip(self.sweep.indices(index)).map(written).collect();
        match values.is_empty() {
            true => String::new(),
            false => format!(" ({})", values.join(", ")),
        }
    }
}

/// The instances of a scene: a grid of axes, a list of samples, or the one base case.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SweptAxes {
    pub axes: Vec<Axis>,
    pub layout: Layout,
    /// Where the last axis is a curve's, along which the state is carried.
    pub curve: Option<CurveSpec>,
}

/// `[curve]`: the last axis of the sweep is followed from its first point to its last.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CurveSpec {
    /// And back: the axis before it, of length 2, tells the way.
    pub both: bool,
}

/// How a sweep's axes make instances.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Layout {
    /// Every combination; the last axis runs fastest. No axis: one instance.
    #[default]
    Grid,
    /// All axes have one length; instance i takes the i-th value of each.
    List,
}

impl SweptAxes {
    /// Lengths of the axes of a grid; empty for a list.
    pub fn shape(&self) -> Vec<usize> {
        match self.layout {
            Layout::Grid => self.axes.iter().map(|axis| axis.values.len()).collect(),
            Layout::List => Vec::new(),
        }
    }
}

/// One swept quantity, or several that vary together.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Axis {
    /// Path in the scene file, as `sample.youngs_modulus`; of what is no quantity (the ways along a curve, quantities that
    /// vary together) the place where the scene says it.
    pub path: String,
    /// Name in the results file: the last two words of the path joined with `_`.
    pub name: String,
    /// What it is, for a label: `sample Young's modulus`.
    pub long_name: String,
    /// SI unit as the results file writes it: `Pa`, `J/m^2`, `m`, `1`.
    pub units: String,
    /// True where the values are spaced evenly in the logarithm.
    pub log: bool,
    /// SI values; 0, 1 and so on where words stand for them.
    pub values: Arc<Vec<f64>>,
    /// What each value is called: a law, a way along a curve, a label. Empty for a quantity.
    pub words: Vec<String>,
    /// Quantities that vary together along this axis, each with as many values.
    pub columns: Vec<Axis>,
}

impl Axis {
    /// What stands at this place, for people.
    fn written(&self, at: usize) -> String {
        match Address::find(&self.path) {
            Some(address) => format!("{} = {}", self.path, address.shown(self.values[at])),
            None => match self.words.get(at) {
                Some(word) => format!("{} = \"{word}\"", self.name),
                None => format!("{} = {at}", self.name),
            },
        }
    }
}

/// `[run] start`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Start {
    /// The free oscillation is already steady; the sample appears at the top of a swing.
    Steady,
    /// Zero initial conditions.
    Rest,
}

/// `[run] steady`: how the periodic state is come by.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Steady {
    /// Periods pass until it has settled.
    #[default]
    Wait,
    /// It is searched for as a fixed point of the period map; what cannot be found so is waited for.
    Search,
}

/// `[run]`
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    pub start: Start,
    pub steady: Steady,
    /// Whether a search looks for a second periodic state beside the first.
    pub both_branches: bool,
    /// Drive periods in all.
    pub periods: u32,
    /// The last so many of them are measured; 1 ..= periods.
    pub measure: u32,
    /// Relative error asked for.
    pub accuracy: f64,
    /// Lever modes to keep, overriding the plan.
    pub modes: Option<usize>,
    /// Steps per drive period, overriding the plan.
    pub steps_per_period: Option<u32>,
}

/// `[output]`
#[derive(Clone, Debug, PartialEq)]
pub struct Output {
    /// In the order asked for, without repeats.
    pub observables: Vec<Observable>,
    pub waveforms: Option<WaveformRequest>,
    /// Instances whose spectra are kept, each below the scene's number of instances.
    pub spectra: Option<Vec<usize>>,
}

/// `[output] waveforms`
#[derive(Clone, Debug, PartialEq)]
pub struct WaveformRequest {
    /// Instance numbers, each below the scene's number of instances.
    pub instances: Vec<usize>,
    pub samples_per_period: u32,
    /// The last so many periods of the run.
    pub periods: u32,
}

impl SweptAxes {
    /// Everything that varies: the axes, and the quantities that vary together along one.
    pub fn quantities(&self) -> impl Iterator<Item = &Axis> {
        self.axes.iter().flat_map(|axis| std::iter::once(axis).chain(&axis.columns))
    }

    /// Number of instances; 1 without a sweep.
    pub fn len(&self) -> usize {
        match self.layout {
            Layout::Grid => self.axes.iter().map(|axis| axis.values.len()).product(),
            Layout::List => self.axes.first().map_or(1, |axis| axis.values.len()),
        }
    }

    /// A sweep without instances does not exist.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Each axis' value index in instance `index` (row-major for a grid).
    pub fn indices(&self, index: usize) -> Vec<usize> {
        match self.layout {
            Layout::List => vec![index; self.axes.len()],
            Layout::Grid => {
                let mut rest = index;
                let mut indices = vec![0; self.axes.len()];
                for (slot, axis) in indices.iter_mut().zip(&self.axes).rev() {
                    *slot = rest % axis.values.len();
                    rest /= axis.values.len();
                }
                indices
            }
        }
    }
}

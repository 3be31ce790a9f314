//! The results file: HDF5 that netCDF-4 readers open with labelled axes and units.
//!
//! [`Writer`] reserves the place before a run and puts the finished file there in one step, so that the
//! final name never stands for half a file; [`read`] gives back the same [`Results`].

// The plain data of this file needs no HDF5; reading and writing it does.
#[cfg(feature = "hdf5")]
mod hdf5_file;
mod row_tables;
mod variable_source;

#[cfg(feature = "hdf5")]
pub use hdf5_file::{
    ArrayLayout, ArrayRole, ArrayValues, AttributeValue, ExistingFile, FileLayout, GroupLayout, Hdf5Image,
    InstanceColumn, Journal, RecordKind, RunFile, StoreError, Writer, history_of, laid_out, now,
    open_journal, partial_path, read, same_file, scene_of,
};
pub use row_tables::{RowColumn, Spectra, Waveforms};
pub use variable_source::{StateSet, Unread, VariableSource};

use std::sync::Arc;

/// Root attributes the store writes itself; in [`Results::attributes`] they are passed over, except that
/// a `history` given there replaces the one made here.
pub const OWN_ATTRIBUTES: [&str; 4] = ["title", "Conventions", "history", "checksums"];

/// Everything a results file holds, as plain data. Written by [`Writer`], read back by [`read`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Results {
    pub title: String,
    /// Swept axes; dimensions of a grid, or variables over `instance` for a list.
    pub axes: Vec<Coordinate>,
    /// True for a list of samples (dimension `instance`), false for a grid.
    pub list: bool,
    pub variables: Vec<Variable>,
    /// One code per instance, see [`crate::observe::Status`].
    pub status: Vec<u8>,
    pub steps_per_period: Vec<u32>,
    /// Further words about each instance, as the law it uses.
    pub flags: Vec<Flags>,
    pub waveforms: Option<Waveforms>,
    pub spectra: Option<Spectra>,
    /// Static curves of the contact, any number of them.
    pub force_curves: Vec<ForceCurve>,
    /// Instances redone by the reference integrator.
    pub audit: Option<AuditTable>,
    /// Second periodic states beside the first, where they were looked for.
    pub other_branch: Option<BranchTable>,
    /// Names of variables over the instances, each with a sentence about it (attribute `comment`).
    pub comments: Vec<(String, String)>,
    /// Program, device, times: root attributes in this order, all of them short.
    pub attributes: Vec<(String, Attribute)>,
    /// Long texts, as the scene and the plan: attributes of group `provenance` in this order.
    pub provenance: Vec<(String, String)>,
}

/// A labelled axis.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Coordinate {
    pub name: String,
    pub units: String,
    pub long_name: String,
    /// Path of the quantity in the scene, as `instrument.tip.radius`; empty for what is no quantity of a scene.
    pub scene_path: String,
    /// What the values 0, 1 and so on mean; empty for a quantity.
    pub words: Vec<String>,
    /// Shared with whoever made them: those of a list are as many as the instances.
    pub values: Arc<Vec<f64>>,
    /// Quantities that vary together along this axis, which the words are labels of. Those have no columns themselves.
    pub columns: Vec<Coordinate>,
}

/// An f64 variable over the instances, with further dimensions behind them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Variable {
    pub name: String,
    pub units: String,
    pub long_name: String,
    /// `Some(n)`: a last dimension `harmonic` of length n, coordinate 1..=n.
    pub harmonics: Option<usize>,
    /// On what the errors of an observable count, in words; empty for what is no observable.
    pub error_scale: String,
    /// Row-major, instance first.
    pub data: Vec<f64>,
}

/// A variable as it lies in memory, see [`Results::observable`].
#[derive(Clone, Debug, PartialEq)]
pub struct Array<'a> {
    /// Row-major; SI units, phases in degree; NaN where there is no number.
    pub values: &'a [f64],
    /// Lengths of the axes, and of the harmonics where there are some; of a list the number of its instances.
    pub shape: Vec<usize>,
    /// The swept axes in order; of a list all have the list's length and share its one dimension.
    pub axes: &'a [Coordinate],
    pub units: &'a str,
    pub long_name: &'a str,
}

/// A u8 variable over the instances whose values stand for words.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Flags {
    pub name: String,
    pub long_name: String,
    /// Single words: of codes 0, 1, 2, ..., or of bits 1, 2, 4, ...
    pub meanings: Vec<String>,
    /// True where each bit is a flag of its own (`flag_masks`), false for codes (`flag_values`).
    pub bits: bool,
    pub data: Vec<u8>,
}

/// Root attribute.
#[derive(Clone, Debug, PartialEq)]
pub enum Attribute {
    Text(String),
    Number(f64),
}

/// One static force-indentation curve, a row of group `force_curves`. The three lists have one length.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ForceCurve {
    /// Instance number.
    pub instance: u64,
    /// Contact law, one word: `jkr`.
    pub law: String,
    /// `approach` or `retract`.
    pub branch: String,
    /// m
    pub indentation: Vec<f64>,
    /// N
    pub force: Vec<f64>,
    /// m
    pub contact_radius: Vec<f64>,
}

/// Code of [`BranchTable::status`] where there is no second state.
pub const NO_STATE: u8 = u8::MAX;

/// Group `other_branch`: a second state of each instance, over all instances and with the dimensions of the first ones.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BranchTable {
    /// NaN where there is no second state.
    pub variables: Vec<Variable>,
    /// One code per instance, see [`crate::observe::Status`], and [`NO_STATE`].
    pub status: Vec<u8>,
    /// 0 where there is no second state.
    pub steps_per_period: Vec<u32>,
    pub flags: Vec<Flags>,
}

/// Group `audit`: what the reference engine finds for some of the instances, and the errors of the run against it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct AuditTable {
    /// Instance numbers.
    pub instances: Vec<u64>,
    /// What the reference finds, over `instances` instead of all instances.
    pub variables: Vec<Variable>,
    /// The observables whose errors there are.
    pub observables: Vec<String>,
    /// Errors of the run on the scale of accuracy, of all observables of the first instance, then of the next.
    pub errors: Vec<f64>,
    /// Over `instances`.
    pub flags: Vec<Flags>,
}

impl Results {
    /// Lengths of the dimensions the variables stand over: none for a single case, one for a list,
    /// one for each axis of a grid.
    pub fn shape(&self) -> Vec<usize> {
        if self.list {
            vec![self.status.len()]
        } else {
            self.axes.iter().map(|axis| axis.values.len()).collect()
        }
    }

    /// An observable, or any other variable over the instances, by its name in the file.
    pub fn observable(&self, name: &str) -> Option<Array<'_>> {
        let Variable { units, long_name, harmonics, data, .. } =
            self.variables.iter().find(|one| one.name == name)?;
        let mut shape = self.shape();
        shape.extend(*harmonics);
        Some(Array { values: data, shape, axes: &self.axes, units, long_name })
    }

    /// Writes them as a results file. What already stands at `path` is replaced if it is of the same scene, or if
    /// `overwrite` says so.
    ///
    /// # Errors
    /// See [`StoreError`].
    #[cfg(feature = "hdf5")]
    pub fn write(&self, path: &std::path::Path, overwrite: bool) -> Result<(), StoreError> {
        let mut writer = Writer::create(path, self.text("scene").unwrap_or_default(), overwrite)?;
        writer.write(self)?;
        writer.finish()
    }

    /// The text of a root attribute or of one of group `provenance`.
    pub fn text(&self, name: &str) -> Option<&str> {
        let root = self.attributes.iter().find_map(|(key, value)| match value {
            Attribute::Text(text) if key == name => Some(text.as_str()),
            _ => None,
        });
        root.or_else(|| self.provenance.iter().find(|(key, _)| key == name).map(|(_, text)| text.as_str()))
    }
}

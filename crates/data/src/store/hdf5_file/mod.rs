//! Reading and writing of results files, and the journal of a run.

mod bytes;
mod checksums;
mod consistency;
mod dimension_scales;
mod existing_file;
mod hdf5_image;
mod heap_check;
mod history;
mod journal;
mod lock;
mod output_place;
mod partial_file;
mod results_reader;
mod run_file;
mod share;
mod source;
mod store_error;
mod write;

pub use existing_file::{ExistingFile, same_file};
pub use hdf5_image::Hdf5Image;
pub use history::now;
pub use journal::{Journal, RecordKind};
pub use output_place::Writer;
pub use partial_file::partial_path;
pub use results_reader::{history_of, read, scene_of};
pub use run_file::RunFile;
pub use share::open as open_journal;
pub use store_error::StoreError;
pub use write::{
    ArrayLayout, ArrayRole, ArrayValues, AttributeValue, FileLayout, GroupLayout, InstanceColumn, laid_out,
};

use super::variable_source::States;
use super::{
    Attribute, AuditTable, BranchTable, Coordinate, Flags, ForceCurve, NO_STATE, OWN_ATTRIBUTES, Results,
    RowColumn, Spectra, StateSet, Unread, Variable, VariableSource, Waveforms,
};

/// Variable of group `audit` with all errors, and the dimension of it that observables stand along.
const ERROR: &str = "error";
const OBSERVABLE: &str = "observable";

/// The group of long texts.
const PROVENANCE: &str = "provenance";
/// Its text that the store writes itself: the version of the HDF5 library.
const HDF5_VERSION: &str = "hdf5_version";

/// Groups of numbers that every file has; one may hold nothing.
const GROUPS: [&str; 5] = ["waveforms", "spectra", "force_curves", "audit", "other_branch"];

/// Names that no axis and no variable may take.
fn reserved<'a>() -> impl Iterator<Item = &'a str> {
    ["status", "steps_per_period", "instance", "harmonic", PROVENANCE].into_iter().chain(GROUPS)
}

/// Attribute of an axis along which quantities vary: the names of their variables.
const COLUMNS: &str = "quantities";

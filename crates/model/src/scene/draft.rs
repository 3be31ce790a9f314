//! What is read of a scene so far, and where it stands.

use super::Drawn;
use super::levers::MakersLever;
use super::params::Params;
use super::quantities::QUANTITIES;
use super::scene_error::Faults;
use std::ops::Range;
use std::path::PathBuf;

/// Something the scene says: in a section, or as an axis of its sweep.
#[derive(Clone, Debug)]
pub(super) struct Said {
    pub path: String,
    pub key: Range<usize>,
    pub swept: bool,
}

/// Paths of quantities with their values in SI units, all as many.
pub type SampleArrays = Vec<(String, Vec<f64>)>;

/// Arrays of the caller, and the line of the scene that tells of them.
#[derive(Debug)]
pub(super) struct GivenSamples {
    pub arrays: SampleArrays,
    pub place: Range<usize>,
}

/// The scene while it is being read.
#[derive(Debug, Default)]
pub(super) struct Draft {
    pub params: Params,
    /// Every quantity, list or choice the scene gives, in the order read; axes last.
    pub said: Vec<Said>,
    /// The places of the listed lever modes.
    pub modes: Vec<Range<usize>>,
    /// The maker's lever that the scene names as its preset, and where.
    pub lever: Option<(&'static MakersLever, Range<usize>)>,
    /// Whether the scene names the paper's preset, or has a section for the rod.
    pub names_rod: bool,
    /// Where files that the scene names are looked for.
    pub folder: PathBuf,
    pub drawn: Drawn,
    /// Samples of the caller.
    pub given: Option<GivenSamples>,
    pub faults: Faults,
}

/// The quantities a section has, by their last word.
pub(super) fn keys_of(section: &str) -> Vec<&'static str> {
    let keys = QUANTITIES.iter().filter_map(|quantity| quantity.path.rsplit_once('.'));
    keys.filter(|(home, key)| *home == section && *key != "#").map(|(_, key)| key).collect()
}

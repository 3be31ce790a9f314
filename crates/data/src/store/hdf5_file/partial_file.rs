//! The file that a run writes before its results file is whole.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

/// What a partial file begins with while it is being written, in place of the first bytes of HDF5: one that is torn is
/// known as such.
pub(super) const TORN: [u8; 8] = *b"afmsweep";

/// The name under which the results file `path` is written before it is whole.
pub fn partial_path(path: &Path) -> PathBuf {
    let mut name = path.file_name().map_or_else(OsString::new, OsString::from);
    name.push(".partial");
    path.with_file_name(name)
}

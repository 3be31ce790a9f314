//! The file of a share of a run: an HDF5 file around the journal of its portions, which `afmsweep merge` takes.

use super::image::{Image, in_memory};
use super::labels::{self, read_text};
use super::write::scene_group;
use super::{Journal, StoreError, journal};
use hdf5::File;
use std::path::Path;

/// The dataset that holds the journal.
pub(super) const JOURNAL: &str = "journal";

/// Such a file in memory.
pub(super) fn image(journal: &[u8], title: &str, scene_text: &str, path: &Path) -> Result<Image, StoreError> {
    let build = || -> hdf5::Result<Image> {
        let file = in_memory()?;
        labels::text(&file, "title", title)?;
        labels::text(&file, "comment", "a share of a run: afmsweep merge makes results of all shares")?;
        scene_group(&file, scene_text)?;
        let builder = file.new_dataset::<u8>().shape([journal.len()]).obj_track_times(false);
        let builder = builder.chunk([journal.len().clamp(1, 1 << 20)]).fletcher32();
        builder.create(JOURNAL)?.write_raw(journal)?;
        Image::of(file)
    };
    build().map_err(|source| StoreError::Hdf5 { path: path.to_path_buf(), doing: "lay out".into(), source })
}

/// The journal in a file: that of a run that goes on or was broken off, or a finished share's.
///
/// # Errors
/// See [`StoreError`].
pub fn open(path: &Path) -> Result<Journal, StoreError> {
    if journal::is_at(path) {
        return journal::open(path);
    }
    let metadata = std::fs::metadata(path).map_err(|e| match e.kind() {
        std::io::ErrorKind::NotFound => StoreError::Missing { path: path.to_path_buf() },
        _ => StoreError::io(path, "read", e),
    })?;
    let foreign = |why: &str| StoreError::Foreign { path: path.to_path_buf(), why: why.into() };
    if !metadata.is_file() {
        return Err(foreign("it is no ordinary file"));
    }
    let damaged = |why: String| StoreError::Damaged { path: path.to_path_buf(), why };
    let file = File::open(path).map_err(|_| foreign("it is no HDF5 file, or cut short"))?;
    let Ok(dataset) = file.dataset(JOURNAL) else {
        return Err(foreign(match read_text(&file, "title") {
            Some(_) => "it holds whole results, not a share of a run",
            None => "it holds no share of a run",
        }));
    };
    if dataset.size() as u64 > metadata.len() {
        return Err(damaged("its journal claims to be longer than the file".into()));
    }
    let bytes = dataset.read_raw::<u8>().map_err(|e| damaged(e.to_string()))?;
    Journal::read(bytes).map_err(damaged)
}

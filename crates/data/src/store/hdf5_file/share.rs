//! The file of a share of a run: an HDF5 file around the journal of its portions, which `afmsweep merge` takes.

use super::bytes::Bytes;
use super::dimension_scales::{self, read_text};
use super::hdf5_image::{Hdf5Image, in_memory};
use super::write::scene_group;
use super::{Journal, StoreError, journal};
use hdf5::File;
use std::io::Read;
use std::path::Path;

/// What ends the file of a share, beyond what HDF5 knows of it, before the sum of all bytes before these. Nobody adds to a
/// share, and of spoilt bytes the library makes what it likes, so none is given to it.
const SEAL: [u8; 8] = *b"afmshare";

/// The end of a file that begins with these bytes.
pub(super) fn seal(bytes: &[u8]) -> Vec<u8> {
    [&SEAL[..], &crc32fast::hash(bytes).to_le_bytes()].concat()
}

/// Whether the bytes of a file are those that its end was written for; none where it has no such end.
fn is_as_written(path: &Path) -> std::io::Result<Option<bool>> {
    let mut file = std::fs::File::open(path)?;
    let Some(length) = file.metadata()?.len().checked_sub(SEAL.len() as u64 + 4) else { return Ok(None) };
    let (mut sum, mut block, mut left) = (crc32fast::Hasher::new(), vec![0; 1 << 16], length);
    while left > 0 {
        let part = &mut block[..left.min(1 << 16) as usize];
        file.read_exact(part)?;
        sum.update(part);
        left -= part.len() as u64;
    }
    let mut end = Vec::new();
    file.read_to_end(&mut end)?;
    Ok(end.strip_prefix(&SEAL).map(|told| told == sum.finalize().to_le_bytes()))
}

/// The dataset that holds the journal.
pub(super) const JOURNAL: &str = "journal";

/// Such a file in memory.
pub(super) fn image(
    journal: &[u8],
    title: &str,
    scene_text: &str,
    path: &Path,
) -> Result<Hdf5Image, StoreError> {
    let build = || -> hdf5::Result<Hdf5Image> {
        let file = in_memory()?;
        dimension_scales::text(&file, "title", title)?;
        dimension_scales::text(
            &file,
            "comment",
            "a share of a run: afmsweep merge makes results of all shares",
        )?;
        scene_group(&file, scene_text)?;
        let builder = file.new_dataset::<u8>().shape([journal.len()]).obj_track_times(false);
        let builder = builder.chunk([journal.len().clamp(1, 1 << 20)]).fletcher32();
        builder.create(JOURNAL)?.write_raw(journal)?;
        Hdf5Image::of(file)
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
    let foreign = |why| StoreError::foreign(path, why);
    if !metadata.is_file() {
        return Err(foreign("it is no ordinary file"));
    }
    let damaged = |why: &str| StoreError::damaged(path, why);
    let as_written = is_as_written(path).map_err(|e| StoreError::io(path, "read", e))?;
    if as_written == Some(false) {
        return Err(damaged("its bytes are not what the run wrote"));
    }
    let file = File::open(path).map_err(|_| foreign("it is no HDF5 file, or cut short"))?;
    let Ok(dataset) = file.dataset(JOURNAL) else {
        return Err(match read_text(&file, "title") {
            Some(_) => StoreError::NoShare { path: path.to_path_buf() },
            None => foreign("it holds no share of a run"),
        });
    };
    if as_written.is_none() {
        return Err(damaged("its end is not what the run wrote"));
    }
    if dataset.size() as u64 > metadata.len() {
        return Err(damaged("its journal claims to be longer than the file"));
    }
    Journal::of(Bytes::Dataset(dataset)).map_err(|why| damaged(&why))
}

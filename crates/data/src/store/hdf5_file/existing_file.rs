//! What stands at the place of a results file: whether it may be replaced, and what the new file takes from it.

use super::partial_file::TORN;
use super::{StoreError, journal, results_reader};
use std::fs::{self, File, Metadata};
use std::io::{ErrorKind, Read};
use std::path::{Path, PathBuf};

/// What is to become of what an earlier run has left at the place of the results.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ExistingFile {
    /// Whole results of the same scene may be replaced, and what holds nothing; else the run is refused.
    Kept,
    /// As `Kept`; the journal of a run of the same scene is gone on with.
    GoneOnWith,
    /// Whatever it is, it is replaced.
    Replaced,
}

impl From<bool> for ExistingFile {
    fn from(overwrite: bool) -> Self {
        if overwrite { Self::Replaced } else { Self::Kept }
    }
}

/// The file that a symbolic link leads to; anything else is itself.
pub(super) fn follow(path: &Path) -> Result<PathBuf, StoreError> {
    if !fs::symlink_metadata(path).is_ok_and(|metadata| metadata.is_symlink()) {
        return Ok(path.to_path_buf());
    }
    path.canonicalize().map_err(|e| match e.kind() {
        ErrorKind::NotFound => StoreError::DeadLink { path: path.to_path_buf() },
        _ => StoreError::io(path, "follow", e),
    })
}

/// Refuses a place whose occupant may not be replaced.
pub(super) fn check_occupant(path: &Path, scene_text: &str, overwrite: bool) -> Result<(), StoreError> {
    let metadata = match fs::metadata(path) {
        Ok(metadata) => metadata,
        Err(e) if e.kind() == ErrorKind::NotFound => return Ok(()),
        Err(e) => return Err(StoreError::io(path, "look at", e)),
    };
    if metadata.is_dir() {
        return Err(StoreError::Folder { path: path.to_path_buf() });
    }
    if !metadata.is_file() {
        return Err(StoreError::Special { path: path.to_path_buf() });
    }
    if overwrite {
        return Ok(());
    }
    match results_reader::scene_of(path) {
        Ok(scene) if scene == scene_text => Ok(()),
        Ok(_) => Err(StoreError::OtherScene { path: path.to_path_buf() }),
        Err(StoreError::Foreign { why, .. } | StoreError::Damaged { why, .. }) => {
            Err(StoreError::Occupied { path: path.to_path_buf(), why })
        }
        Err(error) => Err(error),
    }
}

/// Refuses a partial file that is not left over from a run of this scene: links always, all else unless `earlier`
/// says so. Empty files and those that a run was killed while writing hold nothing; a journal of the same scene that does
/// is for a run that goes on with it.
pub(super) fn may_be_taken(
    partial: &Path,
    found: &Metadata,
    scene_text: &str,
    earlier: ExistingFile,
) -> Result<(), StoreError> {
    let refuse = |why: &str| StoreError::PartialTaken { path: partial.to_path_buf(), why: why.into() };
    if found.is_symlink() {
        return Err(StoreError::PartialLink { path: partial.to_path_buf() });
    }
    if !found.is_file() {
        return Err(StoreError::Special { path: partial.to_path_buf() });
    }
    if has_other_names(found) {
        return Err(StoreError::PartialLink { path: partial.to_path_buf() });
    }
    if earlier == ExistingFile::Replaced || found.len() == 0 || is_torn(partial) {
        return Ok(());
    }
    if journal::is_at(partial) {
        let journal = journal::open(partial)?;
        let kept = journal.kinds().filter(|kind| *kind == journal::RecordKind::Portion).count();
        return match journal.scene() {
            Some(scene) if scene != scene_text => Err(refuse("it holds a run of another scene")),
            None => Err(refuse("its journal names no scene")),
            Some(_) if earlier == ExistingFile::GoneOnWith || kept == 0 => Ok(()),
            Some(_) => Err(StoreError::Unresumed { partial: partial.to_path_buf(), kept }),
        };
    }
    match results_reader::scene_of(partial) {
        Ok(scene) if scene == scene_text => Ok(()),
        Ok(_) => Err(refuse("it holds results of another scene")),
        Err(StoreError::Foreign { why, .. } | StoreError::Damaged { why, .. }) => Err(refuse(&why)),
        Err(StoreError::Partial { .. }) => Err(refuse("it is cut short, and its scene cannot be told")),
        Err(error) => Err(error),
    }
}

/// True if a run was killed while it wrote the file.
fn is_torn(partial: &Path) -> bool {
    let mut start = [0; TORN.len()];
    File::open(partial).and_then(|mut file| file.read_exact(&mut start)).is_ok() && start == TORN
}

/// True if two paths lead to one file, by links of either kind too; a file that is not there is no other's.
pub fn same_file(a: &Path, b: &Path) -> bool {
    match (fs::metadata(a), fs::metadata(b)) {
        (Ok(x), Ok(y)) => same(&x, &y).unwrap_or_else(|| a.canonicalize().ok() == b.canonicalize().ok()),
        _ => false,
    }
}

/// True if the open file is the one that `path` names, and no link to it.
pub(super) fn is_at(file: &File, path: &Path) -> bool {
    match (file.metadata(), fs::symlink_metadata(path)) {
        // Where files have no numbers, an open one is not renamed away by others.
        (Ok(open), Ok(named)) => !named.is_symlink() && same(&open, &named).unwrap_or(true),
        _ => false,
    }
}

/// Whether two are one file, where the system numbers its files.
#[cfg(unix)]
fn same(a: &Metadata, b: &Metadata) -> Option<bool> {
    use std::os::unix::fs::MetadataExt;
    Some((a.dev(), a.ino()) == (b.dev(), b.ino()))
}

#[cfg(not(unix))]
fn same(_a: &Metadata, _b: &Metadata) -> Option<bool> {
    None
}

#[cfg(unix)]
fn has_other_names(found: &Metadata) -> bool {
    std::os::unix::fs::MetadataExt::nlink(found) > 1
}

#[cfg(not(unix))]
fn has_other_names(_found: &Metadata) -> bool {
    false
}

/// Gives the file the owner and the permissions of the one it is to replace; while it is `unfinished` its owner may
/// always write it. Where the group cannot be kept, the new one may do nothing: results that were private stay so.
#[cfg(unix)]
pub(super) fn give_rights(file: &File, replaced: &Path, unfinished: bool) {
    use std::os::unix::fs::{MetadataExt, PermissionsExt, fchown};
    let (Ok(old), Ok(new)) = (fs::metadata(replaced), file.metadata()) else { return };
    let mut mode = old.mode() & 0o777;
    if (old.uid(), old.gid()) != (new.uid(), new.gid()) {
        let kept = fchown(file, Some(old.uid()), Some(old.gid())).is_ok()
            || old.gid() == new.gid()
            || fchown(file, None, Some(old.gid())).is_ok();
        if !kept {
            mode &= !0o070;
        }
    }
    if unfinished {
        mode |= 0o600;
    }
    // A disk that knows no permissions has none to keep.
    let _ = file.set_permissions(fs::Permissions::from_mode(mode));
}

#[cfg(not(unix))]
pub(super) fn give_rights(_file: &File, _replaced: &Path, _unfinished: bool) {}

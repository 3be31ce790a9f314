//! Where a results file goes: checked and reserved before the run, filled and renamed after it.

use super::{Results, StoreError, read, write};
use std::ffi::OsString;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{Seek, Write};
use std::path::{Path, PathBuf};

/// A reserved place for one results file.
///
/// The file is written to a neighbour with the ending `.partial` and renamed by [`Writer::finish`].
/// The neighbour is locked while the writer lives; a crashed run leaves it unlocked, and the next run
/// to the same place takes it over.
#[derive(Debug)]
pub struct Writer {
    path: PathBuf,
    partial: PathBuf,
    scene_text: String,
    overwrite: bool,
    file: File,
    written: bool,
    finished: bool,
}

/// The name under which the results file `path` is written before it is whole.
pub fn partial_path(path: &Path) -> PathBuf {
    let mut name = path.file_name().map_or_else(OsString::new, OsString::from);
    name.push(".partial");
    path.with_file_name(name)
}

impl Writer {
    /// Reserves `path` for results of the scene `scene_text`; made to be called before a long run.
    ///
    /// Creates missing parent folders. A file already there may be replaced if it holds results of the
    /// same scene, or if `overwrite` says so.
    pub fn create(path: &Path, scene_text: &str, overwrite: bool) -> Result<Self, StoreError> {
        if path.file_name().is_none() || path.as_os_str().is_empty() {
            return Err(match path.is_dir() {
                true => StoreError::Folder { path: path.to_path_buf() },
                false => StoreError::Nameless { path: path.to_path_buf() },
            });
        }
        check_occupant(path, scene_text, overwrite)?;
        if let Some(parent) = path.parent().filter(|parent| !parent.as_os_str().is_empty()) {
            fs::create_dir_all(parent).map_err(|e| StoreError::io(parent, "make the folder", e))?;
        }
        let partial = partial_path(path);
        let file = reserve(path, &partial)?;
        Ok(Self {
            path: path.to_path_buf(),
            partial,
            scene_text: scene_text.to_owned(),
            overwrite,
            file,
            written: false,
            finished: false,
        })
    }

    /// Writes all of `results` to the partial file, in place of what an earlier call wrote.
    pub fn write(&mut self, results: &Results) -> Result<(), StoreError> {
        let image = write::image(results, &self.scene_text, &self.partial)?;
        let partial = &self.partial;
        let failed = |e| StoreError::io(partial, "write", e);
        // From here on the partial file holds something, if only the part that fitted on the disk.
        self.written = true;
        self.file.rewind().map_err(failed)?;
        self.file.set_len(0).map_err(failed)?;
        self.file.write_all(&image).map_err(failed)
    }

    /// Makes the partial file the results file, in one step, once it is safely on the disk.
    pub fn finish(mut self) -> Result<(), StoreError> {
        if !self.written {
            return Err(StoreError::inconsistent("the file was finished before anything was written to it"));
        }
        // The place was free before the run; something may have been put there since.
        check_occupant(&self.path, &self.scene_text, self.overwrite)?;
        self.file.sync_all().map_err(|e| StoreError::io(&self.partial, "write", e))?;
        fs::rename(&self.partial, &self.path).map_err(|e| StoreError::io(&self.path, "put in place", e))?;
        self.finished = true;
        // The new name should outlast a power cut too; where a folder cannot be synced, nothing is lost
        // but that.
        let parent = self.path.parent().filter(|parent| !parent.as_os_str().is_empty());
        if let Ok(folder) = File::open(parent.unwrap_or(Path::new("."))) {
            let _ = folder.sync_all();
        }
        Ok(())
    }

    /// Where the results are until [`Writer::finish`].
    pub fn partial(&self) -> &Path {
        &self.partial
    }
}

impl Drop for Writer {
    fn drop(&mut self) {
        if !self.finished && !self.written {
            // An empty file tells nobody anything; if it cannot be removed, the next run takes it over.
            let _ = fs::remove_file(&self.partial);
        }
    }
}

/// Refuses a place whose occupant may not be replaced.
fn check_occupant(path: &Path, scene_text: &str, overwrite: bool) -> Result<(), StoreError> {
    let metadata = match fs::metadata(path) {
        Ok(metadata) => metadata,
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => return Ok(()),
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
    match read::scene_of(path) {
        Ok(scene) if scene == scene_text => Ok(()),
        Ok(_) => Err(StoreError::OtherScene { path: path.to_path_buf() }),
        Err(StoreError::Foreign { why, .. } | StoreError::Damaged { why, .. }) => {
            Err(StoreError::Occupied { path: path.to_path_buf(), why })
        }
        Err(error) => Err(error),
    }
}

/// Opens and locks the partial file, empty.
fn reserve(path: &Path, partial: &Path) -> Result<File, StoreError> {
    let failed = |e| StoreError::io(partial, "create", e);
    let busy = || StoreError::Busy { path: path.to_path_buf(), partial: partial.to_path_buf() };
    if fs::metadata(partial).is_ok_and(|metadata| !metadata.is_file()) {
        return Err(StoreError::Special { path: partial.to_path_buf() });
    }
    // Another run may rename or remove the file between our opening and locking it. The lock then holds
    // a file that is no longer the partial one, and the next try opens a new one.
    for _ in 0..8 {
        let file =
            OpenOptions::new().write(true).create(true).truncate(false).open(partial).map_err(failed)?;
        match file.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => return Err(busy()),
            // Some network disks know no locks; then two runs at once are the user's to avoid.
            Err(TryLockError::Error(e)) if e.kind() == std::io::ErrorKind::Unsupported => {}
            Err(TryLockError::Error(e)) => return Err(failed(e)),
        }
        if is_at(&file, partial) {
            file.set_len(0).map_err(failed)?;
            return Ok(file);
        }
    }
    Err(busy())
}

/// True if the open file is the one that `path` names.
#[cfg(unix)]
fn is_at(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    match (file.metadata(), fs::metadata(path)) {
        (Ok(open), Ok(named)) => (open.dev(), open.ino()) == (named.dev(), named.ino()),
        _ => false,
    }
}

/// Elsewhere an open file is not renamed away by others.
#[cfg(not(unix))]
fn is_at(_file: &File, path: &Path) -> bool {
    path.exists()
}

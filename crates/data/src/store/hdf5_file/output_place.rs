//! Where a results file goes: checked and reserved before the run, filled and renamed after it.

use super::existing_file::{ExistingFile, check_occupant, follow, give_rights, is_at, may_be_taken};
use super::hdf5_image::Hdf5Image;
use super::partial_file::{TORN, partial_path};
use super::{Results, StoreError, write};
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{ErrorKind, Read, Seek, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// A reserved place for one results file.
///
/// The file is written to a neighbour with the ending `.partial` and renamed by [`Writer::finish`].
/// The neighbour is locked while the writer lives; a crashed run leaves it unlocked, and the next run of the same scene
/// to the same place takes it over. What it holds then stays until there is something to write.
#[derive(Debug)]
pub struct Writer {
    path: PathBuf,
    partial: PathBuf,
    scene_text: String,
    overwrite: bool,
    file: File,
    /// The folder that had to be made.
    made: Option<PathBuf>,
    /// Whether the partial file holds something: of an earlier run, or of this one.
    holds: bool,
    written: bool,
    finished: bool,
    /// When the partial file was last seen to be on the disk.
    synced: Option<Instant>,
}

/// Between two looks whether a journal is on the disk: that takes some ten milliseconds, as many portions do.
const SYNC: Duration = Duration::from_secs(1);

/// True for `folder/` and `folder/.`, whether or not there is such a folder.
fn names_a_folder(path: &Path) -> bool {
    let text = path.as_os_str().as_encoded_bytes();
    let text = text.strip_suffix(b".").unwrap_or(text);
    text.last().is_some_and(|last| std::path::is_separator(char::from(*last)))
}

impl Writer {
    /// Reserves `path` for results of the scene `scene_text`; made to be called before a long run.
    ///
    /// Creates missing parent folders, and follows `path` if it is a symbolic link. A file already there may be
    /// replaced if it holds results of the same scene, or if `overwrite` says so; so may what stands at the partial
    /// name, but never through a link.
    pub fn create(path: &Path, scene_text: &str, overwrite: bool) -> Result<Self, StoreError> {
        Self::reserve(path, scene_text, overwrite.into())
    }

    /// As [`Writer::create`], with more to say of what is there.
    pub(super) fn reserve(path: &Path, scene_text: &str, earlier: ExistingFile) -> Result<Self, StoreError> {
        let overwrite = earlier == ExistingFile::Replaced;
        if path.as_os_str() == "-" {
            return Err(StoreError::Stream);
        }
        if names_a_folder(path) {
            return Err(StoreError::Folder { path: path.to_path_buf() });
        }
        if path.file_name().is_none() || path.as_os_str().is_empty() {
            return Err(match path.is_dir() {
                true => StoreError::Folder { path: path.to_path_buf() },
                false => StoreError::Nameless { path: path.to_path_buf() },
            });
        }
        let path = follow(path)?;
        check_occupant(&path, scene_text, overwrite)?;
        let mut made = None;
        if let Some(parent) = path.parent().filter(|parent| !parent.as_os_str().is_empty()) {
            made = (!parent.exists()).then(|| parent.to_path_buf());
            fs::create_dir_all(parent).map_err(|e| StoreError::io(parent, "make the folder", e))?;
        }
        let partial = partial_path(&path);
        let (file, holds) = reserve(&path, &partial, scene_text, earlier)?;
        give_rights(&file, &path, true);
        Ok(Self {
            path,
            partial,
            scene_text: scene_text.to_owned(),
            overwrite,
            file,
            made,
            holds,
            written: false,
            finished: false,
            synced: None,
        })
    }

    /// Writes all of `results` to the partial file, in place of what an earlier call wrote.
    pub fn write(&mut self, results: &Results) -> Result<(), StoreError> {
        let image = write::image(results, &self.scene_text, &self.partial)?;
        self.write_image(&image)
    }

    /// The same of results that are laid out already.
    ///
    /// # Errors
    /// What the disk says.
    pub fn write_image(&mut self, image: &Hdf5Image) -> Result<(), StoreError> {
        let image = image.bytes();
        let put = |file: &mut File| {
            file.rewind()?;
            file.set_len(0)?;
            let (first, rest) = image.split_at(TORN.len().min(image.len()));
            file.write_all(&TORN)?;
            file.write_all(rest)?;
            // The first bytes come last, so that they vouch for the rest.
            file.sync_data()?;
            file.rewind()?;
            file.write_all(first)
        };
        let put = put(&mut self.file);
        self.written = put.is_ok();
        self.holds = self.written;
        if self.written {
            return Ok(());
        }
        // Half a file is of no use to anybody; an empty one is removed.
        let _ = self.file.set_len(0);
        put.map_err(|e| StoreError::io(&self.partial, "write", e))
    }

    /// Makes the partial file the results file, in one step, once it is safely on the disk. It has the owner and the
    /// permissions of the file that it replaces, as far as the system lets it.
    pub fn finish(mut self) -> Result<(), StoreError> {
        if !self.written {
            return Err(StoreError::inconsistent("the file was finished before anything was written to it"));
        }
        self.put_in_place(&self.file, &self.partial)?;
        self.finished = true;
        Ok(())
    }

    /// Makes the file `of`, which is open, the results file.
    fn put_in_place(&self, file: &File, of: &Path) -> Result<(), StoreError> {
        // The place was free before the run; something may have been put there since.
        check_occupant(&self.path, &self.scene_text, self.overwrite)?;
        give_rights(file, &self.path, false);
        file.sync_all().map_err(|e| StoreError::io(of, "write", e))?;
        fs::rename(of, &self.path).map_err(|e| StoreError::io(&self.path, "put in place", e))?;
        // The new name should outlast a power cut too; where a folder cannot be synced, nothing is lost
        // but that.
        let parent = self.path.parent().filter(|parent| !parent.as_os_str().is_empty());
        if let Ok(folder) = File::open(parent.unwrap_or(Path::new("."))) {
            let _ = folder.sync_all();
        }
        Ok(())
    }

    /// Makes these bytes, one after the other, the results file by way of a neighbour, while the partial file stays what it is; then that is
    /// removed.
    pub(super) fn finish_beside(mut self, bytes: &[&[u8]]) -> Result<(), StoreError> {
        let beside = partial_path(&self.partial).with_extension("new");
        // What a run that was killed here has left; nothing is written through a link.
        let _ = fs::remove_file(&beside);
        let opened = OpenOptions::new().write(true).create_new(true).open(&beside);
        let put = opened.and_then(|mut file| {
            bytes.iter().try_for_each(|some| file.write_all(some))?;
            Ok(file)
        });
        let done = put
            .map_err(|e| StoreError::io(&beside, "write", e))
            .and_then(|file| self.put_in_place(&file, &beside));
        match done {
            Ok(()) => {
                self.finished = true;
                // If it cannot be removed, the next run of the scene says that it is there.
                let _ = fs::remove_file(&self.partial);
            }
            Err(_) => drop(fs::remove_file(&beside)),
        }
        done
    }

    /// Appends these to the partial file, which then holds something if `holds` says so; what was not written whole is taken
    /// away again. What was written outlasts the program at once, and a power cut a second later. Gives where it begins.
    pub(super) fn append(&mut self, parts: &[&[u8]], holds: bool) -> Result<u64, StoreError> {
        let sync = self.synced.is_none_or(|last| last.elapsed() > SYNC);
        let put = |file: &mut File| {
            let end = file.seek(std::io::SeekFrom::End(0))?;
            let put = parts.iter().try_for_each(|part| file.write_all(part));
            let put = put.and_then(|()| if sync { file.sync_data() } else { Ok(()) });
            if put.is_err() {
                let _ = file.set_len(end);
            }
            put.map(|()| end)
        };
        let put = put(&mut self.file).map_err(|e| StoreError::io(&self.partial, "write", e));
        self.holds |= holds && put.is_ok();
        if sync {
            self.synced = Some(Instant::now());
        }
        put
    }

    /// All that the partial file holds.
    pub(super) fn contents(&mut self) -> Result<Vec<u8>, StoreError> {
        let mut bytes = Vec::new();
        let read = self.file.rewind().and_then(|()| self.file.read_to_end(&mut bytes));
        read.map(|_| bytes).map_err(|e| StoreError::io(&self.partial, "read", e))
    }

    /// Cuts the partial file off after so many bytes.
    pub(super) fn cut(&mut self, length: u64) -> Result<(), StoreError> {
        self.holds &= length > 0;
        self.file.set_len(length).map_err(|e| StoreError::io(&self.partial, "write", e))
    }

    /// Where the results are until [`Writer::finish`].
    pub fn partial(&self) -> &Path {
        &self.partial
    }

    /// The folder that was made for the file, if one had to be.
    pub fn made_folder(&self) -> Option<&Path> {
        self.made.as_deref()
    }
}

impl Drop for Writer {
    fn drop(&mut self) {
        if !self.finished && !self.holds && is_at(&self.file, &self.partial) {
            // An empty file tells nobody anything; if it cannot be removed, the next run takes it over.
            let _ = fs::remove_file(&self.partial);
        }
    }
}

/// Opens and locks the partial file, and says whether it holds something.
fn reserve(
    path: &Path,
    partial: &Path,
    scene_text: &str,
    earlier: ExistingFile,
) -> Result<(File, bool), StoreError> {
    let failed = |e| StoreError::io(partial, "create", e);
    let busy = || StoreError::Busy { path: path.to_path_buf(), partial: partial.to_path_buf() };
    // Another run may rename, remove or fill the file between our looks at it and locking it, or look at it as we do.
    // The next try begins anew.
    for attempt in 0..8 {
        let before = match fs::symlink_metadata(partial) {
            Ok(metadata) => Some(metadata),
            Err(e) if e.kind() == ErrorKind::NotFound => None,
            Err(e) => return Err(failed(e)),
        };
        if let Some(before) = &before {
            match may_be_taken(partial, before, scene_text, earlier) {
                Err(StoreError::InUse { .. }) => return Err(busy()),
                taken => taken?,
            }
        }
        let mut options = OpenOptions::new();
        options.read(true).write(true).create_new(before.is_none());
        // Nothing that was a file a moment ago is followed if it is a link now.
        #[cfg(unix)]
        std::os::unix::fs::OpenOptionsExt::custom_flags(&mut options, libc::O_NOFOLLOW);
        let file = match options.open(partial) {
            Ok(file) => file,
            Err(e) if e.kind() == ErrorKind::AlreadyExists && before.is_none() => continue,
            Err(e) if e.kind() == ErrorKind::NotFound && before.is_some() => continue,
            Err(e) => return Err(failed(e)),
        };
        match file.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) if attempt < 3 => {
                // Different runs wait differently long.
                std::thread::sleep(Duration::from_millis(5 + u64::from(std::process::id() % 32)));
                continue;
            }
            Err(TryLockError::WouldBlock) => return Err(busy()),
            // Some network disks know no locks; then two runs at once are the user's to avoid.
            Err(TryLockError::Error(e)) if e.kind() == ErrorKind::Unsupported => {}
            Err(TryLockError::Error(e)) => return Err(failed(e)),
        }
        let now = file.metadata().map_err(failed)?;
        let same = before
            .is_none_or(|before| before.len() == now.len() && before.modified().ok() == now.modified().ok());
        if same && is_at(&file, partial) {
            return Ok((file, now.len() > 0));
        }
    }
    Err(busy())
}

//! What can go wrong with a results file, with the path and the remedy.

use std::io;
use std::path::{Path, PathBuf};

/// Why a results file could not be made or read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StoreError {
    #[error("{} is a folder; name a file inside it with -o, as {}", path.display(), path.join("results.h5").display())]
    Folder { path: PathBuf },
    #[error("{} is no ordinary file (a device, a pipe or a socket); name another file with -o", path.display())]
    Special { path: PathBuf },
    #[error("\"{}\" names no file; give -o a path that ends in a file name", path.display())]
    Nameless { path: PathBuf },
    #[error("results are a file: give -o a name (\"./-\" for a file that is called -)")]
    Stream,
    #[error("{} is a symbolic link to nothing; remove it, or name another file with -o", path.display())]
    DeadLink { path: PathBuf },
    #[error("{} is open in another program, which has locked it; close it there and try again", path.display())]
    InUse { path: PathBuf },
    #[error("{} is a link to another file, which the run would write over; remove it, or name another file with -o", path.display())]
    PartialLink { path: PathBuf },
    #[error(
        "{} is in the way of this run and was not left by one of this scene ({why}); move it, --overwrite replaces it, -o names another file",
        path.display()
    )]
    PartialTaken { path: PathBuf, why: String },
    #[error(
        "{} holds {kept} portion{} of a run of this scene: go on with --resume, begin anew with --overwrite, or name another file with -o",
        partial.display(), if *kept == 1 { "" } else { "s" }
    )]
    Unresumed { partial: PathBuf, kept: usize },
    #[error("{} cannot be gone on with: {why}; --overwrite begins anew", path.display())]
    Journal { path: PathBuf, why: String },
    #[error(
        "{} is the journal of a run that is not whole: `afmsweep export {} -o FILE.h5` looks in, `afmsweep run SCENE --resume` goes on",
        path.display(), path.display()
    )]
    Running { path: PathBuf },
    #[error("{} holds results of another scene; --overwrite replaces them, -o names another file", path.display())]
    OtherScene { path: PathBuf },
    #[error(
        "{} exists and is no results file of afmsweep ({why}); --overwrite replaces it, -o names another file",
        path.display()
    )]
    Occupied { path: PathBuf, why: String },
    #[error(
        "another run is writing {} (it holds {}); wait for it, or name another file with -o",
        path.display(), partial.display()
    )]
    Busy { path: PathBuf, partial: PathBuf },
    #[error("{}: no such file; `afmsweep run SCENE -o FILE` makes one", path.display())]
    Missing { path: PathBuf },
    #[error(
        "{}: no such file, but the unfinished {} is there: the run is still going or was broken off; `afmsweep run SCENE --resume` goes on with it",
        path.display(), partial.display()
    )]
    Unfinished { path: PathBuf, partial: PathBuf },
    #[error("{} is the start of a results file whose run did not finish; run the scene again", path.display())]
    Partial { path: PathBuf },
    #[error("{} is no results file of afmsweep: {why}", path.display())]
    Foreign { path: PathBuf, why: String },
    #[error("{} holds whole results, not a share of a run", path.display())]
    NoShare { path: PathBuf },
    #[error("{} is damaged or cut short ({why}); copy it again from its source, or run the scene again", path.display())]
    Damaged { path: PathBuf, why: String },
    #[error(
        "{} does not hold what its run wrote: {what}; copy it again from its source, or run the scene again \
         (after a change that was meant, take away the root attribute `checksums`)",
        path.display()
    )]
    Changed { path: PathBuf, what: String },
    #[error("{} lacks {what}, which its scene asks for; run the scene again", path.display())]
    Lacking { path: PathBuf, what: String },
    #[error("these results do not fit together: {what}")]
    Inconsistent { what: String },
    #[error("cannot {doing} {}: {source}; {remedy}", path.display())]
    Io { path: PathBuf, doing: &'static str, remedy: &'static str, source: io::Error },
    #[error("HDF5 could not {doing} {}: {source}", path.display())]
    Hdf5 { path: PathBuf, doing: String, source: hdf5::Error },
}

impl StoreError {
    pub(super) fn io(path: &Path, doing: &'static str, source: io::Error) -> Self {
        let remedy = match source.kind() {
            io::ErrorKind::PermissionDenied => "change its permissions, or name another place with -o",
            io::ErrorKind::ReadOnlyFilesystem => "the disk is read-only: name another place with -o",
            io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => {
                "make room on that disk, or name another place with -o"
            }
            io::ErrorKind::FileTooLarge => {
                "the limit on file sizes is too low there: name another place with -o"
            }
            io::ErrorKind::NotADirectory | io::ErrorKind::AlreadyExists => {
                "a file stands where a folder is needed: name another place with -o"
            }
            _ => "check the path, or name another place with -o",
        };
        Self::Io { path: path.to_path_buf(), doing, remedy, source }
    }

    pub(super) fn foreign(path: &Path, why: impl Into<String>) -> Self {
        Self::Foreign { path: path.to_path_buf(), why: why.into() }
    }

    pub(super) fn damaged(path: &Path, why: impl std::fmt::Display) -> Self {
        Self::Damaged { path: path.to_path_buf(), why: why.to_string() }
    }

    pub(super) fn inconsistent(what: impl Into<String>) -> Self {
        Self::Inconsistent { what: what.into() }
    }
}

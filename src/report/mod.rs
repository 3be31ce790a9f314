//! Pictures and a page of tables from a results file; the file is all it needs.
//!
//! What such a page is made of serves other pages too: [`Document`], [`Chart`], [`Heatmap`], [`shown`].

mod axis;
mod canvas;
mod chart;
mod curve;
mod document;
mod floor;
mod force_curve;
mod frame;
mod heatmap;
mod page;
mod pictures;
mod quantity;
mod variable;
mod waveform;

pub use chart::{Chart, Field, Look, Mark, Plot};
pub use document::{Block, Document, Table};
pub use frame::State;
pub use heatmap::{Heatmap, Panel};
pub use quantity::shown;

use crate::store::{StoreError, read};
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// Found in the page of every report: such a folder may be written again.
const MARKER: &str = "afmsweep report";

/// Why there is no report.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReportError {
    #[error(transparent)]
    Store(#[from] StoreError),
    #[error("{} holds other things than a report; -o names another folder", path.display())]
    Occupied { path: PathBuf },
    #[error("{} is a file, but a report needs a folder; -o names another", path.display())]
    NotAFolder { path: PathBuf },
    #[error("cannot {doing} {}: {source}; -o names another folder", path.display())]
    Io { path: PathBuf, doing: &'static str, source: io::Error },
    #[error("a picture could not be drawn: {why}")]
    Draw { why: String },
}

/// Writes `index.html`, `report.md` and the pictures of a results file into a folder, and gives the folder.
///
/// Without `output` the folder is the file's name without its ending. A folder that holds anything else
/// than an earlier report is left alone.
pub fn write(file: &Path, output: Option<&Path>) -> Result<PathBuf, ReportError> {
    let folder = output.map_or_else(|| default_folder(file), Path::to_path_buf);
    check_folder(&folder, MARKER)?;
    let results = read(file)?;
    let drawn = pictures::all(&results)?;
    let page = ("index.html".to_owned(), page::html(&results, file, &drawn));
    let text = ("report.md".to_owned(), page::markdown(&results, file, &drawn));
    let drawn = drawn.pictures.into_iter().map(|picture| (picture.file, picture.svg));
    let files: Vec<(String, String)> = [page, text].into_iter().chain(drawn).collect();
    save(&folder, MARKER, &files)?;
    Ok(folder)
}

/// Writes files (name, content) into a folder, which is made if need be. `index.html` is to come first
/// and to name `generator`: were the rest to fail, the folder is known as its own all the same.
///
/// # Errors
/// A folder that holds anything else than what the same generator left, and what the disk says.
pub fn save(folder: &Path, generator: &str, files: &[(String, String)]) -> Result<(), ReportError> {
    check_folder(folder, generator)?;
    let failed = |path: &Path, doing| {
        let path = path.to_path_buf();
        move |source| ReportError::Io { path, doing, source }
    };
    fs::create_dir_all(folder).map_err(failed(folder, "make the folder"))?;
    for (name, content) in files {
        let path = folder.join(name);
        fs::write(&path, content).map_err(failed(&path, "write"))?;
    }
    Ok(())
}

/// `results/a` for `results/a.h5`; a file without an ending gets one for its folder.
fn default_folder(file: &Path) -> PathBuf {
    // A partial file's own folder would stand where its results file is to be.
    let whole = if file.extension().is_some_and(|end| end == "partial") {
        file.with_extension("")
    } else {
        file.to_path_buf()
    };
    let folder = whole.with_extension("");
    if folder == file { file.with_extension("report") } else { folder }
}

/// Whether files may be written into this folder: it is not there, empty, or an earlier page's of `generator`.
///
/// # Errors
/// [`ReportError::Occupied`], [`ReportError::NotAFolder`], and what the disk says.
pub fn check_folder(folder: &Path, generator: &str) -> Result<(), ReportError> {
    let own = || folder.to_path_buf();
    if folder.is_file() {
        return Err(ReportError::NotAFolder { path: own() });
    }
    let mut entries = match fs::read_dir(folder) {
        Ok(entries) => entries,
        Err(e) if e.kind() == io::ErrorKind::NotFound => return Ok(()),
        Err(source) => return Err(ReportError::Io { path: own(), doing: "read the folder", source }),
    };
    let page = fs::read_to_string(folder.join("index.html")).unwrap_or_default();
    let marked = page.contains(&format!("name=\"generator\" content=\"{generator}\""));
    if entries.next().is_none() || marked { Ok(()) } else { Err(ReportError::Occupied { path: own() }) }
}

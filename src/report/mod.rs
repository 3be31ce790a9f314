//! Pictures and a page of tables from a results file; the file is all it needs.

mod axis;
mod canvas;
mod curve;
mod force_curve;
mod frame;
mod heatmap;
mod page;
mod pictures;
mod quantity;
mod waveform;

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
    check_folder(&folder)?;
    let results = read(file)?;
    let pictures = pictures::all(&results)?;
    let failed = |path: &Path, doing| {
        let path = path.to_path_buf();
        move |source| ReportError::Io { path, doing, source }
    };
    fs::create_dir_all(&folder).map_err(failed(&folder, "make the folder"))?;
    // The page first: were the rest to fail, the folder is known as a report all the same.
    let page = (Path::new("index.html"), page::html(&results, file, &pictures));
    let text = (Path::new("report.md"), page::markdown(&results, file, &pictures));
    let drawn = pictures.iter().map(|picture| (Path::new(&picture.file), picture.svg.clone()));
    for (name, content) in [page, text].into_iter().chain(drawn) {
        let path = folder.join(name);
        fs::write(&path, content).map_err(failed(&path, "write"))?;
    }
    Ok(folder)
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

fn check_folder(folder: &Path) -> Result<(), ReportError> {
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
    let marked = page.contains(&format!("name=\"generator\" content=\"{MARKER}\""));
    if entries.next().is_none() || marked { Ok(()) } else { Err(ReportError::Occupied { path: own() }) }
}

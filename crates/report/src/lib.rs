//! Pictures and a page of tables from a results file; the file is all it needs.
//!
//! What such a page is made of serves other pages too: [`Document`], [`Chart`], [`Heatmap`], [`shown`].

mod axis;
mod band;
mod branch_states;
mod canvas;
mod chart;
mod contour;
mod csv;
mod curve_forces;
mod curve_picture;
mod document;
mod error_floor;
mod explore_page;
mod force_curve;
mod frame;
mod harmonics;
mod heat_cells;
mod heatmap;
mod hover;
mod labels;
mod limits;
mod live_page;
mod page;
mod page_summary;
mod picture;
mod pictures;
mod quantity_text;
mod raster;
mod scatter;
mod stack;
mod tables;
pub mod uncertainty;
mod variable;
mod view_request;
mod waveform;

pub use chart::{Chart, ChartField, Look, Mark, Plot};
pub use csv::defused;
pub use document::{Block, Document, DocumentTable};
pub use frame::State;
pub use heatmap::{Heatmap, Panel};
pub use labels::capital;
pub use live_page::live_page;
pub use quantity_text::shown;
pub use view_request::{PageEngine, ViewRequest};

use afmsweep_data::{observe, reconstruction, stats, store, suggestion, units};
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use store::{Results, StoreError, read};

/// Found in the page of every report: such a folder may be written again.
const MARKER: &str = "afmsweep report";

/// The page to explore results.
const EXPLORE: &str = "explore.html";

/// Path of the axis of samples.
const SAMPLES: &str = "samples";

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
    #[error("{option} {name}: expected {expected}")]
    Wish { option: &'static str, name: String, expected: String },
}

impl ReportError {
    /// Of an option that names what the results do not have.
    fn wish(option: &'static str, name: &str, expected: &str) -> Self {
        Self::Wish { option, name: name.to_owned(), expected: expected.to_owned() }
    }
}

/// A page that was written.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Report {
    pub folder: PathBuf,
    /// The pictures, in the order of the page.
    pub pictures: Vec<Pictured>,
    /// The page to explore the results, a file in the folder, where there is one.
    pub explore: Option<String>,
    /// What was not drawn, a sentence each.
    pub left_out: Vec<String>,
    /// What came out, and how good it is, in two sentences.
    pub findings: Vec<String>,
    /// What is left within the reader's limits; none without limits.
    pub kept: Option<Kept>,
}

/// What is left within the limits that a reader asked for.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
#[non_exhaustive]
pub struct Kept {
    /// Instances within the limits, of those that are looked at.
    pub instances: usize,
    pub of: usize,
    /// The best of them, by the first observable without a limit.
    pub best: Option<Best>,
}

/// The largest value of an observable, or the smallest where all limits are lower ones.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
#[non_exhaustive]
pub struct Best {
    pub observable: String,
    pub instance: usize,
    /// SI.
    pub value: f64,
}

/// A picture of a page.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
#[non_exhaustive]
pub struct Pictured {
    pub title: String,
    /// File in the report's folder.
    pub file: String,
    /// Likewise its numbers; none where they would be too many.
    pub csv: Option<String>,
}

/// Writes `index.html`, `report.md`, the pictures of a results file and their numbers into a folder. The wish says which
/// axes the pictures have. Of a list, and of a grid of three axes or more, there is `explore.html` too.
///
/// Without `output` the folder is the file's name without its ending. A folder that holds anything else
/// than an earlier report is left alone.
///
/// # Errors
/// See [`ReportError`].
pub fn write(file: &Path, output: Option<&Path>, wish: &ViewRequest) -> Result<Report, ReportError> {
    let folder = output.map_or_else(|| default_folder(file), Path::to_path_buf);
    check_folder(&folder, MARKER)?;
    let results = match &wish.branch {
        None => read(file)?,
        Some(branch) => branch_states::chosen(read(file)?, branch)?,
    };
    let (results, limited) = limits::applied(ways_named(samples_as_list(results)), wish)?;
    let mut drawn = pictures::all(&results, wish)?;
    let fixed = if results.list { Vec::new() } else { view_request::fixed(&results, wish)? };
    let slice = (!fixed.is_empty()).then(|| page_summary::of_shown(&results, &fixed));
    let looked_at = slice.as_ref().unwrap_or(&results);
    let (kept, sentence) = match limited {
        true => limits::kept(looked_at, wish).map(|(kept, sentence)| (Some(kept), Some(sentence)))?,
        false => (None, None),
    };
    let findings = page_summary::all(looked_at, &fixed, sentence);
    let explored = explore_page::is_wanted(&results).then(|| {
        let name = file.file_name().unwrap_or_default().to_string_lossy();
        explore_page::explore_page(&results, (&page::heading(&results, file), &name), wish.engine.as_ref())
    });
    let explored = explored.and_then(|page| page.map_err(|why| drawn.left_out.push(why)).ok());
    let page = ("index.html".to_owned(), page::html(&results, file, (&drawn, &findings, explored.is_some())));
    let text = ("report.md".to_owned(), page::markdown(&results, file, (&drawn, &findings)));
    let mut files = vec![page, text];
    let explore = explored.as_ref().map(|_| EXPLORE.to_owned());
    files.extend(explored.map(|page| (EXPLORE.to_owned(), page)));
    let mut pictures = Vec::new();
    for picture in drawn.pictures {
        let csv = picture.csv.as_ref().map(|_| format!("{}.csv", picture.name));
        pictures.push(Pictured { title: picture.title.clone(), file: picture.file(), csv: csv.clone() });
        files.push((picture.file(), picture.svg));
        files.extend(csv.zip(picture.csv));
    }
    save(&folder, MARKER, &files)?;
    Ok(Report { folder, pictures, explore, left_out: drawn.left_out, findings, kept })
}

/// The ways along a curve over the gap are approach and retraction.
fn ways_named(mut results: Results) -> Results {
    let Some((last, others)) = results.axes.split_last_mut() else { return results };
    let falls = last.values.first() >= last.values.last();
    if let Some(ways) =
        others.iter_mut().find(|axis| axis.name == view_request::DIRECTION && axis.words.len() == 2)
        && last.scene_path == curve_forces::GAP
    {
        ways.words = ["approach", "retraction"].map(str::to_owned).to_vec();
        if !falls {
            ways.words.reverse();
        }
    }
    results
}

/// Samples without a sweep beside them have no order: they are drawn as a list is, over each of their quantities.
fn samples_as_list(mut results: Results) -> Results {
    if let [axis] = &mut results.axes[..]
        && axis.scene_path == SAMPLES
        && !axis.columns.is_empty()
    {
        results.axes = std::mem::take(&mut axis.columns);
        results.list = true;
    }
    results
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

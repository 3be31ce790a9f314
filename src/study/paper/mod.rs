//! The paper, reproduced and questioned: J.-L. Ha, R.-F. Fung, Y.-C. Chen, "Dynamic Responses of an Atomic
//! Force Microscope Interacting With Samples", J. Dyn. Syst. Meas. Control 127(4), 705-709 (2005).
//!
//! One file a question: `table1.rs` (what follows from Table 1), `printed_choices.rs` (what depends on the choices the
//! printed text leaves), `figure3.rs`, `figure4.rs`, `coupling.rs` (their first conclusion), `ensemble/`
//! (what they could not do). Each finds numbers and draws pictures; `page/` tells about them.

mod coupling;
mod ensemble;
mod figure3;
mod figure4;
mod page;
mod printed_choices;
mod table1;

use super::{Numbers, StudyError};
use crate::engine::{Cpu, Engine};
use crate::report;
use crate::scene::{Params, Scene};
use std::path::Path;
use std::time::Instant;

/// What `index.html` says made it.
const GENERATOR: &str = "afmsweep study paper";
/// How the one line of the page begins that depends on the machine.
pub const MACHINE_LINE: &str = "Run time:";

/// The scenes this study runs.
const FIGURE_4: [(&str, &str); 3] = [
    ("hertz", include_str!("../../../scenes/paper_fig4_hertz.toml")),
    ("dmt", include_str!("../../../scenes/paper_fig4_dmt.toml")),
    ("jkr", include_str!("../../../scenes/paper_fig4_jkr.toml")),
];
const COUPLING: &str = include_str!("../../../scenes/paper/coupling.toml");
const ENSEMBLE: &str = include_str!("../../../scenes/paper/ensemble.toml");

/// Names of the laws of [`FIGURE_4`], for people.
const LAWS: [(&str, &str); 3] = [("hertz", "Hertz"), ("dmt", "DMT"), ("jkr", "JKR")];

/// How much of the ensemble is run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extent {
    /// All of it.
    Full,
    /// Only the tip radii that the maps show: the same pictures, other sums.
    Shown,
}

/// A picture's file name and SVG.
type Picture = (String, String);

/// Makes the study in `folder`: results files, pictures, `numbers.csv` and the page, as `index.html` and as
/// `README.md`. `say` is told what is being done.
///
/// # Errors
/// A folder that holds anything else than an earlier study, and what the disk says.
pub fn write(folder: &Path, extent: Extent, say: &dyn Fn(&str)) -> Result<Numbers, StudyError> {
    report::check_folder(folder, GENERATOR)?;
    let start = Instant::now();
    let mut numbers = Numbers::default();
    let mut pictures = Vec::new();
    let params = params()?;
    say("Table 1 and the choices it leaves");
    table1::find(&mut numbers, &params)?;
    printed_choices::find(&mut numbers, &params)?;
    say("figure 3");
    pictures.extend(figure3::find(&mut numbers, &params)?);
    say("figure 4");
    if !folder.join("index.html").exists() {
        // A page to begin with: the folder is then known as this study's, whatever happens.
        report::save(folder, GENERATOR, &[page::placeholder(GENERATOR)])?;
    }
    pictures.extend(figure4::find(&mut numbers, folder)?);
    say("the two conclusions");
    pictures.extend(coupling::find(&mut numbers, folder)?);
    say("the ensemble under three laws");
    pictures.extend(ensemble::find(&mut numbers, folder, extent)?);
    let machine = format!(
        "{MACHINE_LINE} {:.0} s on {}.",
        start.elapsed().as_secs_f64().ceil(),
        Cpu::default().device()
    );
    let document = page::document(&numbers, &machine);
    let mut files = vec![
        ("index.html".to_owned(), document.html(GENERATOR)),
        ("README.md".to_owned(), document.markdown()),
        ("numbers.csv".to_owned(), numbers.csv()),
    ];
    files.extend(pictures);
    report::save(folder, GENERATOR, &files)?;
    Ok(numbers)
}

/// The paper's case.
fn params() -> Result<Params, StudyError> {
    let (_, text) = FIGURE_4[2];
    Ok(Scene::parse(Path::new("scenes/paper_fig4_jkr.toml"), text)?.base)
}

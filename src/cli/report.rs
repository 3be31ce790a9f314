//! `afmsweep report`: pictures and tables from a results file.

use super::{Verbosity, live, print_json};
use afmsweep::Scene;
use afmsweep::report::{self, PageEngine, ViewRequest};
use afmsweep::store::scene_of;
use std::path::{Path, PathBuf};

#[derive(clap::Args)]
#[command(after_help = "Examples: afmsweep report results/lever.h5\n          \
                        afmsweep report results/map.h5 --x sample.youngs_modulus --y sample.surface_energy --at approach.gap=16nm\n          \
                        afmsweep report results/set_point.h5 --below force_max=5nN")]
pub struct ReportArgs {
    /// Results file (HDF5)
    file: PathBuf,
    /// Folder for the page and its pictures [default: the file's name without .h5]
    #[arg(short, long)]
    output: Option<PathBuf>,
    /// The axis to the right, by its path in the scene; the others become curves, panels and maps
    #[arg(long, value_name = "PATH")]
    x: Option<String>,
    /// The axis upwards: maps in place of curves
    #[arg(long, value_name = "PATH")]
    y: Option<String>,
    /// The axis whose values, up to nine, are curves in one picture
    #[arg(long, value_name = "PATH")]
    curves: Option<String>,
    /// An axis that stands at one value, the nearest there is; may be given for several axes
    #[arg(long, value_name = "PATH=VALUE", value_parser = place)]
    at: Vec<(String, String)>,
    /// Greys what is not below this value of an observable, and says what is left; may be given several times
    #[arg(long, value_name = "NAME=VALUE", value_parser = place)]
    below: Vec<(String, String)>,
    /// Likewise what is not above it
    #[arg(long, value_name = "NAME=VALUE", value_parser = place)]
    above: Vec<(String, String)>,
    /// The states of one branch alone, the second ones among them: attractive or repulsive
    #[arg(long, value_name = "BRANCH")]
    branch: Option<String>,
    /// Lets explore.html compute cases between the rows: the engine that `make live` builds [default: the one in this program]
    #[arg(long, value_name = "FILE")]
    engine: Option<PathBuf>,
    /// What was drawn as one JSON object on standard output
    #[arg(long)]
    json: bool,
}

/// `approach.gap=16nm`, `force_max=5nN`.
fn place(text: &str) -> Result<(String, String), String> {
    let (path, value) = text.split_once('=').ok_or("expected NAME=VALUE, such as approach.gap=16nm")?;
    Ok((path.trim().to_owned(), value.trim().to_owned()))
}

/// What explore.html computes with. Results whose scene cannot be made again have a page without it.
fn page_engine(args: &ReportArgs, voice: Verbosity) -> anyhow::Result<Option<PageEngine>> {
    let Some(library) = live::engine(args.engine.as_deref())? else { return Ok(None) };
    let begun = |file: &Path| live::start(&Scene::parse(file, &scene_of(file)?)?);
    match begun(&args.file) {
        Ok(start) => Ok(Some(PageEngine { start, library })),
        Err(why) => {
            voice.say(format_args!("note: the page computes nothing by itself: {why:#}"));
            Ok(None)
        }
    }
}

pub fn main(args: &ReportArgs, voice: Verbosity) -> anyhow::Result<()> {
    let wish = ViewRequest {
        x: args.x.clone(),
        y: args.y.clone(),
        curves: args.curves.clone(),
        at: args.at.clone(),
        below: args.below.clone(),
        above: args.above.clone(),
        branch: args.branch.clone(),
        engine: page_engine(args, voice)?,
    };
    let report = report::write(&args.file, args.output.as_deref(), &wish)?;
    let page = report.folder.join("index.html");
    voice.say(format_args!("report in {}", page.display()));
    if args.json {
        print_json(&serde_json::json!({
            "version": 1,
            "page": page.to_string_lossy(),
            "explore": report.explore,
            "findings": report.findings,
            "kept": report.kept,
            "pictures": report.pictures,
            "left_out": report.left_out,
        }))?;
    }
    Ok(())
}

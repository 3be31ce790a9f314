//! `afmsweep study`: a question answered by one command and one page.

use super::Verbosity;
use afmsweep::study::paper::{self, Extent};
use std::path::PathBuf;

#[derive(clap::Args)]
#[command(after_help = "Example: afmsweep study paper -o paper")]
pub struct StudyArgs {
    /// Which study
    #[arg(value_enum)]
    study: Study,
    /// Folder for the page, its pictures and the results files [default: results/<study>]
    #[arg(short, long)]
    output: Option<PathBuf>,
}

#[derive(Clone, Copy, clap::ValueEnum)]
enum Study {
    /// Ha, Fung & Chen 2005, reproduced and questioned
    Paper,
}

pub fn main(args: &StudyArgs, voice: Verbosity) -> anyhow::Result<()> {
    let Study::Paper = args.study;
    let folder = args.output.clone().unwrap_or_else(|| PathBuf::from("results/paper"));
    paper::write(&folder, Extent::Full, &|what| voice.say(what))?;
    voice.say(format_args!("study in {}", folder.join("index.html").display()));
    Ok(())
}

//! `afmsweep report`: pictures and tables from a results file.

use super::Voice;
use afmsweep::report;
use std::path::PathBuf;

#[derive(clap::Args)]
pub struct ReportArgs {
    /// Results file (HDF5)
    file: PathBuf,
    /// Folder for the page and its pictures [default: the file's name without .h5]
    #[arg(short, long)]
    output: Option<PathBuf>,
}

pub fn main(args: &ReportArgs, voice: Voice) -> anyhow::Result<()> {
    let folder = report::write(&args.file, args.output.as_deref())?;
    voice.say(format_args!("report in {}", folder.join("index.html").display()));
    Ok(())
}

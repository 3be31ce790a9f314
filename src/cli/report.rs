//! `afmsweep report`: pictures and tables from a results file.

use super::Voice;
use std::path::PathBuf;

#[derive(clap::Args)]
pub struct ReportArgs {
    /// Results file (HDF5)
    file: PathBuf,
    /// Folder for the page and its pictures (default: the file's name without .h5)
    #[arg(short, long)]
    output: Option<PathBuf>,
}

pub fn main(args: &ReportArgs, _voice: Voice) -> anyhow::Result<()> {
    anyhow::bail!("{}: not built yet {:?}", args.file.display(), args.output)
}

//! `afmsweep export`: the results of a file in another form.

use super::{Voice, look_in};
use std::path::PathBuf;

#[derive(clap::Args)]
#[command(after_help = "Example: afmsweep export results/lever.h5.partial -o soon.h5")]
pub struct ExportArgs {
    /// Journal of a run that is not whole (FILE.partial), or file of a share
    file: PathBuf,
    /// Results file to be written
    #[arg(short, long)]
    output: PathBuf,
    /// Replace whatever file stands at the output
    #[arg(long)]
    overwrite: bool,
}

pub fn main(args: &ExportArgs, voice: Voice) -> anyhow::Result<()> {
    look_in::main(&args.file, &args.output, args.overwrite, voice)
}

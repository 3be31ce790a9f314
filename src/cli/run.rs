//! `afmsweep run`: the main job.

use super::Voice;
use std::path::PathBuf;

#[derive(clap::Args)]
pub struct RunArgs {
    /// Scene file (TOML)
    scene: PathBuf,
}

pub fn main(args: &RunArgs, _voice: Voice) -> anyhow::Result<()> {
    anyhow::bail!("{}: not built yet", args.scene.display())
}

//! `afmsweep force`: static force-indentation curves.

use super::Voice;
use std::path::PathBuf;

#[derive(clap::Args)]
pub struct ForceArgs {
    /// Scene file (TOML)
    scene: PathBuf,
}

pub fn main(args: &ForceArgs, _voice: Voice) -> anyhow::Result<()> {
    anyhow::bail!("{}: not built yet", args.scene.display())
}

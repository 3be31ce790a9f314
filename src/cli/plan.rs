//! `afmsweep plan`: what a run would do.

use super::run::EngineArgs;
use super::{load, print, print_json};
use afmsweep::engine::estimate;
use std::path::PathBuf;

#[derive(clap::Args)]
pub struct PlanArgs {
    /// Scene file (TOML)
    scene: PathBuf,
    /// Machine-readable answer on standard output, SI units
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    engine: EngineArgs,
}

pub fn main(args: &PlanArgs) -> anyhow::Result<()> {
    let mut scene = load(&args.scene)?;
    let plan = args.engine.plan(&mut scene)?;
    let summary = plan.summary(Some(estimate(&plan, args.engine.engine().as_ref())?));
    if args.json { print_json(summary.json()) } else { print(&summary.to_string()) }
}

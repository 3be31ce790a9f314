//! `afmsweep devices`: what could run a scene here.

use super::Voice;

#[derive(clap::Args)]
pub struct DevicesArgs {
    /// Machine-readable answer on standard output
    #[arg(long)]
    json: bool,
}

pub fn main(args: &DevicesArgs, _voice: Voice) -> anyhow::Result<()> {
    anyhow::bail!("not built yet ({})", args.json)
}

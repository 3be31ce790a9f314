//! `afmsweep init`: a commented scene to begin with.

use super::print;

#[derive(clap::Args)]
#[command(after_help = "Example: afmsweep init --lever > scene.toml && afmsweep run scene.toml -o scene.h5")]
pub struct InitArgs {
    #[command(flatten)]
    kind: Kind,
}

/// Which scene.
#[derive(clap::Args)]
#[group(multiple = false)]
struct Kind {
    /// A calibrated lever that taps on a polymer, over the gap [default]
    #[arg(long)]
    lever: bool,
    /// A soft lever in a liquid, on gels of many moduli
    #[arg(long)]
    liquid: bool,
    /// The rod and lever of Ha, Fung & Chen 2005, over modulus, adhesion and tip radius
    #[arg(long)]
    paper: bool,
    /// A lever with two steady states, both branches over the gap
    #[arg(long)]
    bistable: bool,
}

/// Prints the scene.
pub fn main(args: &InitArgs) -> anyhow::Result<()> {
    let kind = &args.kind;
    print(match (kind.liquid, kind.paper, kind.bistable) {
        (true, ..) => include_str!("../../scenes/liquid.toml"),
        (_, true, _) => include_str!("../../scenes/quickstart.toml"),
        (.., true) => include_str!("../../scenes/bistable.toml"),
        _ => include_str!("../../scenes/lever.toml"),
    })
}

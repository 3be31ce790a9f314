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
    /// Amplitude and phase on approach and retraction, with the jumps, of a lever on two samples
    #[arg(long)]
    curve: bool,
    /// Phase and force of two polymers at the same set-points
    #[arg(long)]
    setpoint: bool,
    /// Peak-force tapping in water, over the sample's modulus
    #[arg(long)]
    peak_force: bool,
    /// A list of materials in place of a grid
    #[arg(long)]
    samples: bool,
}

/// Prints the scene.
pub fn main(args: &InitArgs) -> anyhow::Result<()> {
    let kind = &args.kind;
    let scenes = [
        (kind.liquid, include_str!("../../scenes/liquid.toml")),
        (kind.paper, include_str!("../../scenes/quickstart.toml")),
        (kind.bistable, include_str!("../../scenes/bistable.toml")),
        (kind.curve, include_str!("../../scenes/approach_curve.toml")),
        (kind.setpoint, include_str!("../../scenes/phase_at_setpoint.toml")),
        (kind.peak_force, include_str!("../../scenes/peak_force.toml")),
        (kind.samples, include_str!("../../scenes/samples.toml")),
    ];
    let chosen = scenes.iter().find(|(asked, _)| *asked);
    let scene = chosen.map_or(include_str!("../../scenes/lever.toml"), |(_, scene)| scene);
    // The schema that the first line names lies beside the scene there, not here.
    let (first, rest) = scene.split_once('\n').unwrap_or(("", scene));
    print(if first.starts_with("#:schema") { rest.trim_start() } else { scene })
}

//! `afmsweep prepare`: the choices of a run, made once for all of its shares.

use super::backend::{EngineArgs, say_choice};
use super::stop_message::Stopped;
use super::{Verbosity, load, run, signals};
use afmsweep::engine::Progress;
use afmsweep::sweep::{EngineChoice, Recipe};
use afmsweep::{Error, Observer};
use anyhow::Context;
use std::path::{Path, PathBuf};
use std::sync::Arc;

#[derive(clap::Args)]
#[command(
    after_help = "Example: afmsweep prepare lever.toml -o lever.choices.toml\n         afmsweep run lever.toml --shard 1/8 --choices lever.choices.toml"
)]
pub struct PrepareArgs {
    /// Scene file (TOML)
    scene: PathBuf,
    /// File of the choices [default: results/<scene>.choices.toml]
    #[arg(short, long)]
    output: Option<PathBuf>,
    /// Run each instance once as planned: no error estimates
    #[arg(long)]
    no_estimate: bool,
    /// Search for each instance's periodic state by itself: shares may then be as small as portions
    #[arg(long)]
    cold: bool,
    /// Instances that are run and written down together [default: some ten seconds of work]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    portion: Option<u32>,
    #[command(flatten)]
    engine: EngineArgs,
}

struct PrepareObserver(Verbosity);

impl Observer for PrepareObserver {
    fn chosen(&self, choice: &EngineChoice) {
        say_choice(choice, self.0);
    }
}

pub fn main(args: &PrepareArgs, voice: Verbosity) -> anyhow::Result<()> {
    let progress = Arc::new(Progress::default());
    signals::listen(&progress, voice);
    let output = args.output.clone().unwrap_or_else(|| run::default_output(&args.scene, ".choices.toml"));
    if output.exists() && read(&output).is_err() {
        anyhow::bail!("{} is there and holds no choices; name another file with -o", output.display());
    }
    let sweep = args
        .engine
        .sweep(load(&args.scene)?)?
        .estimate(!args.no_estimate)
        .cold(args.cold)
        .portion(args.portion.map(|count| count as usize))
        .watched_by(&progress);
    let prepared = match sweep.prepare(&PrepareObserver(voice)) {
        Err(Error::Stopped(phase)) => return Err(Stopped::before(phase).into()),
        other => other?,
    };
    write(&output, &prepared.to_toml()?)
        .with_context(|| format!("cannot write {}: name another place with -o", output.display()))?;
    voice.say(format_args!("wrote {}", output.display()));
    Ok(())
}

/// In one step: shares that begin meanwhile read the old choices or the new ones.
fn write(path: &Path, text: &str) -> std::io::Result<()> {
    if let Some(parent) = path.parent().filter(|parent| !parent.as_os_str().is_empty()) {
        std::fs::create_dir_all(parent)?;
    }
    let mut name = path.as_os_str().to_owned();
    name.push(".new");
    let beside = PathBuf::from(name);
    std::fs::write(&beside, text)?;
    std::fs::rename(&beside, path)
}

/// The choices in a file.
pub(super) fn read(path: &Path) -> anyhow::Result<Recipe> {
    let text = std::fs::read_to_string(path)
        .with_context(|| format!("cannot read the choices {}", path.display()))?;
    Recipe::from_toml(&text).with_context(|| path.display().to_string())
}

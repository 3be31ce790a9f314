//! `afmsweep slurm`: the script that runs a scene's shares on a cluster.

use super::{Verbosity, load, print, write};
use anyhow::Context;
use std::path::{Path, PathBuf};

/// What the script is made of.
const SCRIPT: &str = include_str!("slurm.sh");

#[derive(clap::Args)]
#[command(
    after_help = "Example: afmsweep slurm lever.toml --shards 64 --cpus 16 -o lever.sh && bash lever.sh"
)]
pub struct SlurmArgs {
    /// Scene file (TOML)
    scene: PathBuf,
    /// In how many shares it is run
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    shards: u32,
    /// Processor cores of each share
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=1024))]
    cpus: u32,
    /// Script to be written [default: to standard output]
    #[arg(short, long)]
    output: Option<PathBuf>,
    /// Replace whatever file stands at the output
    #[arg(long)]
    overwrite: bool,
    /// Options of `prepare` and `run` for every share, after `--`: as -- --backend cpu --precision f64
    #[arg(last = true)]
    options: Vec<String>,
}

/// A word as a shell takes it whole.
fn quoted(word: &str) -> String {
    format!("'{}'", word.replace('\'', r"'\''"))
}

fn text(path: &Path) -> String {
    path.to_string_lossy().into_owned()
}

fn script(args: &SlurmArgs) -> anyhow::Result<String> {
    let program = std::env::current_exe().context("cannot tell where this program is")?;
    let name = args.scene.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
    let odd = |c: char| !(c.is_alphanumeric() || "-_.".contains(c));
    if name.is_empty() || name.contains(odd) {
        anyhow::bail!(
            "\"{name}\" is to name jobs and files: give the scene a name of letters, digits, - and _"
        );
    }
    let options: Vec<String> = args.options.iter().map(|word| quoted(word)).collect();
    let words = [
        ("@PROGRAM@", text(&program)),
        ("@SCENE@", quoted(&text(&args.scene))),
        ("@NAME@", quoted(&name)),
        ("@SHARDS@", args.shards.to_string()),
        ("@CPUS@", args.cpus.to_string()),
        ("@OPTIONS@", options.join(" ")),
    ];
    Ok(words.iter().fold(SCRIPT.to_owned(), |script, (key, word)| script.replace(key, word)))
}

pub fn main(args: &SlurmArgs, voice: Verbosity) -> anyhow::Result<()> {
    // A scene that is wrong is better told now than by a cluster.
    load(&args.scene)?;
    let script = script(args)?;
    let Some(output) = &args.output else { return print(&script) };
    if output.exists() && !args.overwrite {
        anyhow::bail!("{} is there; --overwrite replaces it, -o names another file", output.display());
    }
    write(Some(output), &script)?;
    voice.say(format_args!("wrote {}: `bash {}` submits it", output.display(), output.display()));
    Ok(())
}

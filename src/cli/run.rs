//! `afmsweep run`: the main job.

mod json;
mod told;

use super::audit;
use super::backend::EngineArgs;
use super::signals;
use super::stopped::Stopped;
use super::table::TableArgs;
use super::{Voice, print_json};
use afmsweep::engine::Progress;
use afmsweep::store::{self, Writer};
use afmsweep::{Audit, Error};
use anyhow::Context;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};
use std::time::Instant;
use told::Told;

#[derive(clap::Args)]
#[command(
    after_help = "Examples: afmsweep run lever.toml\n          afmsweep run lever.toml -o lever.h5 --threads 8 --strict"
)]
pub struct RunArgs {
    /// Scene file (TOML)
    scene: PathBuf,
    /// Results file [default: results/<scene>.h5]
    #[arg(short, long)]
    output: Option<PathBuf>,
    /// Replace whatever file stands at the output
    #[arg(long)]
    overwrite: bool,
    /// Run each instance once as planned: no error estimates, no refinement where they are too large
    #[arg(long)]
    no_estimate: bool,
    /// Instances to redo with the reference engine after the run [default: as many as a tenth of the run's time allows, or
    /// 0.25 s, and at least one that touches the sample]
    #[arg(long, value_name = "N", conflicts_with = "no_audit", value_parser = clap::value_parser!(u32).range(1..=10_000))]
    audit: Option<u32>,
    /// Redo none
    #[arg(long)]
    no_audit: bool,
    /// End with exit code 3 where an estimate or an audit misses the accuracy asked for, or nothing is known of a result
    /// that is called ok; the file is whole all the same
    #[arg(long)]
    strict: bool,
    /// What became of the run as one JSON object on standard output; messages go to standard error all the same
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    table: TableArgs,
    #[command(flatten)]
    engine: EngineArgs,
}

/// How this program was called, as a shell would take it again.
fn command_line() -> String {
    let quoted = |word: std::ffi::OsString| {
        let word = word.to_string_lossy().into_owned();
        let plain = |c: char| c.is_alphanumeric() || "-_./:=,+@%".contains(c);
        if !word.is_empty() && word.chars().all(plain) {
            word
        } else {
            format!("'{}'", word.replace('\'', r"'\''"))
        }
    };
    let words = std::env::args_os().skip(1).map(quoted);
    std::iter::once("afmsweep".to_owned()).chain(words).collect::<Vec<_>>().join(" ")
}

/// `results/<scene>.h5`, in the current folder.
fn default_output(scene: &Path) -> PathBuf {
    let stem = scene.file_stem().unwrap_or(scene.as_os_str());
    let mut name = stem.to_owned();
    name.push(".h5");
    Path::new("results").join(name)
}

pub fn main(args: &RunArgs, voice: Voice) -> anyhow::Result<()> {
    let progress = Arc::new(Progress::default());
    signals::listen(&progress, voice);
    let scene = args.table.load(&args.scene)?;
    let output = args.output.clone().unwrap_or_else(|| default_output(&args.scene));
    if [output.clone(), store::partial_path(&output)].iter().any(|path| store::same_file(&args.scene, path)) {
        anyhow::bail!("{} is the scene itself; name another file with -o", output.display());
    }
    let mut writer = Writer::create(&output, &scene.source, args.overwrite)?;
    let start = Instant::now();
    // Told of a folder that somebody named, who may have misspelt it.
    let folder = writer.made_folder().filter(|_| args.output.is_some()).map(Path::to_path_buf);
    let audit = match args.audit {
        _ if args.no_audit => Audit::None,
        Some(count) => Audit::Instances(count),
        None => Audit::Auto,
    };
    let sweep = args
        .engine
        .sweep(scene)?
        .estimate(!args.no_estimate)
        .audit(audit)
        .watched_by(&progress)
        .command_line(command_line());
    let told =
        Told { path: &args.scene, scene: sweep.scene(), folder, progress, voice, shown: Mutex::default() };
    let swept = sweep.run_with(&told);
    drop(told);
    let swept = match swept {
        Err(Error::Stopped(phase)) => return Err(Stopped::before(phase).into()),
        other => other?,
    };
    signals::held(|| writer.write(&swept.results))?;
    let outcome = &swept.run.outcome;
    if !swept.missing.is_empty() {
        return Err(Stopped::with(&swept.missing, &outcome.results, writer.partial()).into());
    }
    let partial = writer.partial().to_path_buf();
    signals::held(|| writer.finish())
        .with_context(|| format!("the run is whole, but its file stays {}", partial.display()))?;
    told::end(sweep.scene(), &swept, args.no_audit || args.engine.reference(), voice);
    let wall = start.elapsed().as_secs_f64();
    voice.say(format_args!(
        "wrote {} in {wall:.2} s ({:.2} s stepping, {:.2e} instance-steps/s)",
        output.display(),
        swept.stepping,
        swept.rate
    ));
    if args.json {
        print_json(&json::object(&swept, &output, wall))?;
    }
    audit::strict(args.strict, &swept.verdict, &output)
}

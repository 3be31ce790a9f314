//! `afmsweep run`: the main job.

mod run_json;
mod run_messages;

use super::audit_message;
use super::backend::EngineArgs;
use super::prepare;
use super::signals;
use super::stop_message::Stopped;
use super::table::TableArgs;
use super::{STANDARD_INPUT, Verbosity, counted, plan_notice, print_json, values};
use afmsweep::control::JournaledRun;
use afmsweep::engine::Progress;
use afmsweep::store::{self, ExistingFile, Journal, Results, RunFile};
use afmsweep::sweep::{RunJournal, Share, read_header};
use afmsweep::{Audit, Error, Scene, Status, Sweep};
use anyhow::Context;
use run_messages::Messages;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};
use std::time::Instant;

#[derive(clap::Args)]
#[command(
    after_help = "Examples: afmsweep run lever.toml\n          afmsweep run lever.toml -o lever.h5 --threads 8 --strict"
)]
pub struct RunArgs {
    /// Scene file (TOML), or - for standard input
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
    /// Search for each instance's periodic state by itself, not from its neighbours' in the sweep
    #[arg(long, conflicts_with = "choices")]
    cold: bool,
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
    /// Go on with what an earlier run of the scene has left in its journal, FILE.partial; where there is none, begin. A run that
    /// was begun on another kind of engine is refused unless `anyway`: its last bits would be of both
    #[arg(long, value_enum, value_name = "HOW", num_args = 0..=1, require_equals = true, default_missing_value = "same", conflicts_with = "overwrite")]
    resume: Option<Resume>,
    /// Run share K of N, from 1, into <scene>.K-of-N.h5; `afmsweep merge` makes results of all N
    #[arg(long, value_name = "K/N", value_parser = parse_share)]
    shard: Option<Share>,
    /// Choices that `afmsweep prepare` has made [default: made first]
    #[arg(long, value_name = "FILE")]
    choices: Option<PathBuf>,
    /// Instances that are run and written down together [default: some ten seconds of work]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    portion: Option<u32>,
    /// What became of the run as one JSON object on standard output; messages go to standard error all the same
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    table: TableArgs,
    #[command(flatten)]
    engine: EngineArgs,
}

/// Whether a run may go on with what was begun on another kind of engine.
#[derive(Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Resume {
    /// No
    Same,
    /// Yes
    Anyway,
}

fn parse_share(text: &str) -> Result<Share, String> {
    let parts = text.split_once('/').and_then(|(k, n)| Some((k.parse().ok()?, n.parse().ok()?)));
    match parts {
        Some((number, of @ 1..=100_000)) if (1..=of).contains(&number) => Ok(Share { number, of }),
        _ => Err("expected K/N with K from 1 to N, as 3/8".into()),
    }
}

/// How this program was called, as a shell would take it again.
pub(super) fn command_line() -> String {
    let quoted = |word: &std::ffi::OsString| {
        let word = word.to_string_lossy().into_owned();
        let plain = |c: char| c.is_alphanumeric() || "-_./:=,+@%".contains(c);
        if !word.is_empty() && word.chars().all(plain) {
            word
        } else {
            format!("'{}'", word.replace('\'', r"'\''"))
        }
    };
    let words = super::ARGUMENTS.get().into_iter().flatten().skip(1).map(quoted);
    std::iter::once("afmsweep".to_owned()).chain(words).collect::<Vec<_>>().join(" ")
}

/// `results/<scene>.h5`, in the current folder; of a share `results/<scene>.K-of-N.h5`.
pub(super) fn default_output(scene: &Path, ending: &str) -> PathBuf {
    let named = if scene == Path::new(STANDARD_INPUT.0) { Path::new(STANDARD_INPUT.1) } else { scene };
    let stem = named.file_stem().unwrap_or(named.as_os_str());
    let mut name = stem.to_owned();
    name.push(ending);
    Path::new("results").join(name)
}

impl RunArgs {
    fn output(&self) -> PathBuf {
        let ending = match self.shard {
            Some(Share { number, of }) => format!(".{number}-of-{of}.h5"),
            None => ".h5".into(),
        };
        self.output.clone().unwrap_or_else(|| default_output(&self.scene, &ending))
    }

    fn earlier(&self) -> ExistingFile {
        match (self.overwrite, self.resume) {
            (true, _) => ExistingFile::Replaced,
            (_, Some(_)) => ExistingFile::GoneOnWith,
            _ => ExistingFile::Kept,
        }
    }
}

/// The whole results of a scene, where they stand at `output` and nothing is left to go on with.
pub fn finished(output: &Path, scene: &Scene) -> Option<Results> {
    // A table of forces in a file may have changed while the scene's text did not.
    let table = &scene.base.contact.table;
    let same = |all: &Results| {
        table.is_none() || super::scene_in(output, all).is_ok_and(|kept| kept.base.contact.table == *table)
    };
    let is_whole = |all: &Results| !all.status.contains(&(Status::NotRun as u8)) && same(all);
    let stands = !store::partial_path(output).exists()
        && store::scene_of(output).is_ok_and(|text| text == scene.source);
    stands.then(|| store::read(output).ok().filter(is_whole)).flatten()
}

/// What a run says and does until its sweep begins.
struct StartedRun {
    sweep: Sweep,
    keeper: RunJournal,
    output: PathBuf,
    /// A folder that was made for the results, that somebody named, who may have misspelt it.
    folder: Option<PathBuf>,
}

/// Refuses to replace the file of another share.
fn keep_other_share(output: &Path, share: Share) -> anyhow::Result<()> {
    let there = store::open_journal(output).ok().and_then(|journal| read_header(journal.header()).ok());
    match there {
        Some((_, of)) if of != share => anyhow::bail!(
            "{} holds share {of} of a run, and this run is share {share}: name another file with -o, or replace it with --overwrite",
            output.display()
        ),
        _ => Ok(()),
    }
}

fn begin(
    args: &RunArgs,
    scene: Scene,
    output: PathBuf,
    progress: &Arc<Progress>,
    voice: Verbosity,
) -> anyhow::Result<StartedRun> {
    if [output.clone(), store::partial_path(&output)].iter().any(|path| store::same_file(&args.scene, path)) {
        anyhow::bail!("{} is the scene itself; name another file with -o", output.display());
    }
    let share = args.shard.unwrap_or(Share::ALL);
    if !args.overwrite {
        keep_other_share(&output, share)?;
    }
    let prepared = args.choices.as_deref().map(prepare::read).transpose()?;
    let (file, earlier) = RunFile::create(&output, &scene.source, args.earlier())?;
    let folder = file.made_folder().filter(|_| args.output.is_some()).map(Path::to_path_buf);
    if let Some(journal) = &earlier {
        lost(journal, file.partial(), voice);
    }
    let partial = file.partial().to_path_buf();
    let anyway = args.resume == Some(Resume::Anyway);
    let keeper = RunJournal::of_run(file, earlier, share, anyway)?;
    if args.resume.is_some() {
        let later = match keeper.known_answers() {
            0 => String::new(),
            count => format!(", and {count} of what is found after them,"),
        };
        match keeper.known_portions() {
            0 => voice.say(format_args!("{} has no portion to go on with: begins", partial.display())),
            count => voice.say(format_args!(
                "goes on with {}{later} of {}",
                counted(count, "portion"),
                partial.display()
            )),
        }
    }
    let sweep = args
        .engine
        .sweep(scene)?
        .estimate(!args.no_estimate)
        .cold(args.cold)
        .audit(audit(args.audit, args.no_audit))
        .portion(args.portion.map(|count| count as usize))
        .prepared(prepared)
        .watched_by(progress)
        .command_line(command_line());
    Ok(StartedRun { sweep, keeper, output, folder })
}

/// How many instances are redone, by `--audit` and `--no-audit`.
pub(super) fn audit(count: Option<u32>, none: bool) -> Audit {
    if none { Audit::None } else { count.map_or(Audit::Auto, Audit::Instances) }
}

/// Says what of a journal cannot be gone on with.
pub(super) fn lost(journal: &Journal, path: &Path, voice: Verbosity) {
    if journal.torn() > 0 {
        voice.say(format_args!(
            "{}: {} bytes at its end are of a record that was not written whole; they are left out",
            path.display(),
            journal.torn()
        ));
    }
    if journal.spoilt > 0 {
        voice.say(format_args!("{}: {} spoilt; left out", path.display(), counted(journal.spoilt, "record")));
    }
}

pub fn main(args: &RunArgs, voice: Verbosity) -> anyhow::Result<()> {
    let progress = Arc::new(Progress::default());
    signals::listen(&progress, voice);
    let scene = args.table.load(&args.scene)?;
    let output = args.output();
    if args.resume.is_some() && finished(&output, &scene).is_some() {
        voice.say(format_args!("{} is whole: nothing to go on with", output.display()));
        let kept = serde_json::json!({ "version": run_json::VERSION, "file": output.to_string_lossy(), "kept": true });
        return if args.json { print_json(&kept) } else { Ok(()) };
    }
    let start = Instant::now();
    let StartedRun { sweep, keeper, output, folder } = begin(args, scene, output, &progress, voice)?;
    let partial = store::partial_path(&output);
    let counted = Arc::clone(&progress);
    let shown = Mutex::default();
    let told = Messages { path: &args.scene, scene: sweep.scene(), folder, progress, voice, shown };
    plan_notice::announce(told.scene, voice);
    if args.shard.is_some_and(|share| share.of > 1) {
        let whole = sweep.run_share(&keeper, &told);
        drop(told);
        return share(whole, (keeper, counted.stopped()), &output, start, voice);
    }
    let swept = sweep.run_into(&keeper, &told);
    drop(told);
    let swept = match swept {
        Err(Error::Stopped(phase)) => return Err(Stopped::before(phase).into()),
        other => other?,
    };
    if !swept.missing.is_empty() {
        if !counted.stopped() {
            return Err(left_behind(&swept.run, sweep.scene(), &partial).into());
        }
        return Err(Stopped::with(&swept.missing, &swept.run, &partial).into());
    }
    run_messages::end(sweep.scene(), (&swept, &counted), args.no_audit || args.engine.reference(), voice)?;
    let mut object = args.json.then(|| run_json::object(&swept, &output)).transpose()?;
    let (verdict, planning, stepping, rate) = (swept.verdict, swept.planning, swept.stepping, swept.rate);
    let (writing, stays) =
        (Instant::now(), || format!("the run is whole, and its journal stays {}", partial.display()));
    let image = swept.laid_out(&partial).with_context(stays)?;
    drop(swept);
    let file = keeper.into_file().context("the run has no file")?;
    signals::held(|| file.finish_image(&image)).with_context(stays)?;
    let writing = writing.elapsed().as_secs_f64();
    let wall = start.elapsed().as_secs_f64();
    voice.say(format_args!(
        "wrote {} in {wall:.2} s (planning {planning:.2} s, stepping {stepping:.2} s, writing {writing:.2} s; {rate:.2e} instance-steps/s)",
        output.display(),
    ));
    if let Some(object) = &mut object {
        object["wall_time_s"] = wall.into();
        run_json::times(object, (planning, writing), &counted);
        print_json(object)?;
    }
    audit_message::strict(args.strict, &verdict, &output)
}

/// Names the first instance that was left behind.
fn left_behind(run: &JournaledRun, scene: &Scene, partial: &Path) -> Stopped {
    let first = run.marks().iter().position(|mark| mark.status() == Status::NotRun).unwrap_or_default();
    let place = match values(scene, first) {
        values if values.is_empty() => first.to_string(),
        values => format!("{first} ({values})"),
    };
    Stopped::left_behind(run, &place, partial)
}

/// The end of a share: its journal becomes its file.
fn share(
    whole: Result<bool, Error>,
    (keeper, stopped): (RunJournal, bool),
    output: &Path,
    start: Instant,
    voice: Verbosity,
) -> anyhow::Result<()> {
    let share = keeper.share();
    let file = |keeper: RunJournal| keeper.into_file().context("the run has no file");
    match whole {
        Err(Error::Stopped(phase)) => return Err(Stopped::before(phase).into()),
        Ok(false) if stopped => return Err(Stopped::share(share, file(keeper)?.partial()).into()),
        Ok(false) => return Err(Stopped::share_left_behind(share, file(keeper)?.partial()).into()),
        other => other?,
    };
    let title = format!("share {share} of a run");
    signals::held(|| file(keeper)?.finish_share(&title).map_err(anyhow::Error::from))?;
    let wall = start.elapsed().as_secs_f64();
    voice.say(format_args!("wrote share {share}, {}, in {wall:.2} s", output.display()));
    Ok(())
}

//! `afmsweep merge`: the results that one run would have made, of the files of its shares.

use super::run::{audit, lost};
use super::stop_message::Stopped;
use super::{Verbosity, signals};
use afmsweep::engine::Progress;
use afmsweep::store::{self, ExistingFile, Journal, RunFile};
use afmsweep::sweep::{Recipe, RunJournal, Share, command_of, is_of_merge, read_header};
use afmsweep::{Error, Sweep};
use anyhow::{Context, bail};
use std::path::{Path, PathBuf};
use std::sync::Arc;

#[derive(clap::Args)]
#[command(
    after_help = "Example: afmsweep merge results/lever.*-of-8.h5 -o results/lever.h5\n\nWhat is asked of all shares together (second states, the audit, waveforms) is written down in FILE.partial as it is found: a \
merge that was interrupted goes on with it when it is started again"
)]
pub struct MergeArgs {
    /// Files of all shares of a run
    #[arg(required = true)]
    files: Vec<PathBuf>,
    /// Results file
    #[arg(short, long)]
    output: PathBuf,
    /// Replace whatever file stands at the output
    #[arg(long)]
    overwrite: bool,
    /// Instances to redo with the reference engine [default: as many as take 0.25 s, and at least one that touches the sample]
    #[arg(long, value_name = "N", conflicts_with = "no_audit", value_parser = clap::value_parser!(u32).range(1..=10_000))]
    audit: Option<u32>,
    /// Redo none
    #[arg(long)]
    no_audit: bool,
    /// Threads [default: all cores]
    #[arg(long, value_name = "N", value_parser = super::backend::parse_threads)]
    threads: Option<usize>,
    /// Merge here what was run on another kind of engine
    #[arg(long)]
    anyway: bool,
}

impl MergeArgs {
    /// What an earlier merge has found is gone on with.
    fn earlier(&self) -> ExistingFile {
        let journal = || store::open_journal(&store::partial_path(&self.output));
        match self.overwrite {
            true => ExistingFile::Replaced,
            false if journal().is_ok_and(|journal| is_of_merge(journal.header())) => ExistingFile::GoneOnWith,
            false => ExistingFile::Kept,
        }
    }
}

/// The file of a share.
struct Part {
    path: PathBuf,
    journal: Journal,
    prepared: Recipe,
    share: Share,
}

fn part(path: &Path, voice: Verbosity) -> anyhow::Result<Part> {
    let journal = store::open_journal(path)?;
    lost(&journal, path, voice);
    let (prepared, share) = read_header(journal.header()).with_context(|| path.display().to_string())?;
    Ok(Part { path: path.to_path_buf(), journal, prepared, share })
}

pub fn main(args: &MergeArgs, voice: Verbosity) -> anyhow::Result<()> {
    let progress = Arc::new(Progress::default());
    signals::listen(&progress, voice);
    let parts: Vec<Part> = args.files.iter().map(|path| part(path, voice)).collect::<Result<_, _>>()?;
    fit(&parts)?;
    if let Some(part) = parts.iter().find(|part| store::same_file(&part.path, &args.output)) {
        bail!("{} is one of the shares: give the merged results another name with -o", part.path.display());
    }
    let Some(first) = parts.first() else { bail!("no files to merge") };
    let prepared = first.prepared.clone();
    let share = Share { number: 1, of: first.share.of };
    let again = Again::of(&parts);
    let sweep = Sweep::new(prepared.scene()?)
        .told_as(&prepared)
        .audit(audit(args.audit, args.no_audit))
        .threads(args.threads)
        .watched_by(&progress)
        .command_line(super::run::command_line());
    let journals = parts.into_iter().map(|part| part.journal).collect();
    let file = RunFile::create(&args.output, prepared.scene_text(), args.earlier())?;
    let partial = file.0.partial().to_path_buf();
    let keeper = RunJournal::of_merge(journals, share, file)?.on_any_engine(args.anyway);
    if keeper.known_later() > 0 {
        voice.say(format_args!(
            "goes on with {} of what an earlier merge has found: {}",
            keeper.known_later(),
            partial.display()
        ));
    }
    let swept = match sweep.run_into(&keeper, &afmsweep::sweep::Silent) {
        Err(Error::Stopped(phase)) => return Err(Stopped::before(phase).into()),
        Err(Error::Missing { shares }) => bail!("{}", again.words(&shares)),
        other => other?,
    };
    if let Some(phase) = swept.missing.first() {
        return Err(Stopped::merge(*phase, &partial).into());
    }
    let image = swept.laid_out(&partial)?;
    drop(swept);
    let file = keeper.into_file().context("the merge has no file")?;
    signals::held(|| file.finish_image(&image))?;
    voice.say(format_args!("wrote {} of {} shares", args.output.display(), share.of));
    Ok(())
}

/// Refuses files that are not of one run, or of one share.
fn fit(parts: &[Part]) -> anyhow::Result<()> {
    for (n, part) in parts.iter().enumerate() {
        let first = &parts[0];
        if !part.prepared.is_of_one_run_with(&first.prepared) || part.share.of != first.share.of {
            bail!(
                "{} (share {}) and {} (share {}) are not of one run: their scenes, options or choices differ",
                first.path.display(),
                first.share,
                part.path.display(),
                part.share
            );
        }
        if let Some(other) = parts[..n].iter().find(|other| other.share == part.share) {
            bail!(
                "{} and {} are both share {}: leave one of them out",
                other.path.display(),
                part.path.display(),
                part.share
            );
        }
    }
    Ok(())
}

/// How shares that are missing are made.
struct Again {
    of: usize,
    /// A share that is there, and the command that made it.
    known: usize,
    command: String,
    /// Files of shares, by number.
    files: Vec<(usize, PathBuf)>,
}

impl Again {
    fn of(parts: &[Part]) -> Self {
        let files = parts.iter().map(|part| (part.share.number, part.path.clone())).collect();
        let (known, of, command) = parts.first().map_or((1, 1, String::new()), |part| {
            (part.share.number, part.share.of, command_of(part.journal.header()).to_owned())
        });
        Self { of, known, command, files }
    }

    /// The command that makes a share, or goes on with it.
    fn command(&self, share: usize) -> String {
        let (known, of) = (self.known, self.of);
        let text = self.command.replace(&format!("{known}/{of}"), &format!("{share}/{of}"));
        let text = match (self.name(known), self.name(share)) {
            // A file that the user named.
            (Some(own), other)
                if share != known && text.contains(&own) && !own.contains(&format!("{known}-of-{of}")) =>
            {
                let (stem, ending) = own.rsplit_once('.').unwrap_or((&own, "h5"));
                text.replace(&own, &other.unwrap_or_else(|| format!("{stem}.{share}-of-{of}.{ending}")))
            }
            _ => text.replace(&format!("{known}-of-{of}"), &format!("{share}-of-{of}")),
        };
        let text = text.replace(" --overwrite", "");
        if text.contains("--resume") { text } else { format!("{text} --resume") }
    }

    /// The name of a share's results file, if it is there.
    fn name(&self, share: usize) -> Option<String> {
        let (_, path) = self.files.iter().find(|(number, _)| *number == share)?;
        let name = path.file_name()?.to_string_lossy();
        Some(name.strip_suffix(".partial").unwrap_or(&name).to_owned())
    }

    fn words(&self, shares: &[usize]) -> String {
        let line = |share: &usize| {
            let what = match self.files.iter().find(|(number, _)| number == share) {
                Some((_, path)) => format!("{} is not whole", path.display()),
                None => "has no file here".into(),
            };
            format!("share {share}/{} {what}: {}", self.of, self.command(*share))
        };
        let lines: Vec<String> = shares.iter().map(line).collect();
        let verb = if shares.len() == 1 { "share is" } else { "shares are" };
        format!("{} {verb} missing; make them and merge again:\n{}", shares.len(), lines.join("\n"))
    }
}

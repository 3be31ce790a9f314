//! What a run that is not whole has done so far, as a results file.

use super::run::lost;
use super::{Verbosity, instances};
use afmsweep::sweep::{RunJournal, read_header};
use afmsweep::{Backend, Error, Status, Sweep, store};
use anyhow::Context;
use std::path::Path;

/// Makes results of the journal in `file`: what is not done is called not run.
pub fn main(file: &Path, output: &Path, overwrite: bool, voice: Verbosity) -> anyhow::Result<()> {
    let journal = store::open_journal(file)?;
    lost(&journal, file, voice);
    let named = || file.display().to_string();
    let (prepared, share) = read_header(journal.header()).with_context(named)?;
    // Nothing is run: any engine will do.
    let sweep = Sweep::new(prepared.scene().with_context(named)?).told_as(&prepared).backend(Backend::Cpu);
    let keeper = RunJournal::of_journals(vec![journal], share).with_context(named)?;
    let swept = match sweep.look_into(&keeper) {
        Err(Error::Stopped(_)) => anyhow::bail!("{} has no portion that has ended yet", file.display()),
        other => other?,
    };
    let (all, done) = (swept.run.len(), swept.run.len() - swept.run.count(Status::NotRun));
    let mut writer = store::Writer::create(output, prepared.scene_text(), overwrite)?;
    writer.write_image(&swept.laid_out(output)?)?;
    writer.finish()?;
    voice.say(format_args!("wrote {}: {done} of {} are done", output.display(), instances(all)));
    Ok(())
}

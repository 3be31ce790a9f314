//! What is said of errors and audits.

use super::{Verbosity, instances, values};
use afmsweep::control::{ErrorSummary, JournaledRun};
use afmsweep::sweep::{AUDIT_CONTACT, AUDIT_SECONDS};
use afmsweep::{Scene, Status};
use std::path::Path;

/// Exit code of `run --strict` where the accuracy is missed.
pub const MISSED: u8 = 3;

/// The accuracy asked for was missed, and the user wanted to hear of it.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct Missed(String);

/// What is known of the errors.
///
/// # Errors
/// What is kept of the run cannot be read.
pub fn accuracy(
    scene: &Scene,
    run: &JournaledRun,
    verdict: &ErrorSummary,
    told_not_to: bool,
    voice: Verbosity,
) -> anyhow::Result<()> {
    let known = run.estimates_of_ok()?;
    if let (Some(middle), Some(last)) = (known.get(known.len() / 2), known.last()) {
        voice.say(format_args!(
            "estimated error: median {middle:.1e}, largest {last:.1e} of {}; asked for {:e}",
            instances(known.len()),
            run.plan.run.accuracy
        ));
    }
    match (verdict.audited, told_not_to) {
        (0, true) => {}
        (0, false) => voice.say(format_args!("audit: {}", nothing_redone(run))),
        _ => audited(scene, verdict, voice),
    }
    if verdict.unknown > 0 {
        voice.say(format_args!(
            "{} called ok were neither estimated nor audited: nothing is known of their errors",
            instances(verdict.unknown)
        ));
    }
    Ok(())
}

/// Why no instance was redone.
fn nothing_redone(run: &JournaledRun) -> String {
    let mut stepped = run.marks().iter().filter(|mark| mark.stepped()).peekable();
    if stepped.peek().is_none() {
        return "nothing to redo: no instance feels the sample, and the free motion is known in closed form"
            .into();
    }
    if !stepped.any(|mark| mark.status() == Status::Ok) {
        return "nothing to redo: no instance that feels the sample is called ok".into();
    }
    format!(
        "no instance could be redone in {AUDIT_SECONDS} s, nor one that touches the sample in {AUDIT_CONTACT} s; --audit 4 \
         redoes four all the same"
    )
}

/// What the audits say.
fn audited(scene: &Scene, verdict: &ErrorSummary, voice: Verbosity) {
    let ErrorSummary { audited, compared, touching, above, blind, accuracy, .. } = *verdict;
    let doubtful = match audited - compared {
        0 => String::new(),
        some => format!("; {some} not steady by the reference, or else not to be compared"),
    };
    let largest = match verdict.worst {
        Some(worst) => {
            format!("largest error {:.1e}, {touching} of {compared} touch the sample", worst.error)
        }
        None => "none of them to be compared".into(),
    };
    voice.say(format_args!(
        "audit: {} redone by the reference engine, {largest}{doubtful}",
        instances(audited)
    ));
    if let Some(worst) = verdict.worst.filter(|_| above > 0) {
        let place = values(scene, worst.instance as usize);
        let place = if place.is_empty() { place } else { format!(" ({place})") };
        let of = worst.observable.map_or(String::new(), |one| format!(" in {}", one.name()));
        let estimate = match worst.estimate.is_nan() {
            true => "nothing was estimated".into(),
            false => format!("estimated {:.1e}", worst.estimate),
        };
        voice.say(format_args!(
            "warning: {above} of {compared} audited instances ({:.0} %) miss the accuracy asked for, {accuracy:e}; the worst is \
             instance {}{place}: {:.1e}{of}, {estimate}. Those are marked accuracy_not_met; others that were not audited may \
             miss it too: run again with a finer [run] accuracy or more [run] modes, or redo more of them with --audit N",
            100.0 * above as f64 / compared as f64,
            worst.instance,
            worst.error,
        ));
    }
    if blind > 0 {
        voice.say(format_args!(
            "note: of {blind} of {compared} audited instances the reference itself may be off by more than {accuracy:e} \
             (group audit, reference_error): so fine an accuracy it cannot confirm there"
        ));
    }
}

/// Whether the run ends with an error, because the user wants one where the accuracy is missed.
///
/// # Errors
/// [`Missed`].
pub fn strict(asked: bool, verdict: &ErrorSummary, output: &Path) -> anyhow::Result<()> {
    match asked && !verdict.met() {
        true => Err(Missed(format!("{} is whole, but {}", output.display(), verdict.words())).into()),
        false => Ok(()),
    }
}

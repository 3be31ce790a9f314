//! The audit after a run, and what is said of errors.

use super::{Voice, instances};
use afmsweep::control::{self, Audited, Controlled};
use afmsweep::engine::{EngineError, Outcome, Progress};
use afmsweep::observe::Status;
use afmsweep::plan::Plan;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// What an audit takes: a share of the run's time, or so many seconds after a short one; and the time in which one core
/// redoes an instance at best, s.
const AUDIT_SHARE: f64 = 0.1;
const AUDIT_SECONDS: f64 = 0.25;
const AUDIT_ONE: f64 = 0.05;

/// The audit: as many instances as asked for; else those that are done when its time is over, and where that was none
/// (a slow machine), one for each core in up to four times as long.
pub fn redo(
    asked: Option<u32>,
    run: &Controlled,
    stepping: f64,
    progress: &Progress,
) -> Result<Vec<Audited>, EngineError> {
    let redo = |count: usize, progress: &Progress| {
        control::audit(&run.plan, &run.outcome, &run.found, count, progress)
    };
    if let Some(count) = asked {
        return redo(count as usize, progress);
    }
    let limit = Duration::from_secs_f64((AUDIT_SHARE * stepping).max(AUDIT_SECONDS));
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let each = (limit.as_secs_f64() / AUDIT_ONE).min(64.0) as usize;
    let done = within(limit, progress, |watched| redo(cores * each, watched))?;
    match done.is_empty() && !progress.stopped() {
        true => within(4 * limit, progress, |watched| redo(cores, watched)),
        false => Ok(done),
    }
}

/// Does `work`, which is stopped when its time is over or the run is.
fn within<T>(limit: Duration, progress: &Progress, work: impl FnOnce(&Progress) -> T) -> T {
    let start = Instant::now();
    let (watched, over) = (progress.fork(), AtomicBool::new(false));
    std::thread::scope(|scope| {
        scope.spawn(|| {
            while !over.load(Ordering::Relaxed) {
                if start.elapsed() > limit || progress.stopped() {
                    watched.stop();
                }
                std::thread::sleep(Duration::from_millis(5));
            }
        });
        let done = work(&watched);
        over.store(true, Ordering::Relaxed);
        done
    })
}

/// What is known of the errors.
pub fn accuracy(
    plan: &Plan,
    outcome: &Outcome,
    estimates: &[f64],
    (audited, told_not_to): (&[Audited], bool),
    voice: Voice,
) {
    let ok = |i: &usize| outcome.results[*i].status == Status::Ok && estimates[*i].is_finite();
    let mut known: Vec<f64> = (0..estimates.len()).filter(ok).map(|i| estimates[i]).collect();
    known.sort_by(f64::total_cmp);
    if let (Some(middle), Some(last)) = (known.get(known.len() / 2), known.last()) {
        voice.say(format_args!(
            "estimated error: median {middle:.1e}, largest {last:.1e} of {}; asked for {:e}",
            instances(known.len()),
            plan.run.accuracy
        ));
    }
    let redone: Vec<f64> = audited.iter().filter_map(|one| one.worst).collect();
    if audited.is_empty() && !told_not_to && !known.is_empty() {
        voice.say(format_args!(
            "audit: no instance could be redone in half of the run's time or {} s; --audit 4 redoes four all the same",
            5.0 * AUDIT_SECONDS
        ));
    }
    if !audited.is_empty() {
        let largest = redone.iter().copied().fold(0.0, f64::max);
        let doubtful = audited.len() - redone.len();
        let rest = if doubtful > 0 {
            format!("; {doubtful} not steady or else not to be compared")
        } else {
            String::new()
        };
        voice.say(format_args!(
            "audit: {} redone by the reference engine, largest error {largest:.1e}{rest}",
            instances(audited.len())
        ));
    }
}

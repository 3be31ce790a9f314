//! The choice of instances for the audit, and its time limits.

use super::Audit;
use crate::clock::Instant;
use crate::control::{self, AuditBudget, AuditedInstance, ChunkJournal, JournaledRun};
use crate::engine::{EngineError, Progress, while_watched};
use std::time::Duration;

/// Share of the stepping time that an audit takes. README and the command line's help state it, and [`AUDIT_SECONDS`].
pub const AUDIT_SHARE: f64 = 0.1;
/// Time of an audit after a short run, s.
pub const AUDIT_SECONDS: f64 = 0.25;
/// Shortest time in which one core redoes an instance, s.
const REDO_SECONDS: f64 = 0.05;
/// Longest time to look for one instance that touches the sample, s.
pub const CONTACT_SEARCH_SECONDS: f64 = 60.0;

/// Redoes the requested number of instances; else those that fit into the time limit, and at least one that touches the
/// sample, if any does. `stepping` is the time of the run, s. For a stopped run, returns the instances already redone.
pub(super) fn redo(
    asked: Audit,
    run: &JournaledRun,
    stepping: f64,
    keep: &dyn ChunkJournal,
    progress: &Progress,
) -> Result<Vec<AuditedInstance>, EngineError> {
    match asked {
        Audit::None => Ok(Vec::new()),
        _ if progress.stopped() => {
            let mut known = keep.redone();
            known.retain(|i| (*i as usize) < run.len());
            control::audit_of_run(run, &known, keep, progress)
        }
        Audit::Instances(count) => {
            let chosen = control::audit_selection(run, count as usize)?;
            control::audit_of_run(run, &chosen, keep, progress)
        }
        Audit::Auto => by_time(run, stepping, keep, progress),
    }
}

/// Instances and time of an earlier, interrupted audit count. The audit thus ends about where an undisturbed one does.
fn by_time(
    run: &JournaledRun,
    stepping: f64,
    keep: &dyn ChunkJournal,
    progress: &Progress,
) -> Result<Vec<AuditedInstance>, EngineError> {
    let begun = AuditBudget { limit: (AUDIT_SHARE * stepping).max(AUDIT_SECONDS), spent: 0.0 };
    let AuditBudget { limit, spent } = keep.allowance().unwrap_or(begun);
    let threads = rayon::current_num_threads();
    let each = (limit / REDO_SECONDS).min(64.0) as usize;
    let rest = Duration::from_secs_f64((limit - spent).max(0.0));
    let tell = |so_far: Duration| {
        if keep.spent(AuditBudget { limit, spent: spent + so_far.as_secs_f64() }).is_break() {
            progress.stop();
        }
    };
    let mut done = within((rest, &tell), progress, |watched| {
        let chosen = control::audit_selection(run, threads * each)?;
        control::audit_of_run(run, &chosen, keep, watched)
    })?;
    let contact = |one: &AuditedInstance| one.worst.is_some() && one.touches();
    let start = Instant::now();
    if done.iter().any(contact) || progress.stopped() {
        return Ok(done);
    }
    let mut left = control::contacts_by_cost(run)?;
    left.retain(|i| done.iter().all(|one| one.instance != *i));
    for some in left.chunks(threads) {
        let spent = start.elapsed().as_secs_f64();
        if done.iter().any(contact) || progress.stopped() || spent > CONTACT_SEARCH_SECONDS {
            break;
        }
        let rest = Duration::from_secs_f64(CONTACT_SEARCH_SECONDS - spent);
        done.extend(within((rest, &|_| ()), progress, |watched| {
            control::audit_of_run(run, some, keep, watched)
        })?);
    }
    done.sort_unstable_by_key(|one| one.instance);
    Ok(done)
}

/// Interval between looks at the time limit.
const WATCH_INTERVAL: Duration = Duration::from_millis(5);
/// Interval between records of the time spent.
const WRITE_INTERVAL: Duration = Duration::from_secs(1);

/// Does `work` and stops it at the time limit or with the run. Calls `tell` with the elapsed time at intervals and at the
/// end.
fn within<T>(
    (limit, tell): (Duration, &(dyn Fn(Duration) + Sync)),
    progress: &Progress,
    work: impl FnOnce(&Progress) -> T,
) -> T {
    let start = Instant::now();
    let watched = progress.fork();
    if limit.is_zero() || progress.stopped() {
        watched.stop();
    }
    let mut told = WRITE_INTERVAL;
    let watch = || {
        if start.elapsed() > limit || progress.stopped() {
            watched.stop();
        }
        if start.elapsed() > told {
            tell(start.elapsed());
            told += WRITE_INTERVAL;
        }
    };
    let done = while_watched(WATCH_INTERVAL, watch, || work(&watched));
    if !progress.stopped() {
        tell(start.elapsed());
    }
    done
}

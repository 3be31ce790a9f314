//! Which instances a sweep has redone by the reference engine, and how long that may take.

use super::Audit;
use crate::control::{self, AuditBudget, AuditedInstance, ChunkJournal, JournaledRun};
use crate::engine::{EngineError, Progress};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// What an audit takes of the stepping's time. README and the command line's help tell it, as they tell [`AUDIT_SECONDS`].
pub const AUDIT_SHARE: f64 = 0.1;
/// What it takes after a short run, s.
pub const AUDIT_SECONDS: f64 = 0.25;
/// In which one core redoes an instance at best, s.
const REDO_SECONDS: f64 = 0.05;
/// The longest that it looks for one instance that touches the sample, s.
pub const CONTACT_SEARCH_SECONDS: f64 = 60.0;

/// As many instances as asked for; else those that are done when its time is over, and at least one that touches the
/// sample, where the run has one. `stepping` is what the run took, s. Of a run that was stopped before, what is known.
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

/// What a run that goes on has redone before counts, as does the time that it took; so it ends about where one that nobody
/// disturbs does.
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

/// How often it is written down what was spent.
const WRITE_INTERVAL: Duration = Duration::from_secs(1);

/// Does `work`, which is stopped when its time is over or the run is; `tell` hears now and then, and at the end, how long it
/// has taken.
fn within<T>(
    (limit, tell): (Duration, &(dyn Fn(Duration) + Sync)),
    progress: &Progress,
    work: impl FnOnce(&Progress) -> T,
) -> T {
    let start = Instant::now();
    let (watched, over) = (progress.fork(), AtomicBool::new(false));
    if limit.is_zero() {
        watched.stop();
    }
    let done = std::thread::scope(|scope| {
        scope.spawn(|| {
            let mut told = WRITE_INTERVAL;
            while !over.load(Ordering::Relaxed) {
                if start.elapsed() > limit || progress.stopped() {
                    watched.stop();
                }
                if start.elapsed() > told {
                    tell(start.elapsed());
                    told += WRITE_INTERVAL;
                }
                std::thread::sleep(Duration::from_millis(5));
            }
        });
        let done = work(&watched);
        over.store(true, Ordering::Relaxed);
        done
    });
    if !progress.stopped() {
        tell(start.elapsed());
    }
    done
}

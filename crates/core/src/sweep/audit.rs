//! Which instances a sweep has redone by the reference engine, and how long that may take.

use super::Audit;
use crate::control::{self, Audited, Controlled};
use crate::engine::{EngineError, Progress};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// What an audit takes of the stepping's time. README and the command line's help tell it, as they tell [`SECONDS`].
pub const SHARE: f64 = 0.1;
/// What it takes after a short run, s.
pub const SECONDS: f64 = 0.25;
/// In which one core redoes an instance at best, s.
const ONE: f64 = 0.05;
/// The longest that it looks for one instance that touches the sample, s.
pub const CONTACT: f64 = 60.0;

/// As many instances as asked for; else those that are done when its time is over, and at least one that touches the
/// sample, where the run has one. `stepping` is what the run took, s.
pub(super) fn redo(
    asked: Audit,
    run: &Controlled,
    stepping: f64,
    progress: &Progress,
) -> Result<Vec<Audited>, EngineError> {
    match asked {
        Audit::None => return Ok(Vec::new()),
        Audit::Instances(count) => {
            return control::audit(run, count as usize, progress);
        }
        Audit::Auto => {}
    }
    let limit = Duration::from_secs_f64((SHARE * stepping).max(SECONDS));
    let threads = rayon::current_num_threads();
    let each = (limit.as_secs_f64() / ONE).min(64.0) as usize;
    let mut done = within(limit, progress, |watched| control::audit(run, threads * each, watched))?;
    let contact = |one: &Audited| one.worst.is_some() && one.touches();
    let start = Instant::now();
    let mut left = control::contacts(run);
    left.retain(|i| done.iter().all(|one| one.instance != *i));
    for some in left.chunks(threads) {
        let spent = start.elapsed().as_secs_f64();
        if done.iter().any(contact) || progress.stopped() || spent > CONTACT {
            break;
        }
        let rest = Duration::from_secs_f64(CONTACT - spent);
        done.extend(within(rest, progress, |watched| control::audit_of(run, some, watched))?);
    }
    done.sort_unstable_by_key(|one| one.instance);
    Ok(done)
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

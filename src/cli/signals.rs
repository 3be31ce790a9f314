//! Ctrl-C, the end that a batch queue sets and a terminal that closes: a run ends early and keeps what is complete.

use super::Verbosity;
use afmsweep::engine::Progress;
use std::sync::atomic::{AtomicBool, AtomicI32, Ordering};
use std::sync::{Arc, OnceLock};
use std::time::Duration;

/// What asked a run to end: its number on every system that has signals, and what became of the run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Signal {
    number: i32,
    pub word: &'static str,
}

impl Signal {
    /// Ctrl-C, SIGINT.
    pub const INTERRUPT: Self = Self { number: 2, word: "interrupted" };
    /// SIGTERM, as `kill`, `timeout` and batch queues send it.
    const TERMINATE: Self = Self { number: 15, word: "terminated" };
    /// SIGHUP, of a terminal that closes.
    const HANG_UP: Self = Self { number: 1, word: "hung up" };
    const ALL: [Self; 3] = [Self::INTERRUPT, Self::TERMINATE, Self::HANG_UP];

    /// The exit code by which shells know it.
    pub fn code(self) -> u8 {
        128 + self.number as u8
    }
}

/// The run to be stopped, the number of the signal that came first (0: none), and whether a second one has to wait.
static PROGRESS: OnceLock<Arc<Progress>> = OnceLock::new();
static FIRST: AtomicI32 = AtomicI32::new(0);
static HELD: AtomicBool = AtomicBool::new(false);

/// From here on the first signal asks `progress` to stop, and a second one ends the program at once.
pub fn listen(progress: &Arc<Progress>, voice: Verbosity) {
    if PROGRESS.set(Arc::clone(progress)).is_err() {
        return;
    }
    system::listen();
    // A handler may do next to nothing: the words are this thread's.
    std::thread::spawn(move || {
        while FIRST.load(Ordering::Relaxed) == 0 {
            std::thread::sleep(Duration::from_millis(20));
        }
        voice
            .say("stopping, and keeping what is complete; a second signal (Ctrl-C) ends the program at once");
    });
}

/// The signal that came first, if one came.
pub fn first() -> Option<Signal> {
    let number = FIRST.load(Ordering::Relaxed);
    Signal::ALL.into_iter().find(|signal| signal.number == number)
}

/// Does `work`, which takes a moment and which a second signal does not cut short: a file is not left half written.
pub fn held<T>(work: impl FnOnce() -> T) -> T {
    HELD.store(true, Ordering::Relaxed);
    let done = work();
    HELD.store(false, Ordering::Relaxed);
    done
}

/// Takes in a signal; true if it is to end the program at once. Nothing here allocates, locks or calls the system.
fn came(number: i32) -> bool {
    let second = FIRST.compare_exchange(0, number, Ordering::Relaxed, Ordering::Relaxed).is_err();
    if let Some(progress) = PROGRESS.get() {
        progress.stop();
    }
    second && !HELD.load(Ordering::Relaxed)
}

#[cfg(unix)]
mod system {
    use super::{Signal, came};

    extern "C" fn handler(number: libc::c_int) {
        if came(number) {
            // SAFETY: _exit may be called from a handler; it ends the program.
            unsafe { libc::_exit(128 + number) }
        }
    }

    pub fn listen() {
        for signal in Signal::ALL {
            let number = signal.number;
            // SAFETY: zeros are a valid `sigaction`; the pointers are to live values of this function; the handler
            // does nothing that a handler must not do.
            unsafe {
                let mut action: libc::sigaction = std::mem::zeroed();
                libc::sigaction(number, std::ptr::null(), &raw mut action);
                // `nohup` ignores hang-ups for those it starts.
                if signal == Signal::HANG_UP && action.sa_sigaction == libc::SIG_IGN {
                    continue;
                }
                action = std::mem::zeroed();
                action.sa_sigaction = handler as extern "C" fn(libc::c_int) as libc::sighandler_t;
                action.sa_flags = libc::SA_RESTART;
                libc::sigemptyset(&raw mut action.sa_mask);
                libc::sigaction(number, &raw const action, std::ptr::null_mut());
            }
        }
    }
}

#[cfg(not(unix))]
mod system {
    use super::{Signal, came};

    pub fn listen() {
        let number = Signal::INTERRUPT.number;
        let asked = ctrlc::set_handler(move || {
            if came(number) {
                std::process::exit(128 + number);
            }
        });
        // Without a handler Ctrl-C ends the program at once, which is what it does everywhere.
        drop(asked);
    }
}

//! How far a run is: a bar on a terminal, plain lines elsewhere; and Ctrl-C.

use super::{Voice, say};
use afmsweep::engine::Progress;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::{IsTerminal, Write};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Shows a run's progress until dropped or finished.
pub struct Shown {
    over: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

/// Between two plain lines.
const EVERY: Duration = Duration::from_secs(5);

impl Shown {
    /// Watches `progress` towards the instance-steps it expects.
    pub fn start(progress: Arc<Progress>, voice: Voice) -> Self {
        let over = Arc::new(AtomicBool::new(false));
        if voice.quiet {
            return Self { over, thread: None };
        }
        let ended = Arc::clone(&over);
        let thread = std::thread::spawn(move || {
            if std::io::stderr().is_terminal() { bar(&progress, &ended) } else { lines(&progress, &ended) }
        });
        Self { over, thread: Some(thread) }
    }
}

impl Drop for Shown {
    fn drop(&mut self) {
        self.over.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            // A display that failed is no reason to lose a run.
            let _ = thread.join();
        }
    }
}

fn bar(progress: &Progress, over: &AtomicBool) {
    let style = ProgressStyle::with_template("{bar:40} {percent:>3} %  {msg}  {eta} left")
        .unwrap_or_else(|_| ProgressStyle::default_bar());
    let bar = ProgressBar::with_draw_target(Some(1), ProgressDrawTarget::stderr()).with_style(style);
    let start = Instant::now();
    while !over.load(Ordering::Relaxed) {
        let steps = progress.steps();
        bar.set_length(progress.expected().max(steps).max(1));
        bar.set_position(steps);
        bar.set_message(rate(steps, start));
        std::thread::sleep(Duration::from_millis(50));
    }
    bar.finish_and_clear();
}

fn lines(progress: &Progress, over: &AtomicBool) {
    let start = Instant::now();
    let mut next = EVERY;
    while !over.load(Ordering::Relaxed) {
        if start.elapsed() >= next {
            next += EVERY;
            let steps = progress.steps();
            let percent = 100.0 * steps as f64 / progress.expected().max(steps).max(1) as f64;
            say(format_args!("{percent:3.0} %  {}", rate(steps, start)));
        }
        std::thread::sleep(Duration::from_millis(10));
    }
}

fn rate(steps: u64, start: Instant) -> String {
    format!("{:.2e} instance-steps/s", steps as f64 / start.elapsed().as_secs_f64().max(1e-9))
}

/// Ctrl-C ends the run early and keeps what is complete; a second one ends the program.
pub fn on_interrupt(progress: &Arc<Progress>) {
    let progress = Arc::clone(progress);
    let asked = ctrlc::set_handler(move || {
        if progress.stopped() {
            std::process::exit(130);
        }
        progress.stop();
        // Standard error may be gone; the run still ends.
        let _ = writeln!(std::io::stderr(), "stopping; Ctrl-C again ends the program at once");
    });
    // Without a handler Ctrl-C ends the program at once, which is what it does everywhere.
    drop(asked);
}

//! How far a run is: a bar on a terminal, plain lines elsewhere.

use super::{Verbosity, say};
use afmsweep::engine::{Progress, ProgressPhase};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Shows a run's progress until dropped or finished.
pub struct ProgressDisplay {
    over: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

/// Between two plain lines.
const EVERY: Duration = Duration::from_secs(5);

impl ProgressDisplay {
    /// Watches `progress` towards the instance-steps it expects.
    pub fn start(progress: Arc<Progress>, voice: Verbosity) -> Self {
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

impl Drop for ProgressDisplay {
    fn drop(&mut self) {
        self.over.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            // A display that failed is no reason to lose a run.
            let _ = thread.join();
        }
    }
}

/// One bar for each phase, under its name.
fn bar(progress: &Progress, over: &AtomicBool) {
    let style = ProgressStyle::with_template("{prefix:24} {bar:30}  {msg}")
        .unwrap_or_else(|_| ProgressStyle::default_bar());
    let bar = ProgressBar::with_draw_target(Some(1000), ProgressDrawTarget::stderr()).with_style(style);
    let start = Instant::now();
    let mut meter = Meter::default();
    while !over.load(Ordering::Relaxed) {
        meter.see(progress.phase(), start.elapsed());
        bar.set_position((1000.0 * meter.share.unwrap_or(0.0)) as u64);
        bar.set_prefix(meter.name.clone());
        bar.set_message(format!("{}{}", meter.words(start.elapsed()), rate(progress.steps(), start)));
        std::thread::sleep(Duration::from_millis(50));
    }
    bar.finish_and_clear();
}

/// A line now and then, each with the name of its phase.
fn lines(progress: &Progress, over: &AtomicBool) {
    let start = Instant::now();
    let mut next = EVERY;
    let mut meter = Meter::default();
    while !over.load(Ordering::Relaxed) {
        meter.see(progress.phase(), start.elapsed());
        if start.elapsed() >= next {
            next += EVERY;
            let words = meter.words(start.elapsed());
            say(format_args!("{}: {words}{}", meter.name, rate(progress.steps(), start)));
        }
        std::thread::sleep(Duration::from_millis(10));
    }
}

/// What is shown of a phase: within one it only grows.
#[derive(Debug, Default)]
struct Meter {
    number: Option<u64>,
    name: String,
    /// When it began.
    since: Duration,
    share: Option<f64>,
}

/// Below this share and time of a phase nobody can say how long it will take.
const KNOWN: (f64, Duration) = (0.02, Duration::from_secs(1));

impl Meter {
    /// Takes in how far the run is.
    fn see(&mut self, phase: ProgressPhase, now: Duration) {
        if self.number != Some(phase.number) {
            *self = Self { number: Some(phase.number), name: phase.name, since: now, share: None };
        }
        // More work may turn up on the way; and what is not over is not whole.
        self.share = match (self.share, phase.share) {
            (Some(before), Some(share)) => Some(before.max(share.min(0.99))),
            (before, share) => before.or(share.map(|share| share.min(0.99))),
        };
    }

    /// Percent and time left of the phase, as far as they are known; else the time that it has taken.
    fn words(&self, now: Duration) -> String {
        let spent = now.saturating_sub(self.since);
        let Some(share) = self.share else { return format!("{:.0} s  ", spent.as_secs_f64()) };
        let percent = format!("{:3.0} %  ", (100.0 * share).floor());
        let left = spent.as_secs_f64() * (1.0 - share) / share.max(f64::MIN_POSITIVE);
        match share > KNOWN.0 && spent > KNOWN.1 && left >= 1.0 {
            true => format!("{percent}{} left  ", time(left)),
            false => percent,
        }
    }
}

/// Seconds as people say them.
fn time(seconds: f64) -> String {
    match seconds {
        s if s < 90.0 => format!("{s:.0} s"),
        s if s < 5400.0 => format!("{:.0} min", s / 60.0),
        s => format!("{:.0} h", s / 3600.0),
    }
}

fn rate(steps: u64, start: Instant) -> String {
    format!("{:.2e} instance-steps/s", steps as f64 / start.elapsed().as_secs_f64().max(1e-9))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is shown goes back in no phase, whatever turns up, and nowhere is no time left.
    #[test]
    fn what_is_shown_of_a_phase_only_grows() {
        let (mut meter, mut shown) = (Meter::default(), Vec::new());
        let shares = [None, Some(0.1), Some(0.8), Some(0.4), Some(1.0), Some(0.7), Some(1.0)];
        for number in 1..=2 {
            for (second, share) in shares.into_iter().enumerate() {
                let phase = ProgressPhase { number, name: format!("part {number}"), share };
                let now = Duration::from_secs(10 * number + second as u64);
                meter.see(phase, now);
                shown.push((meter.name.clone(), meter.share.unwrap_or(0.0)));
                let words = meter.words(now);
                assert!(!words.contains(" 0 s left") && !words.contains("100 %"), "{words}");
            }
        }
        for pair in shown.windows(2) {
            assert!(pair[0].0 != pair[1].0 || pair[0].1 <= pair[1].1, "{pair:?}");
        }
        assert_eq!(shown[7], ("part 2".to_owned(), 0.0), "another phase begins anew");
    }

    #[test]
    fn the_time_left_is_that_of_the_phase() {
        let mut meter = Meter::default();
        let phase = |share| ProgressPhase { number: 3, name: "run".into(), share: Some(share) };
        meter.see(phase(0.0), Duration::from_secs(100));
        meter.see(phase(0.25), Duration::from_secs(110));
        assert_eq!(meter.words(Duration::from_secs(110)), " 25 %  30 s left  ");
    }
}

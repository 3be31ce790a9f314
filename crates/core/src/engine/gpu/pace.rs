//! Steps of a dispatch, chosen by its time, so that no driver thinks the device has hung.

use std::time::Duration;

/// Time a dispatch should take; drivers give up after about two seconds.
const TARGET: Duration = Duration::from_millis(100);

/// Most iterations of a shader's loop: lavapipe (Mesa's driver that computes on the processor) silently ends a dispatch's
/// loops after 65,535.
const TURNS_SOFTWARE: u32 = 30_000;
const TURNS: u32 = 1 << 20;

/// Steps per dispatch, adapted to the time of the last ones.
#[derive(Clone, Debug)]
pub(super) struct Pace {
    steps: f64,
    most: u32,
    target: f64,
}

impl Pace {
    pub fn new(software: bool) -> Self {
        let most = if software { TURNS_SOFTWARE } else { TURNS };
        Self { steps: 0.0, most, target: TARGET.as_secs_f64() }
    }

    /// Steps of the next dispatch, `first` steps into a period of `steps`: whole periods unless they are too long, else part
    /// of one.
    pub fn steps(&mut self, steps: u32, first: u32, longest: u32) -> u64 {
        if self.steps == 0.0 {
            // The device is unknown: tries one period if allowed.
            self.steps = f64::from(steps);
        }
        let most = self.most.min(longest);
        let now = (self.steps as u32).clamp(1, most);
        let rest = steps - first;
        let count = match now.checked_sub(rest) {
            Some(beyond) => rest + beyond / steps * steps,
            None => now,
        };
        u64::from(count)
    }

    /// Records that a dispatch of `count` steps took this time.
    pub fn took(&mut self, count: u64, time: Duration) {
        let factor = self.target / time.as_secs_f64().max(1e-6);
        self.steps = (count as f64 * factor.clamp(0.25, 4.0)).clamp(1.0, f64::from(self.most));
    }

    /// Makes dispatches shorter after a failure.
    pub fn slow_down(&mut self) {
        self.target *= 0.5;
        self.steps = (0.25 * self.steps).max(1.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whole_periods_where_they_fit() {
        let mut pace = Pace::new(true);
        assert_eq!(pace.steps(256, 0, u32::MAX), 256);
        pace.took(256, Duration::from_millis(10));
        assert_eq!(pace.steps(256, 0, u32::MAX), 1024);
        // Never more iterations than a software driver can do, nor than the table of decays holds.
        for _ in 0..20 {
            pace.took(1 << 20, Duration::from_micros(1));
        }
        assert_eq!(pace.steps(256, 0, u32::MAX), 29_952);
        assert_eq!(pace.steps(256, 0, 1000), 768);
        // A longer period is split into parts that end with it.
        assert_eq!(pace.steps(65_536, 0, u32::MAX), 30_000);
        assert_eq!(pace.steps(65_536, 60_000, u32::MAX), 5_536);
        // A slow device gets part of a period.
        for _ in 0..20 {
            pace.took(pace.steps as u64, Duration::from_secs(1));
        }
        assert_eq!(pace.steps(256, 0, u32::MAX), 1);
    }
}

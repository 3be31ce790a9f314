//! The state of an engine's devices: which are free, how fast each is relative to the others, and which are lost.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// Consecutive failures of a device after which it gets no more work.
pub(super) const TRIES: u32 = 3;

/// Least assumed speed of a device, as a share of the mean.
const FEWEST: f64 = 0.05;

/// The state of a device.
#[derive(Clone, Debug)]
struct State {
    /// Whether an attempt was made to open it.
    tried: bool,
    busy: bool,
    lost: bool,
    failures: u32,
    /// Whether it was lost before and has done nothing since.
    frail: bool,
    /// Relative to the other devices.
    speed: f64,
    /// Instance-steps.
    taken: u64,
}

/// Leases devices to runs that have work for one.
#[derive(Debug)]
pub(super) struct Dealer {
    devices: Mutex<Vec<State>>,
    freed: Condvar,
    /// Runs in progress.
    runs: AtomicUsize,
    /// Whether the user knows that only the CPU is left.
    said: AtomicBool,
}

/// A device's work on a class: device, instance-steps and time.
pub(super) type Did = (usize, u64, Duration);

impl Dealer {
    pub fn new(count: usize) -> Self {
        let state =
            State { tried: false, busy: false, lost: false, failures: 0, frail: false, speed: 1.0, taken: 0 };
        let devices = Mutex::new(vec![state; count]);
        Self { devices, freed: Condvar::new(), runs: AtomicUsize::new(0), said: AtomicBool::new(false) }
    }

    fn states(&self) -> MutexGuard<'_, Vec<State>> {
        self.devices.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Begins a run, which ends when the returned guard is dropped.
    pub fn enter(&self) -> Entered<'_> {
        self.runs.fetch_add(1, Ordering::Relaxed);
        Entered(self)
    }

    /// The devices that a run may expect beside the other runs, with their speeds, fastest first.
    pub fn speeds(&self) -> Vec<(usize, f64)> {
        let states = self.states();
        let holding = states.iter().enumerate().filter(|(_, one)| !one.lost);
        let mut speeds: Vec<(usize, f64)> = holding.map(|(place, one)| (place, one.speed)).collect();
        speeds.sort_by(|a, b| b.1.total_cmp(&a.1));
        let runs = self.runs.load(Ordering::Relaxed).max(1);
        speeds.truncate((speeds.len() / runs).max(1));
        speeds
    }

    /// Number of devices that are not lost.
    pub fn holding(&self) -> usize {
        self.states().iter().filter(|one| !one.lost).count()
    }

    /// Leases all devices that were never opened.
    pub fn untried(&self) -> Vec<usize> {
        let mut states = self.states();
        let mut untried = Vec::new();
        for (place, one) in states.iter_mut().enumerate().filter(|(_, one)| !one.tried) {
            (one.tried, one.busy) = (true, true);
            untried.push(place);
        }
        untried
    }

    /// Leases this device if it is free, else the fastest free one, and waits for one if none is. `None` if all are lost.
    pub fn lease(&self, meant: usize) -> Option<usize> {
        let mut states = self.states();
        loop {
            if states.iter().all(|one| one.lost) {
                return None;
            }
            let free = states.iter_mut().enumerate().filter(|(_, one)| !one.busy && !one.lost);
            let best = free.max_by(|a, b| {
                let meant = (a.0 == meant).cmp(&(b.0 == meant));
                meant.then(a.1.speed.total_cmp(&b.1.speed)).then(b.0.cmp(&a.0))
            });
            if let Some((place, one)) = best {
                one.busy = true;
                return Some(place);
            }
            states = self.freed.wait(states).unwrap_or_else(PoisonError::into_inner);
        }
    }

    fn end(&self, place: usize, change: impl FnOnce(&mut State)) {
        if let Some(one) = self.states().get_mut(place) {
            one.busy = false;
            change(one);
        }
        self.freed.notify_all();
    }

    /// Frees a device.
    pub fn give_back(&self, place: usize) {
        self.end(place, |_| ());
    }

    /// Frees a device that did these instance-steps.
    pub fn did(&self, place: usize, steps: u64) {
        self.said.store(false, Ordering::Relaxed);
        self.end(place, |one| (one.failures, one.frail, one.taken) = (0, false, one.taken + steps));
    }

    /// Frees a device that failed. Returns whether it counts as lost now.
    pub fn failed(&self, place: usize) -> bool {
        let mut lost = false;
        self.end(place, |one| {
            one.failures += 1;
            one.lost = one.failures >= TRIES;
            lost = one.lost;
        });
        lost
    }

    /// Marks a device as lost.
    pub fn lost(&self, place: usize) {
        self.end(place, |one| one.lost = true);
    }

    /// If all devices are lost, gives another try to those that have worked since they were last lost.
    pub fn begin_anew(&self) {
        let mut states = self.states();
        if states.iter().all(|one| one.lost) {
            let firm = states.iter_mut().filter(|one| !one.frail);
            firm.for_each(|one| (one.lost, one.failures, one.frail) = (false, 0, true));
        }
    }

    /// Whether the user does not know yet that only the CPU is left.
    pub fn is_news(&self) -> bool {
        !self.said.swap(true, Ordering::Relaxed)
    }

    /// Updates relative speeds from the work of several devices on one class.
    pub fn learn(&self, did: &[Did]) {
        let mut states = self.states();
        let mut rates = vec![(0.0, 0.0); states.len()];
        for (place, steps, time) in did {
            rates[*place].0 += *steps as f64;
            rates[*place].1 += time.as_secs_f64();
        }
        let seen: Vec<(usize, f64)> = rates
            .iter()
            .enumerate()
            .filter(|(_, one)| one.0 > 0.0)
            .map(|(n, one)| (n, one.0 / one.1.max(1e-6)))
            .collect();
        if seen.len() < 2 {
            return;
        }
        let mean: f64 = seen.iter().map(|one| one.1).sum::<f64>() / seen.len() as f64;
        let before: f64 = seen.iter().map(|one| states[one.0].speed).sum::<f64>() / seen.len() as f64;
        for (place, rate) in seen {
            let speed = &mut states[place].speed;
            // A device that was slow once still gets some work, to show whether it still is.
            *speed = (0.5 * (*speed + before * rate / mean)).max(FEWEST * before);
        }
    }

    /// Sets the assumed speeds of the devices.
    pub fn suppose(&self, speeds: &[f64]) {
        self.states().iter_mut().zip(speeds).for_each(|(one, speed)| one.speed = *speed);
    }

    /// Instance-steps of each device.
    pub fn taken(&self) -> Vec<u64> {
        self.states().iter().map(|one| one.taken).collect()
    }
}

/// A run in progress.
pub(super) struct Entered<'a>(&'a Dealer);

impl Drop for Entered<'_> {
    fn drop(&mut self) {
        self.0.runs.fetch_sub(1, Ordering::Relaxed);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn speeds_follow_what_devices_did_of_one_class() {
        let dealer = Dealer::new(3);
        let second = Duration::from_secs(1);
        // The first is four times as fast as the second; the third is unknown.
        for _ in 0..20 {
            dealer.learn(&[(0, 200, second), (1, 50, second), (1, 50, second)]);
        }
        let speeds = dealer.speeds();
        assert_eq!(speeds.iter().map(|one| one.0).collect::<Vec<_>>(), [0, 2, 1]);
        assert!((speeds[0].1 / speeds[2].1 - 4.0).abs() < 1e-3 && speeds[1].1 == 1.0, "{speeds:?}");
        // A device that was stuck once gets work again.
        let stuck = Dealer::new(2);
        (0..50).for_each(|_| stuck.learn(&[(0, 1_000_000, second), (1, 1, second)]));
        assert!(stuck.speeds()[1].1 > 0.02 * stuck.speeds()[0].1, "{:?}", stuck.speeds());
        // One device alone gives no relative speed.
        dealer.learn(&[(2, 1_000_000, second)]);
        assert_eq!(dealer.speeds(), speeds);
        assert_eq!([2, 2, 2].map(|meant| dealer.lease(meant)), [Some(2), Some(0), Some(1)]);
    }

    #[test]
    fn a_run_beside_others_counts_on_its_part_of_the_devices() {
        let dealer = Dealer::new(4);
        let first = dealer.enter();
        assert_eq!(dealer.speeds().len(), 4);
        let second = dealer.enter();
        assert_eq!(dealer.speeds().len(), 2);
        let others: Vec<_> = (0..7).map(|_| dealer.enter()).collect();
        assert_eq!(dealer.speeds().len(), 1);
        drop((others, second, first));
        assert_eq!(dealer.speeds().len(), 4);
    }

    #[test]
    fn a_device_that_fails_again_and_again_gets_no_more_work() {
        let dealer = Dealer::new(2);
        dealer.suppose(&[1.0, 2.0]);
        for last in [false, false, true] {
            assert_eq!(dealer.lease(1), Some(1));
            assert_eq!(dealer.failed(1), last);
        }
        assert_eq!(dealer.lease(1), Some(0));
        dealer.did(0, 7);
        assert_eq!((dealer.holding(), dealer.taken()), (1, vec![7, 0]));
        dealer.lost(0);
        assert_eq!(dealer.lease(1), None);
        // It gets another try once, and again only after it has done something.
        dealer.begin_anew();
        assert_eq!(dealer.holding(), 2);
        assert_eq!(dealer.lease(0), Some(0));
        dealer.did(0, 1);
        (0..2).for_each(|place| dealer.lost(place));
        dealer.begin_anew();
        assert_eq!((dealer.holding(), dealer.lease(1)), (1, Some(0)));
        dealer.lost(0);
        dealer.begin_anew();
        assert_eq!(dealer.holding(), 0);
    }

    #[test]
    fn what_is_left_to_the_cpu_is_said_once() {
        let dealer = Dealer::new(1);
        assert_eq!([dealer.is_news(), dealer.is_news()], [true, false]);
        dealer.did(0, 1);
        assert!(dealer.is_news());
    }
}

//! Cuts a plan into pieces, which devices take one at a time.

use super::chunk::Checkpoint;
use super::pace::Pace;
use crate::engine::section_state;
use crate::plan::{Class, Plan};

/// Some instances of a class during a run.
pub(super) struct Piece {
    pub class: Class,
    /// Their checkpoint, if not the run's start.
    pub at: Option<Checkpoint>,
    pub pace: Pace,
    /// Number of its class. Pieces of one class allow comparison of the devices' speeds.
    pub group: usize,
    /// The device that it was cut for, if that is free.
    pub meant: usize,
    /// Failures that are due to the piece rather than to a device.
    pub refused: u32,
}

impl Piece {
    /// Periods done.
    pub fn done(&self) -> u32 {
        self.at.as_ref().map_or(0, |at| at.done)
    }

    /// Remaining instance-steps.
    pub fn work(&self, plan: &Plan) -> u64 {
        let periods = u64::from(plan.run.periods - self.done());
        self.class.instances.len() as u64 * u64::from(self.class.steps) * periods
    }

    /// Splits it into two halves.
    pub fn halves(self) -> [Self; 2] {
        let count = self.class.instances.len();
        [0..count / 2, count / 2..count].map(|half| Self {
            class: Class { instances: self.class.instances[half.clone()].to_vec(), ..self.class },
            at: self.at.as_ref().map(|at| at.part(half)),
            pace: self.pace.clone(),
            ..self
        })
    }
}

/// How a plan is cut.
pub(super) struct Cut<'a> {
    /// The devices that take part, with their speeds, fastest first.
    pub devices: &'a [(usize, f64)],
    /// Fewest instances that justify a device of their own.
    pub least: usize,
    /// Whether the devices are software drivers.
    pub software: bool,
}

impl Cut<'_> {
    /// The pieces of a class, of at most `most` instances each.
    pub fn pieces(&self, plan: &Plan, (group, class): (usize, &Class), most: usize) -> Vec<Piece> {
        let mut rest = class.instances.as_slice();
        let mut pieces = Vec::new();
        for (meant, size) in self.sizes(rest.len()) {
            let (own, others) = rest.split_at(size);
            rest = others;
            pieces.extend(own.chunks(most.max(1)).map(|some| Piece {
                class: Class { instances: some.to_vec(), ..*class },
                at: section_state::begin(plan, some).map(|saved| Checkpoint { saved, done: 0 }),
                pace: Pace::new(self.software),
                group,
                meant,
                refused: 0,
            }));
        }
        pieces
    }

    /// Number of instances, out of `count`, for each device.
    fn sizes(&self, count: usize) -> Vec<(usize, usize)> {
        let ways = (count / self.least.max(1)).clamp(1, self.devices.len().max(1));
        let devices = self.devices.get(..ways).unwrap_or(&[(0, 1.0)]);
        let all: f64 = devices.iter().map(|one| one.1).sum();
        let (mut before, mut sum) = (0, 0.0);
        let mut sizes = Vec::with_capacity(ways);
        for (place, speed) in devices {
            sum += speed / all;
            let end = ((count as f64 * sum).round() as usize).clamp(before, count);
            sizes.push((*place, end - before));
            before = end;
        }
        // Rounding must not lose instances.
        if let Some(last) = sizes.last_mut() {
            last.1 += count - before;
        }
        sizes.retain(|one| one.1 > 0);
        sizes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn instances_are_dealt_by_speed_and_none_is_left_out() {
        let sizes = |speeds: &[f64], least, count| -> Vec<usize> {
            let devices: Vec<(usize, f64)> = speeds.iter().copied().enumerate().collect();
            let dealt = Cut { devices: &devices, least, software: true }.sizes(count);
            assert!(dealt.iter().enumerate().all(|(n, one)| n == one.0));
            dealt.into_iter().map(|one| one.1).collect()
        };
        assert_eq!(sizes(&[3.0, 1.0], 10, 400), [300, 100]);
        assert_eq!(sizes(&[1.0, 1.0, 1.0], 1, 100), [33, 34, 33]);
        // Too few for two; for three.
        assert_eq!(sizes(&[1.0, 1.0], 10, 19), [19]);
        assert_eq!(sizes(&[2.0, 1.0, 1.0], 10, 29), [19, 10]);
        assert_eq!(sizes(&[1.0], 10, 7), [7]);
        assert_eq!(sizes(&[1e9, 1.0], 1, 5), [5]);
    }
}

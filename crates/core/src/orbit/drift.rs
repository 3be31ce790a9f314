//! How a motion changes from period to period, and whether it shows signs of settling.

use crate::plan::SectionState;

/// A motion shows no sign of settling if its change per period exceeds this share of that at the last checkpoint ...
const SETTLING_RATIO: f64 = 0.5;
/// ... unless it is a drift, in which each change resembles the one before. Of 554 instances under JKR that never settle nine
/// in ten turn by more than 0.8 of their change.
const MAX_TURN: f64 = 0.5;
/// A motion this still, in accuracies of the free amplitude, is always searched for: it may pass for steady.
const REST_TOL: f64 = 0.3;

/// The change of a motion from period to period.
#[derive(Clone, Copy, Debug)]
pub(super) struct Drift {
    /// Mean change, in free amplitudes.
    pub change: f64,
    /// Change of the change, as a share of it.
    turns: f64,
}

impl Drift {
    /// The drift of section states that are one period apart.
    pub fn of(places: &[SectionState], amplitude: f64) -> Self {
        let numbers = |one: &SectionState| one.x.into_iter().chain(one.u).collect::<Vec<f64>>();
        let all: Vec<Vec<f64>> = places.iter().map(numbers).collect();
        let minus = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a - b).collect::<Vec<f64>>();
        let size = |of: &[f64]| of.iter().map(|number| number * number).sum::<f64>().sqrt();
        let changes: Vec<Vec<f64>> = all.windows(2).map(|two| minus(&two[1], &two[0])).collect();
        let turned: f64 = changes.windows(2).map(|two| size(&minus(&two[1], &two[0]))).sum();
        let mean = changes.iter().map(|change| size(change)).sum::<f64>() / changes.len() as f64;
        Self { change: mean / amplitude, turns: turned / (changes.len() - 1) as f64 / mean }
    }

    /// Whether a motion with this drift, and the drift `before` at the last checkpoint, will not settle.
    pub fn is_unsettled(&self, before: &Self, accuracy: f64) -> bool {
        self.change > REST_TOL * accuracy
            && self.turns > MAX_TURN
            && self.change > SETTLING_RATIO * before.change
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Periods of a look.
    const PERIODS: u32 = 8;

    /// The drift of a motion whose first number is `of(n)` after n periods.
    fn look(of: impl Fn(f64) -> f64) -> Drift {
        let place = |n: u32| {
            let mut station = SectionState::FREE;
            station.x[0] = of(f64::from(n));
            station
        };
        Drift::of(&(0..=PERIODS).map(place).collect::<Vec<_>>(), 1.0)
    }

    #[test]
    fn what_alternates_wanders_and_what_drifts_or_fades_does_not() {
        let (accuracy, turn) = (1e-3, |n: f64| if n % 2.0 == 0.0 { 0.05 } else { -0.05 });
        let alternates = look(turn);
        assert!((alternates.change - 0.1).abs() < 1e-12 && (alternates.turns - 2.0).abs() < 1e-12);
        assert!(alternates.is_unsettled(&alternates, accuracy));
        let drifts = look(|n| 0.01 * n);
        assert!(drifts.turns < 1e-9 && !drifts.is_unsettled(&drifts, accuracy));
        let fades = look(|n| 0.4 * turn(n));
        assert!(!fades.is_unsettled(&alternates, accuracy));
        let still = look(|n| 1e-3 * turn(n));
        assert!(!still.is_unsettled(&still, accuracy));
    }
}

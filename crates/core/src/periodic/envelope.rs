//! Follows the slow motion of a map that is repeated very often, in steps of many periods.
//!
//! N periods of a nearly linear map are one matrix. From x, with residual c and Jacobian J, they lead to x + (1 + J + ... +
//! J^(N-1)) c, where the residual is J^N c. A step takes as many periods as this holds for, and the residual at its end shows
//! whether it did: the exponential Rosenbrock-Euler method (Hochbruck & Ostermann, Acta Numerica 19 (2010) 209) for a
//! difference equation. Motions that turn or fade fast cost nothing, however long the slow motion lasts.

use crate::matrix_product::product;
use nalgebra::{DMatrix, DVector};

/// Allowed error of a step's end, as a share of the step ...
const STEP_ERROR_SHARE: f64 = 0.15;
/// ... or in scales, whichever is larger.
const STEP_ERROR_SCALES: f64 = 1e-9;
/// Longest step, in scales.
const MAX_STEP_SCALES: f64 = 0.3;
/// Doublings of a step's periods: in the first step, and how many a step may have more than the one before.
const FIRST_DOUBLINGS: u32 = 2;
const MAX_MORE_DOUBLINGS: u32 = 3;
/// Most doublings of a step.
const MAX_DOUBLINGS: u32 = 40;
/// The motion has settled if a step over the decay periods leaves less than this share of any deviation.
const FADED_SHARE: f64 = 0.5;
/// From so many evaluations on, following is useless if its periods are below their square over the second number.
const USELESS_EVALUATIONS: (u32, u64) = (8, 32);

/// How following ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EnvelopeEnd {
    /// Close to a fixed point to which the repeated map leads.
    Settled,
    /// The map is undefined, no step succeeds, or all evaluations are spent.
    Failed,
}

/// Options of an [`Envelope`].
#[derive(Clone, Copy, Debug)]
pub struct EnvelopeOptions {
    /// Typical length of a state.
    pub scale: f64,
    /// Periods in which free motion decays.
    pub decay_periods: u32,
    /// Most evaluations.
    pub max_evaluations: u32,
}

/// A step that awaits its evaluation: its end, and the residual there if the map is linear.
#[derive(Clone, Debug)]
struct EnvelopeStep {
    doublings: u32,
    step: DVector<f64>,
    predicted: DVector<f64>,
    /// Effect of a constant push over the step's periods: 1 + J + ... + J^(N-1).
    sum: DMatrix<f64>,
    /// Whether the step leaves next to nothing of any deviation.
    fades: bool,
}

/// A motion that is being followed.
#[derive(Clone, Debug)]
pub struct Envelope {
    options: EnvelopeOptions,
    state: DVector<f64>,
    /// The residual at the state, and the map's Jacobian there.
    change: DVector<f64>,
    jacobian: DMatrix<f64>,
    next_step: Option<EnvelopeStep>,
    end: Option<EnvelopeEnd>,
    evaluations: u32,
    periods: u64,
}

impl Envelope {
    /// Starts at `state`.
    pub fn new(state: DVector<f64>, told: EnvelopeOptions) -> Self {
        let size = state.len();
        Self {
            options: told,
            change: DVector::zeros(size),
            jacobian: DMatrix::zeros(size, size),
            state,
            next_step: None,
            end: None,
            evaluations: 0,
            periods: 0,
        }
    }

    /// The next state at which the map and its Jacobian are needed.
    pub fn ask(&self) -> DVector<f64> {
        match &self.next_step {
            Some(stride) => &self.state + &stride.step,
            None => self.state.clone(),
        }
    }

    /// The state reached.
    pub fn state(&self) -> &DVector<f64> {
        &self.state
    }

    /// How following ended; `None` while it continues.
    pub fn came(&self) -> Option<EnvelopeEnd> {
        self.end
    }

    /// Evaluations so far. Each takes one period.
    pub fn evaluations(&self) -> u32 {
        self.evaluations
    }

    /// Periods of the motion so far.
    pub fn periods(&self) -> u64 {
        self.periods
    }

    /// Takes the value of the map at [`ask`](Self::ask) and its Jacobian there; `None` if the map is undefined there.
    pub fn tell(&mut self, answer: Option<(DVector<f64>, DMatrix<f64>)>) {
        self.evaluations += 1;
        let stride = self.next_step.take();
        let doublings = match (stride, answer) {
            (None, None) => None,
            (None, Some((value, slope))) => {
                (self.change, self.jacobian) = (value - &self.state, slope);
                Some(FIRST_DOUBLINGS)
            }
            (Some(stride), None) => stride.doublings.checked_sub(1),
            (Some(stride), Some((value, slope))) => self.after_step(stride, &value, slope),
        };
        let useless = self.evaluations >= USELESS_EVALUATIONS.0
            && USELESS_EVALUATIONS.1 * self.periods < u64::from(self.evaluations).pow(2);
        let spent = self.evaluations >= self.options.max_evaluations || useless;
        match doublings {
            _ if self.end.is_some() => {}
            Some(doublings) if !spent => self.next_step = Some(self.next_step(doublings)),
            _ => self.end = Some(EnvelopeEnd::Failed),
        }
    }

    /// Evaluates a step, and returns the doublings allowed for the next one.
    fn after_step(&mut self, stride: EnvelopeStep, value: &DVector<f64>, slope: DMatrix<f64>) -> Option<u32> {
        let EnvelopeStep { doublings, step, predicted, sum, fades } = stride;
        let end = &self.state + &step;
        let change = value - &end;
        let pushed = sum * (&change - predicted);
        let off = pushed.norm() / 3.0;
        let allowed = (STEP_ERROR_SHARE * step.norm()).max(STEP_ERROR_SCALES * self.options.scale);
        if off > allowed && doublings > 0 {
            return Some(doublings - 1 - shorter(off / allowed).min(doublings - 1));
        }
        // The error of the map grows with the square of the distance: the mean of (m/N)^2 is a third for large N, and 0 for N
        // = 1. The end moves by that, and its residual changes accordingly.
        let periods = (1u64 << doublings) as f64;
        let miss = pushed * ((periods - 1.0) * (2.0 * periods - 1.0) / (6.0 * periods * periods));
        (self.state, self.change) = (end + &miss, change + &slope * &miss - &miss);
        self.jacobian = slope;
        self.periods = self.periods.saturating_add(1 << doublings);
        if fades {
            self.end = Some(EnvelopeEnd::Settled);
        }
        Some(doublings + shorter(allowed / off.max(f64::MIN_POSITIVE)).min(MAX_MORE_DOUBLINGS))
    }

    /// A step from the present state with `doublings`, or fewer if it would be too long.
    fn next_step(&self, doublings: u32) -> EnvelopeStep {
        let longest = MAX_STEP_SCALES * self.options.scale;
        let size = self.state.len();
        let (mut sum, mut power) = (DMatrix::identity(size, size), self.jacobian.clone());
        let (mut step, mut done) = (self.change.clone(), 0);
        while done < doublings.min(MAX_DOUBLINGS) {
            let longer = &sum + product(&power, &sum);
            let (way, squared) = (&longer * &self.change, product(&power, &power));
            if !(way.norm() <= longest && squared.iter().all(|number| number.is_finite())) {
                break;
            }
            (sum, power, step, done) = (longer, squared, way, done + 1);
        }
        let fades = 1u64 << done >= u64::from(self.options.decay_periods) && power.norm() < FADED_SHARE;
        EnvelopeStep { doublings: done, predicted: power * &self.change, step, sum, fades }
    }
}

/// Doublings by which a step is too long if its error is `times` too large. The error goes with the third power.
fn shorter(times: f64) -> u32 {
    (times.log2() / 3.0).clamp(0.0, 62.0) as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    fn vector(numbers: &[f64]) -> DVector<f64> {
        DVector::from_column_slice(numbers)
    }

    type Map = fn(&DVector<f64>) -> DVector<f64>;

    /// Decay of all motion, per period.
    const LOSS: f64 = 1e-5;

    /// Slow and nonlinear: x drifts in a double well, beside a pair of numbers that turns by 1.3 a period and fades.
    fn wells(at: &DVector<f64>) -> DVector<f64> {
        let (x, y, z) = (at[0], at[1], at[2]);
        let (sine, cosine) = 1.3f64.sin_cos();
        let left = 1.0 - LOSS;
        vector(&[
            x + LOSS * (x - x * x * x + 0.01 * y * y),
            left * (cosine * y - sine * z) + LOSS * x * x,
            left * (sine * y + cosine * z),
        ])
    }

    fn slope(map: Map, at: &DVector<f64>) -> DMatrix<f64> {
        let h = 1e-6;
        let columns: Vec<DVector<f64>> = (0..at.len())
            .map(|k| {
                let mut there = [at.clone(), at.clone()];
                there[0][k] -= h;
                there[1][k] += h;
                (map(&there[1]) - map(&there[0])) / (2.0 * h)
            })
            .collect();
        DMatrix::from_columns(&columns)
    }

    fn followed(map: Map, from: DVector<f64>, most: u32) -> Envelope {
        let mut envelope = Envelope::new(
            from,
            EnvelopeOptions { scale: 1.0, decay_periods: (2.0 / LOSS) as u32, max_evaluations: most },
        );
        while envelope.came().is_none() {
            let at = envelope.ask();
            envelope.tell(Some((map(&at), slope(map, &at))));
        }
        envelope
    }

    /// Starts close to the unstable state between the wells, on either side, and compares with a million periods.
    #[test]
    fn it_comes_to_where_a_million_periods_lead() {
        for [begin, turning] in [[1e-6, 0.0], [-1e-6, 0.0], [0.03, 0.1], [-2e-3, 0.03]] {
            let from = vector(&[begin, turning, 0.5 * turning]);
            let mut waited = from.clone();
            for _ in 0..2_000_000 {
                waited = wells(&waited);
            }
            let envelope = followed(wells, from, 400);
            assert_eq!(envelope.came(), Some(EnvelopeEnd::Settled), "from {begin}");
            let off = (envelope.state() - &waited).norm();
            assert!(off < 1e-3, "from {begin}: {off}");
            assert!(envelope.evaluations() < 150, "from {begin}: {}", envelope.evaluations());
            println!(
                "from {begin}: {} evaluations for {} periods, {off:.1e} off",
                envelope.evaluations(),
                envelope.periods()
            );
        }
    }

    /// On the way it stays close to the repeated map.
    #[test]
    fn it_goes_the_way_of_the_repeated_map() {
        let mut envelope = Envelope::new(
            vector(&[0.2, 0.1, 0.0]),
            EnvelopeOptions { scale: 1.0, decay_periods: 200_000, max_evaluations: 400 },
        );
        let (mut waited, mut periods) = (vector(&[0.2, 0.1, 0.0]), 0);
        while envelope.periods() < 150_000 {
            let at = envelope.ask();
            envelope.tell(Some((wells(&at), slope(wells, &at))));
            while periods < envelope.periods() {
                (waited, periods) = (wells(&waited), periods + 1);
            }
            let off = (envelope.state() - &waited).norm();
            assert!(off < 0.02, "after {periods} periods {off} off");
        }
    }

    /// A linear map takes only as many steps as the doublings need to grow.
    #[test]
    fn a_linear_map_is_through_in_a_few_strides() {
        let linear: Map = |at| {
            let (sine, cosine) = 0.7f64.sin_cos();
            DMatrix::from_row_slice(2, 2, &[cosine, -sine, sine, cosine]) * (1.0 - LOSS) * at
                + vector(&[1e-5, 0.0])
        };
        let envelope = followed(linear, vector(&[0.1, 0.0]), 100);
        assert_eq!(envelope.came(), Some(EnvelopeEnd::Settled));
        assert!(envelope.evaluations() <= 8, "{}", envelope.evaluations());
    }

    #[test]
    fn what_has_no_strides_comes_nowhere() {
        // Chaotic: the logistic map.
        let logistic: Map = |at| vector(&[3.9 * at[0] * (1.0 - at[0])]);
        let envelope = followed(logistic, vector(&[0.3]), 400);
        assert_eq!(envelope.came(), Some(EnvelopeEnd::Failed));
        assert!(envelope.evaluations() < 100, "{}", envelope.evaluations());
        let mut undefined = Envelope::new(
            vector(&[0.3]),
            EnvelopeOptions { scale: 1.0, decay_periods: 1000, max_evaluations: 10 },
        );
        undefined.tell(None);
        assert_eq!(undefined.came(), Some(EnvelopeEnd::Failed));
    }
}

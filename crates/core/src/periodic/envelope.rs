//! The slow motion of a map that is repeated very often, followed in steps of many periods.
//!
//! Where the map is as good as linear, so many of its periods are one matrix: from x, which the map moves by c and where its
//! Jacobian is J, the place after N periods is x + (1 + J + ... + J^(N-1)) c, and the map moves that by J^N c. A step takes as
//! many periods as this serves, and what the map really moves its end by tells whether it did: the exponential
//! Rosenbrock-Euler method (Hochbruck & Ostermann, Acta Numerica 19 (2010) 209) for a difference equation. What turns or
//! fades fast costs nothing, however long the slow motion lasts.

use nalgebra::{DMatrix, DVector};

/// A step's end may be off by so large a share of the step ...
const STEP_ERROR_SHARE: f64 = 0.15;
/// ... or by so many scales, whichever is more.
const STEP_ERROR_SCALES: f64 = 1e-9;
/// Longest step, in scales.
const MAX_STEP_SCALES: f64 = 0.3;
/// Doublings of a step's periods: at first, and how many more one may have than the one before it.
const FIRST_DOUBLINGS: u32 = 2;
const MAX_MORE_DOUBLINGS: u32 = 3;
/// Most doublings.
const MAX_DOUBLINGS: u32 = 40;
/// A motion has come to rest where a step for so long leaves less than this of any deviation.
const FADED_SHARE: f64 = 0.5;
/// After so many evaluations or more, steps are of no use that have not taken so many periods as their square over this.
const USELESS_EVALUATIONS: (u32, u64) = (8, 32);

/// What became of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EnvelopeEnd {
    /// Next to a fixed point to which waiting would lead.
    Settled,
    /// Nowhere: the map has no number there, no step serves, or all evaluations are spent.
    Failed,
}

/// What it is told.
#[derive(Clone, Copy, Debug)]
pub struct EnvelopeOptions {
    /// Length of a state that is not small.
    pub scale: f64,
    /// Periods in which free motion fades.
    pub decay_periods: u32,
    /// Most evaluations.
    pub max_evaluations: u32,
}

/// A step on its way: where it ends, and what the map moves that by if it is linear.
#[derive(Clone, Debug)]
struct EnvelopeStep {
    doublings: u32,
    step: DVector<f64>,
    predicted: DVector<f64>,
    /// What becomes of a steady push over so many periods.
    sum: DMatrix<f64>,
    /// Whether so many periods leave next to nothing of any deviation.
    fades: bool,
}

/// A motion that is followed.
#[derive(Clone, Debug)]
pub struct Envelope {
    options: EnvelopeOptions,
    state: DVector<f64>,
    /// By how much the map moves it, and the map's Jacobian there.
    change: DVector<f64>,
    jacobian: DMatrix<f64>,
    next_step: Option<EnvelopeStep>,
    end: Option<EnvelopeEnd>,
    evaluations: u32,
    periods: u64,
}

impl Envelope {
    /// From `state` on.
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

    /// Where it wants to know the map and its Jacobian next.
    pub fn ask(&self) -> DVector<f64> {
        match &self.next_step {
            Some(stride) => &self.state + &stride.step,
            None => self.state.clone(),
        }
    }

    /// Where it has come to.
    pub fn state(&self) -> &DVector<f64> {
        &self.state
    }

    /// How it ended, once it has.
    pub fn came(&self) -> Option<EnvelopeEnd> {
        self.end
    }

    /// Evaluations so far: each takes one period.
    pub fn evaluations(&self) -> u32 {
        self.evaluations
    }

    /// Periods of the motion so far.
    pub fn periods(&self) -> u64 {
        self.periods
    }

    /// Takes the map's answer where it asks ([`ask`](Self::ask)), and its Jacobian there; none where it has no answer of use.
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

    /// After a step: how many doublings the next one may have.
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
        // What the map is off by grows from nothing as the square of the way: the mean of (m/N)^2 is a third where N is large, and
        // nothing where it is 1. The end moved by as much, and the change with it.
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

    /// From where it is, of so many doublings, or of fewer where it would be too long.
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

/// Column by column, in one order on every processor: nalgebra's own product of matrices goes by what each can do.
fn product(a: &DMatrix<f64>, b: &DMatrix<f64>) -> DMatrix<f64> {
    let mut all = DMatrix::zeros(a.nrows(), b.ncols());
    all.column_iter_mut().zip(b.column_iter()).for_each(|(mut column, b)| column.gemv(1.0, a, &b, 0.0));
    all
}

/// By how many doublings a step is too long whose error is so many times too large: the error goes with the third power.
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

    /// How fast all fades, per period.
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

    /// From next to the state between the wells, which is unstable, each way, as a million periods lead.
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

    /// On the way it is where repeating the map leads.
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

    /// A map that is linear takes as many steps as the doublings grow.
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

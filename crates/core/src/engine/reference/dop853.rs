//! One step of DOP853 and its continuous extension, on buffers that are made once.

use super::tableau::{DENSE, EMBEDDED_3, ERROR_5, EXTENDED, NODES, STAGE, STAGES, TableauRow};
use crate::kernel::vectorized;

/// Right-hand side of y' = f(theta, y); returns the indentation (m) there.
pub(super) trait Rates {
    fn rates(&mut self, theta: f64, y: &[f64], out: &mut [f64]) -> f64;
}

/// Unknowns that are worked out side by side, in registers. Buffers have room for whole blocks of them.
const BLOCK: usize = 16;

/// Buffers of a step.
pub(super) struct Dop853 {
    /// Rates at the stages.
    pub k: [Vec<f64>; EXTENDED],
    /// State at the step's end.
    pub end: Vec<f64>,
    /// State at a stage.
    stage: Vec<f64>,
    /// Indentation at the stages, m; the caller sets the first one.
    pub seen: [f64; STAGES],
    /// Calls of the right-hand side.
    pub evaluations: u64,
}

impl Dop853 {
    /// For up to `size` unknowns.
    pub fn new(size: usize) -> Self {
        let size = size.next_multiple_of(BLOCK);
        Self {
            k: std::array::from_fn(|_| vec![0.0; size]),
            end: vec![0.0; size],
            stage: vec![0.0; size],
            seen: [0.0; STAGES],
            evaluations: 0,
        }
    }

    /// Rates at a step's start.
    pub fn begin(&mut self, system: &mut impl Rates, theta: f64, y: &[f64]) {
        self.seen[0] = system.rates(theta, y, &mut self.k[0]);
        self.evaluations += 1;
    }

    /// Tries a step of length `h` from `y` at `theta`, whose rates are in the first stage.
    pub fn step(&mut self, system: &mut impl Rates, theta: f64, y: &[f64], h: f64) {
        vectorized(
            #[inline(always)]
            || {
                for stage in 1..STAGES {
                    if stage == STAGES - 1 {
                        combine(&mut self.end, y, &self.k, STAGE[stage], h);
                        self.seen[stage] = system.rates(theta + h, &self.end, &mut self.k[stage]);
                    } else {
                        combine(&mut self.stage, y, &self.k, STAGE[stage], h);
                        self.seen[stage] =
                            system.rates(theta + NODES[stage] * h, &self.stage, &mut self.k[stage]);
                    }
                }
            },
        );
        self.evaluations += STAGES as u64 - 1;
    }

    /// The largest ratio of the step's error to the allowed one over all unknowns: Hairer's mean of both estimates.
    pub fn error(&self, allowed: &[f64], h: f64) -> f64 {
        let (mut fifth, mut third) = (0f64, 0f64);
        vectorized(
            #[inline(always)]
            || {
                for (block, allowed) in allowed.chunks(BLOCK).enumerate() {
                    let from = block * BLOCK;
                    let (five, last, three) = (
                        weighed(&self.k, ERROR_5, from),
                        weighed(&self.k, STAGE[STAGES - 1], from),
                        weighed(&self.k, EMBEDDED_3, from),
                    );
                    for (n, allowed) in allowed.iter().enumerate() {
                        let (five, three) = (five[n] / allowed, (last[n] - three[n]) / allowed);
                        // Not max, which ignores NaN.
                        fifth = if five.abs() <= fifth { fifth } else { five.abs() };
                        third = if three.abs() <= third { third } else { three.abs() };
                    }
                }
            },
        );
        if fifth == 0.0 { 0.0 } else { h * fifth * fifth / fifth.hypot(0.1 * third) }
    }

    /// The three further stages of the continuous extension.
    pub fn extend(&mut self, system: &mut impl Rates, theta: f64, y: &[f64], h: f64) {
        for stage in STAGES..EXTENDED {
            combine(&mut self.stage, y, &self.k, STAGE[stage], h);
            system.rates(theta + NODES[stage] * h, &self.stage, &mut self.k[stage]);
        }
        self.evaluations += (EXTENDED - STAGES) as u64;
    }

    /// Continuous extension of the sum of unknowns `range`, after [`Dop853::extend`].
    pub fn dense(&self, y: &[f64], range: std::ops::Range<usize>, h: f64) -> Dense {
        let rates: [f64; EXTENDED] = std::array::from_fn(|j| self.k[j][range.clone()].iter().sum());
        let start: f64 = y[range.clone()].iter().sum();
        let change = self.end[range].iter().sum::<f64>() - start;
        let sum = |row: TableauRow| h * row.iter().map(|(j, d)| d * rates[*j]).sum::<f64>();
        let (first, last) = (h * rates[0], h * rates[STAGES - 1]);
        let [a, b, c, d] = DENSE.map(sum);
        Dense { start, terms: [change, first - change, 2.0 * change - first - last, a, b, c, d] }
    }
}

#[inline(always)]
fn combine(out: &mut [f64], y: &[f64], k: &[Vec<f64>; EXTENDED], row: TableauRow, h: f64) {
    for (block, y) in y.chunks(BLOCK).enumerate() {
        let from = block * BLOCK;
        let sums = weighed(k, row, from);
        let out = &mut out[from..from + y.len()];
        for n in 0..y.len() {
            out[n] = y[n] + h * sums[n];
        }
    }
}

/// The weighted sums of the stages' rates, of the block of unknowns that begins at `from`.
#[inline(always)]
fn weighed(k: &[Vec<f64>; EXTENDED], row: TableauRow, from: usize) -> [f64; BLOCK] {
    let mut sums = [0.0; BLOCK];
    for (j, weight) in row {
        if let Some(rates) = k[*j][from..].first_chunk::<BLOCK>() {
            for n in 0..BLOCK {
                sums[n] += weight * rates[n];
            }
        }
    }
    sums
}

/// One quantity over a step, a polynomial of degree 7.
#[derive(Clone, Copy, Debug)]
pub(super) struct Dense {
    start: f64,
    terms: [f64; 7],
}

impl Dense {
    /// Its value at the share `u` of the step.
    pub fn at(&self, u: f64) -> f64 {
        let [t0, t1, t2, t3, t4, t5, t6] = self.terms;
        let w = 1.0 - u;
        self.start + u * (t0 + w * (t1 + u * (t2 + w * (t3 + u * (t4 + w * (t5 + u * t6))))))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// x'' = -x + sin(2 theta)/(2 + x): smooth, driven and nonlinear.
    struct Pendulum;

    impl Rates for Pendulum {
        fn rates(&mut self, theta: f64, y: &[f64], out: &mut [f64]) -> f64 {
            out[0] = y[1];
            out[1] = -y[0] + (2.0 * theta).sin() / (2.0 + y[0]);
            y[0]
        }
    }

    /// The end of `steps` equal steps to 4, and the first step's continuous extension at three places.
    fn to_four(steps: u32) -> (f64, [f64; 3]) {
        let h = 4.0 / f64::from(steps);
        let (mut y, mut theta) = ([0.5, 1.0], 0.0);
        let mut stepper = Dop853::new(2);
        let mut inside = [0.0; 3];
        for step in 0..steps {
            stepper.begin(&mut Pendulum, theta, &y);
            stepper.step(&mut Pendulum, theta, &y, h);
            if step == 0 {
                stepper.extend(&mut Pendulum, theta, &y, h);
                inside = [0.2, 0.5, 0.9].map(|u| stepper.dense(&y, 0..1, h).at(u));
            }
            y.copy_from_slice(&stepper.end[..2]);
            theta += h;
        }
        (y[0], inside)
    }

    /// State at the share `u` of a first step of length `h`, by many short ones.
    fn within(h: f64, u: f64) -> f64 {
        let steps = 64;
        let mut y = [0.5, 1.0];
        let mut stepper = Dop853::new(2);
        for step in 0..steps {
            let (theta, h) = (f64::from(step) / f64::from(steps) * u * h, u * h / f64::from(steps));
            stepper.begin(&mut Pendulum, theta, &y);
            stepper.step(&mut Pendulum, theta, &y, h);
            y.copy_from_slice(&stepper.end[..2]);
        }
        y[0]
    }

    /// Half the step divides the end's error by 2^8, and the error of one step's extension by 2^8 (order 7, local).
    #[test]
    fn steps_are_of_order_eight_and_extensions_of_seven() {
        let truth = to_four(1024).0;
        let [coarse, fine] = [16, 32].map(|steps| (to_four(steps).0 - truth).abs());
        let order = (coarse / fine).log2();
        assert!((7.5..9.5).contains(&order), "order {order}: {coarse:e}, {fine:e}");
        let local = [8, 16].map(|steps| {
            let h = 4.0 / f64::from(steps);
            let found = to_four(steps).1;
            [0.2, 0.5, 0.9].iter().zip(found).map(|(u, x)| (x - within(h, *u)).abs()).fold(0.0, f64::max)
        });
        let order = (local[0] / local[1]).log2();
        assert!((7.3..9.5).contains(&order), "order {order}: {local:?}");
    }
}

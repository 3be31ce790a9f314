//! An average over the shares of a prior, and draws from what it leaves: one dimension, by halving where it matters.

/// Halvings at most.
const DEEPEST: u32 = 40;

/// How closely nodes lie, in logarithms.
#[derive(Clone, Copy)]
struct Spacing {
    /// Logarithms so far below the largest count for nothing.
    nothing: f64,
    /// The middle of two nodes may be off their mean by so much.
    off: f64,
    /// Two nodes may differ by so much.
    steep: f64,
}

/// For draws, which are straight between two nodes: a normal peak has five nodes in a standard deviation.
const FINE: Spacing = Spacing { nothing: 25.0, off: 0.02, steep: 1.5 };
/// For the integral alone: three nodes in a standard deviation. The trapezoidal rule over a whole peak needs no more.
const COARSE: Spacing = Spacing { nothing: 16.0, off: 0.06, steep: 3.0 };

/// A share and what stands there.
type Node = (f64, f64);

/// What stands at rising shares, and its integral from the first one on.
#[derive(Debug)]
pub(super) struct Marginal {
    nodes: Vec<Node>,
    /// Integrals of exp(log - most), up to each node.
    below: Vec<f64>,
    /// Where the logarithm is largest.
    pub peak: Node,
}

impl Marginal {
    /// Of the logarithm of a likelihood over shares from 0 to 1; so many equal steps see each of its peaks from afar.
    pub fn of(steps: usize, log: impl FnMut(f64) -> f64) -> Self {
        Self::spaced(steps, FINE, log)
    }

    /// The logarithm of the average alone, from half of the nodes.
    pub fn log_average(steps: usize, log: impl FnMut(f64) -> f64) -> f64 {
        Self::spaced(steps, COARSE, log).log()
    }

    fn spaced(steps: usize, spacing: Spacing, mut log: impl FnMut(f64) -> f64) -> Self {
        let mut value = |share: f64| {
            let log = log(share);
            if log.is_nan() { f64::NEG_INFINITY } else { log }
        };
        let mut coarse: Vec<(f64, f64)> =
            (0..=steps).map(|n| n as f64 / steps as f64).map(|share| (share, value(share))).collect();
        // A peak may be far narrower than a step: where a parabola through three nodes has its top is another one.
        let tops: Vec<f64> = coarse.windows(3).filter_map(top).collect();
        coarse.extend(tops.into_iter().map(|share| (share, value(share))));
        coarse.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut most = coarse.iter().map(|node| node.1).fold(f64::NEG_INFINITY, f64::max);
        let mut nodes = Vec::new();
        let mut open: Vec<(Node, Node, u32)> =
            coarse.windows(2).map(|pair| (pair[0], pair[1], 0)).rev().collect();
        while let Some((a, b, depth)) = open.pop() {
            let share = 0.5 * (a.0 + b.0);
            let middle = (share, value(share));
            most = most.max(middle.1);
            let largest = a.1.max(middle.1).max(b.1);
            let bend = (middle.1 - 0.5 * (a.1 + b.1)).abs();
            let done = largest < most - spacing.nothing
                || largest == f64::NEG_INFINITY
                || (bend < spacing.off && (a.1 - b.1).abs() < spacing.steep)
                || depth == DEEPEST;
            match done {
                true => nodes.extend([a, middle]),
                // From the left on: the one that was put last comes first.
                false => open.extend([(middle, b, depth + 1), (a, middle, depth + 1)]),
            }
        }
        nodes.extend(coarse.last().copied());
        Self::over(nodes)
    }

    fn over(nodes: Vec<(f64, f64)>) -> Self {
        let peak =
            nodes.iter().fold((0.5, f64::NEG_INFINITY), |best, one| if one.1 > best.1 { *one } else { best });
        let weight = |node: &(f64, f64)| (node.1 - peak.1).exp();
        let mut sum = 0.0;
        let mut below = vec![0.0];
        for pair in nodes.windows(2) {
            sum += 0.5 * (pair[1].0 - pair[0].0) * (weight(&pair[0]) + weight(&pair[1]));
            below.push(sum);
        }
        Self { nodes, below, peak }
    }

    /// The logarithm of the average.
    pub fn log(&self) -> f64 {
        self.peak.1 + self.below.last().copied().unwrap_or(0.0).ln()
    }

    /// The share of the prior that this part of what is left is below.
    pub fn draw(&self, part: f64) -> f64 {
        let wanted = part * self.below.last().copied().unwrap_or(0.0);
        let after = self.below.partition_point(|sum| *sum < wanted).clamp(1, self.below.len().max(2) - 1);
        let (Some(a), Some(b)) = (self.nodes.get(after - 1), self.nodes.get(after)) else {
            return self.peak.0;
        };
        let weight = |node: &(f64, f64)| (node.1 - self.peak.1).exp();
        let (low, high) = (weight(a), weight(b));
        let inside = (wanted - self.below[after - 1]) / (self.below[after] - self.below[after - 1]);
        // Density that is straight between the two: a root of a square.
        let between = match (high - low).abs() < 1e-9 * (high + low) {
            true => inside,
            false => ((low * low + inside * (high * high - low * low)).sqrt() - low) / (high - low),
        };
        a.0 + (b.0 - a.0) * if between.is_finite() { between } else { 0.5 }
    }
}

/// Where a parabola through three nodes has its top, if the middle one is the highest.
fn top(nodes: &[(f64, f64)]) -> Option<f64> {
    let &[(a, low), (b, middle), (c, high)] = nodes else { return None };
    let (left, right) = ((middle - low) / (b - a), (high - middle) / (c - b));
    let falls = left >= 0.0 && right <= 0.0 && left > right;
    let share = 0.5 * (a + b) + 0.5 * (c - a) * left / (left - right);
    (falls && share.is_finite() && share > a && share < c && share != b).then_some(share)
}

#[cfg(test)]
mod tests {
    use super::Marginal;
    use crate::design::normal_quantile;

    /// Truth: a normal peak's integral and quantiles, wide and narrow, and two of them.
    #[test]
    fn normal_peaks_are_integrated_and_drawn() {
        for (centre, sd) in [(0.5, 0.1f64), (0.4321, 1e-3), (0.765_432_1, 1e-6), (0.21, 0.02)] {
            let found = Marginal::of(16, |x| -0.5 * ((x - centre) / sd).powi(2));
            let truth = (sd * std::f64::consts::TAU.sqrt()).ln();
            let average = Marginal::log_average(16, |x| -0.5 * ((x - centre) / sd).powi(2));
            for log in [found.log(), average] {
                assert!((log - truth).abs() < 2e-3, "{centre} {sd}: {log} {truth}");
            }
            for part in [0.001, 0.025, 0.3, 0.5, 0.975] {
                let z = (found.draw(part) - centre) / sd;
                assert!((z - normal_quantile(part)).abs() < 0.03, "{centre} {sd} {part}: {z}");
            }
            assert!((found.peak.0 - centre).abs() < 0.3 * sd && found.peak.1 > -0.05);
        }
        let two = Marginal::of(40, |x| {
            let of = |centre: f64, sd: f64| -0.5 * ((x - centre) / sd).powi(2);
            let (a, b) = (of(0.2, 3e-3), of(0.8, 1e-3));
            a.max(b) + (1.0 + (-(a - b).abs()).exp()).ln()
        });
        assert!((two.draw(0.5) - 0.2).abs() < 4e-3 && (two.draw(0.74) - 0.2).abs() < 0.02);
        assert!((two.draw(0.76) - 0.8).abs() < 0.01, "{}", two.draw(0.76));
    }

    /// Truth: by hand. A step, a flat one, and nothing anywhere.
    #[test]
    fn edges_are_kept() {
        let step = Marginal::of(8, |x| if x < 0.3 { f64::NEG_INFINITY } else { 0.0 });
        assert!((step.log() - 0.7f64.ln()).abs() < 1e-6);
        assert!((step.draw(0.5) - 0.65).abs() < 1e-6);
        let flat = Marginal::of(8, |_| -3.0);
        assert!((flat.log() + 3.0).abs() < 1e-12 && (flat.draw(0.25) - 0.25).abs() < 1e-12);
        let none = Marginal::of(8, |_| f64::NAN);
        assert!(none.log() == f64::NEG_INFINITY || none.log().is_nan());
    }
}

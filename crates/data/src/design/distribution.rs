//! What is known of an uncertain quantity: its distribution, drawn by the inverse of its distribution function.

use serde::{Deserialize, Serialize};
use statrs::function::erf::{erfc, erfc_inv};
use std::f64::consts::SQRT_2;

/// The least share that is drawn of a distribution without ends: half a step of an unscrambled point.
const LEAST_SHARE: f64 = 1.0 / (1u64 << 33) as f64;

/// A distribution of a quantity in SI units. Ends are those of the cut; none where it is not cut there.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "distribution", rename_all = "lowercase")]
pub enum Distribution {
    /// Each value between the ends as likely.
    Uniform { from: f64, to: f64 },
    /// The logarithm is uniform.
    LogUniform { from: f64, to: f64 },
    /// Rises from one end to `mode` and falls to the other.
    Triangular { from: f64, mode: f64, to: f64 },
    Normal {
        mean: f64,
        sd: f64,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        from: Option<f64>,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        to: Option<f64>,
    },
    /// The logarithm is normal around that of the median.
    LogNormal {
        median: f64,
        /// Standard deviation of the natural logarithm.
        sigma: f64,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        from: Option<f64>,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        to: Option<f64>,
    },
}

/// Probability that a standard normal number is below `z`.
pub fn normal_below(z: f64) -> f64 {
    0.5 * erfc(-z / SQRT_2)
}

/// The standard normal number that `below` of all are below; `above` is what is left, given for its digits.
fn normal_at(below: f64, above: f64) -> f64 {
    if below <= above { -SQRT_2 * erfc_inv(2.0 * below) } else { SQRT_2 * erfc_inv(2.0 * above) }
}

/// The standard normal number that a share of all are below.
pub fn normal_quantile(share: f64) -> f64 {
    normal_at(share, 1.0 - share)
}

/// A normal number, cut at `from` and `to` in standard deviations.
fn cut_normal(share: f64, from: f64, to: f64) -> f64 {
    let between = |low: f64, high: f64| low * (1.0 - share) + high * share;
    let below = between(normal_below(from), normal_below(to));
    let above = between(normal_below(-from), normal_below(-to));
    normal_at(below, above).clamp(from, to)
}

impl Distribution {
    /// Words of `distribution` in a scene.
    pub const WORDS: [&'static str; 5] = ["normal", "uniform", "lognormal", "loguniform", "triangular"];

    /// The value that `share` of all are below. Where there is no least or largest value, 0 and 1 are taken for shares a
    /// little inside.
    pub fn value(&self, share: f64) -> f64 {
        let share = match self.is_bounded() {
            true => share,
            false => share.clamp(LEAST_SHARE, 1.0 - f64::EPSILON / 2.0),
        };
        let standard = |centre: f64, scale: f64, from: Option<f64>, to: Option<f64>| {
            let end = |end: Option<f64>, none: f64| end.map_or(none, |end| (end - centre) / scale);
            centre + scale * cut_normal(share, end(from, f64::NEG_INFINITY), end(to, f64::INFINITY))
        };
        match *self {
            Self::Uniform { from, to } => within(from * (1.0 - share) + to * share, from, to),
            Self::LogUniform { from, to } => within(from.powf(1.0 - share) * to.powf(share), from, to),
            Self::Triangular { from, mode, to } => {
                let turn = (mode - from) / (to - from);
                let value = match share < turn {
                    true => from + (share * (to - from) * (mode - from)).sqrt(),
                    false => to - ((1.0 - share) * (to - from) * (to - mode)).sqrt(),
                };
                within(value, from, to)
            }
            Self::Normal { mean, sd, from, to } => {
                let value = standard(mean, sd, from, to);
                within(value, from.unwrap_or(f64::NEG_INFINITY), to.unwrap_or(f64::INFINITY))
            }
            Self::LogNormal { median, sigma, from, to } => {
                let value = standard(median.ln(), sigma, from.map(f64::ln), to.map(f64::ln)).exp();
                within(value, from.unwrap_or(0.0), to.unwrap_or(f64::INFINITY))
            }
        }
    }

    /// The least and the largest value there can be.
    pub fn ends(&self) -> (f64, f64) {
        match *self {
            Self::Uniform { from, to }
            | Self::LogUniform { from, to }
            | Self::Triangular { from, to, .. } => (from, to),
            Self::Normal { from, to, .. } => (from.unwrap_or(f64::NEG_INFINITY), to.unwrap_or(f64::INFINITY)),
            Self::LogNormal { from, to, .. } => (from.unwrap_or(0.0), to.unwrap_or(f64::INFINITY)),
        }
    }

    /// Whether both ends can be drawn: neither is infinite, nor the zero that a lognormal quantity never has.
    pub fn is_bounded(&self) -> bool {
        let (from, to) = self.ends();
        let open = matches!(self, Self::LogNormal { from: None, .. });
        from.is_finite() && to.is_finite() && !open
    }

    /// Probability of a value below this one.
    pub fn below(&self, value: f64) -> f64 {
        let (from, to) = self.ends();
        if value <= from {
            return 0.0;
        }
        if value >= to {
            return 1.0;
        }
        let cut = |z: f64, low: f64, high: f64| {
            (normal_below(z) - normal_below(low)) / (normal_below(high) - normal_below(low))
        };
        match *self {
            Self::Uniform { .. } => (value - from) / (to - from),
            Self::LogUniform { .. } => (value / from).ln() / (to / from).ln(),
            Self::Triangular { mode, .. } if value < mode => {
                (value - from).powi(2) / ((to - from) * (mode - from))
            }
            Self::Triangular { mode, .. } => 1.0 - (to - value).powi(2) / ((to - from) * (to - mode)),
            Self::Normal { mean, sd, .. } => {
                let z = |value: f64| (value - mean) / sd;
                cut(z(value), z(from), z(to))
            }
            Self::LogNormal { median, sigma, .. } => {
                let z = |value: f64| (value.ln() - median.ln()) / sigma;
                cut(z(value), z(from), z(to))
            }
        }
    }

    /// How SALib calls it, and its bounds there.
    pub fn salib(&self) -> (&'static str, Vec<f64>) {
        match *self {
            Self::Uniform { from, to } => ("unif", vec![from, to]),
            Self::LogUniform { from, to } => ("logunif", vec![from, to]),
            Self::Triangular { from, mode, to } => ("triang", vec![from, to, (mode - from) / (to - from)]),
            Self::Normal { mean, sd, from: None, to: None } => ("norm", vec![mean, sd]),
            Self::Normal { mean, sd, from, to } => {
                // Ten standard deviations out is further than any draw.
                let (low, high) = (from.unwrap_or(mean - 10.0 * sd), to.unwrap_or(mean + 10.0 * sd));
                ("truncnorm", vec![low, high, mean, sd])
            }
            Self::LogNormal { median, sigma, .. } => ("lognorm", vec![median.ln(), sigma]),
        }
    }
}

/// Rounding does not carry a value over an end.
fn within(value: f64, from: f64, to: f64) -> f64 {
    value.max(from).min(to)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// SciPy 1.17: `norm.ppf`, `truncnorm.ppf`, `triang.ppf`, `loguniform.ppf`, `lognorm.ppf`.
    #[test]
    fn quantiles_are_those_of_scipy() {
        let normal = Distribution::Normal { mean: 40.0, sd: 4.0, from: None, to: None };
        let cut = Distribution::Normal { mean: 40.0, sd: 4.0, from: Some(38.0), to: Some(52.0) };
        let tail = Distribution::Normal { mean: 0.0, sd: 1.0, from: Some(6.0), to: None };
        let lognormal = Distribution::LogNormal { median: 1e-8, sigma: 0.3, from: None, to: None };
        let loguniform = Distribution::LogUniform { from: 1e9, to: 1e10 };
        let triangular = Distribution::Triangular { from: 0.01, mode: 0.03, to: 0.08 };
        for (one, share, truth) in TRUTH.iter().map(|(n, share, truth)| {
            ([normal, cut, tail, lognormal, loguniform, triangular][*n], *share, *truth)
        }) {
            let value = one.value(share);
            assert!((value / truth - 1.0).abs() < 1e-12, "{one:?} at {share}: {value:e}, not {truth:e}");
            assert!(
                (one.below(value) - share).abs() < 1e-9 * share + 1e-13 || one == tail,
                "{one:?} {share}"
            );
        }
    }

    const TRUTH: [(usize, f64, f64); 24] = [
        (0, 1e-09, 16.008771939969254),
        (0, 0.001, 27.639070775328747),
        (0, 0.5, 40.0),
        (0, 0.999, 52.36092922467125),
        (1, 1e-09, 38.00000000784073),
        (1, 0.001, 38.00783689828017),
        (1, 0.5, 41.58016546712355),
        (1, 0.999, 51.487630787282285),
        (2, 1e-09, 6.0000000001623786),
        (2, 0.001, 6.00016245681254),
        (2, 0.5, 6.111565061813439),
        (2, 0.999, 7.036366493709704),
        (3, 1e-09, 1.6540767339663605e-09),
        (3, 0.001, 3.957115699387264e-09),
        (3, 0.5, 1e-08),
        (3, 0.999, 2.527093155640721e-08),
        (4, 1e-09, 1000000002.302584),
        (4, 0.001, 1002305238.0778997),
        (4, 0.5, 3162277660.1683846),
        (4, 0.999, 9977000638.22553),
        (5, 1e-09, 0.010001183215956621),
        (5, 0.001, 0.011183215956619924),
        (5, 0.5, 0.038166998673296225),
        (5, 0.999, 0.07812917130661304),
    ];

    #[test]
    fn a_share_at_the_end_has_a_value() {
        let normal = Distribution::Normal { mean: 0.0, sd: 1.0, from: None, to: None };
        assert!(normal.value(0.0) > -7.0 && normal.value(1.0) < 9.0);
        assert_eq!(Distribution::Uniform { from: -1.0, to: 1.0 }.value(1.0), 1.0);
    }
}

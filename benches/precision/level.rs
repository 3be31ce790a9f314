//! What an accuracy costs: time at a given median error, between measured points.

use crate::measure::Point;
use std::fmt;

/// Time that a solver takes to a median error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cost {
    /// Between two measured points, by their logarithms, s per instance.
    Exactly(f64),
    /// Its cheapest setting is better than asked: it would take no longer than this.
    AtMost(f64),
    NotReached,
}

impl Cost {
    /// The cheapest way of these points to that error. Only neighbouring settings of one solver are joined.
    pub fn at(points: &[&Point], error: f64) -> Self {
        let mut best = Self::NotReached;
        for pair in points.windows(2) {
            let [a, b] = [pair[0], pair[1]];
            let (from, to) = (a.errors.median, b.errors.median);
            let known = from.is_finite() && to.is_finite() && from > 0.0 && to > 0.0;
            if a.solver == b.solver && known && from > error && to <= error {
                let share = (from / error).ln() / (from / to).ln();
                best = best.or_cheaper(Self::Exactly(a.seconds * (b.seconds / a.seconds).powf(share)));
            }
        }
        for point in points.iter().filter(|point| point.errors.median <= error) {
            best = best.or_cheaper(Self::AtMost(point.seconds));
        }
        best
    }

    fn or_cheaper(self, other: Self) -> Self {
        match (self.seconds(), other.seconds()) {
            (Some(a), Some(b)) if b < a => other,
            (None, _) => other,
            _ => self,
        }
    }

    pub fn seconds(self) -> Option<f64> {
        match self {
            Self::Exactly(seconds) | Self::AtMost(seconds) => Some(seconds),
            Self::NotReached => None,
        }
    }

    /// So many times as long.
    pub fn times(self, factor: f64) -> Self {
        match self {
            Self::Exactly(seconds) => Self::Exactly(factor * seconds),
            Self::AtMost(seconds) => Self::AtMost(factor * seconds),
            Self::NotReached => Self::NotReached,
        }
    }

    /// How many times as long as `other` this takes; a bound where one of them is.
    pub fn over(self, other: Self) -> String {
        let (Some(a), Some(b)) = (self.seconds(), other.seconds()) else { return "not reached".to_owned() };
        let sign = match (self, other) {
            (Self::AtMost(_), Self::AtMost(_)) => "about ",
            (Self::AtMost(_), _) => "at most ",
            (_, Self::AtMost(_)) => "at least ",
            _ => "",
        };
        let ratio = a / b;
        let text = match ratio {
            r if r < 10.0 => format!("{r:.2}"),
            r if r < 100.0 => format!("{r:.1}"),
            r => format!("{r:.0}"),
        };
        format!("{sign}{text}")
    }
}

impl fmt::Display for Cost {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let shown = |seconds: f64| match seconds {
            s if s < 1e-3 => format!("{:.3} ms", 1e3 * s),
            s if s < 1.0 => format!("{:.2} ms", 1e3 * s),
            s => format!("{s:.2} s"),
        };
        match *self {
            Self::Exactly(seconds) => write!(f, "{}", shown(seconds)),
            Self::AtMost(seconds) => write!(f, "at most {}", shown(seconds)),
            Self::NotReached => write!(f, "not reached"),
        }
    }
}

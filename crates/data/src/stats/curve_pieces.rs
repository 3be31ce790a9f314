//! A curve of one sample between its points: monotone cubics along pieces, and what is not known where it jumps.

/// So many points in a row that failed are bridged; where more did, nothing is known between their neighbours.
const MOST_BRIDGED: usize = 2;
/// A share of a curve's length that is rounding.
const HAIR: f64 = 1e-9;

/// What lies between two neighbouring points that are known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Between {
    Smooth,
    /// The state was not reached continuously.
    Jump,
    /// Too many points failed.
    Hole,
}

/// The points of a curve that are known: where they are, rising, and what lies between them.
#[derive(Clone, Debug)]
pub(super) struct Points {
    places: Vec<f64>,
    /// Numbers of the points along the curve.
    pub numbers: Vec<usize>,
    between: Vec<Between>,
    /// Whether a point between two others is not known.
    pub bridged: bool,
}

/// Where a place lies among the points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum CurvePlace {
    /// Between this point and the next, at this share of the way.
    Smooth(usize, f64),
    /// Likewise, and somewhere between them the curve jumps.
    Jump(usize, f64),
    /// Beyond the ends, or in a hole.
    Nowhere,
}

impl Points {
    /// `places` rise; `jumps` has a member for each pair of neighbours.
    pub fn of(places: &[f64], known: impl Fn(usize) -> bool, jumps: impl Fn(usize) -> bool) -> Self {
        let numbers: Vec<usize> = (0..places.len()).filter(|point| known(*point)).collect();
        let of = |pair: &[usize]| match (pair[0]..pair[1]).any(&jumps) {
            _ if pair[1] - pair[0] > MOST_BRIDGED + 1 => Between::Hole,
            true => Between::Jump,
            false => Between::Smooth,
        };
        Self {
            places: numbers.iter().map(|point| places[*point]).collect(),
            between: numbers.windows(2).map(of).collect(),
            bridged: numbers.windows(2).any(|pair| pair[1] - pair[0] > 1),
            numbers,
        }
    }

    /// Both ends, a hair apart from where they are: a place that was meant to be an end may be off in its last digit.
    fn ends(&self) -> Option<(f64, f64)> {
        let (first, last) = (*self.places.first()?, *self.places.last()?);
        let hair = HAIR * (last - first);
        Some((first - hair, last + hair))
    }

    /// Whether something is known everywhere from one place to another.
    pub fn hold(&self, from: f64, to: f64) -> bool {
        let inside = self.ends().is_some_and(|(first, last)| first <= from && to <= last);
        let hole = |(n, between): (usize, &Between)| {
            *between == Between::Hole && self.places[n] < to && self.places[n + 1] > from
        };
        inside && !self.between.iter().enumerate().any(hole)
    }

    pub fn find(&self, at: f64) -> CurvePlace {
        let inside = self.ends().is_some_and(|(first, last)| first <= at && at <= last);
        if !inside || self.places.len() < 2 {
            return CurvePlace::Nowhere;
        }
        let before = self.places.partition_point(|place| *place <= at).clamp(1, self.places.len() - 1) - 1;
        let (a, b) = (self.places[before], self.places[before + 1]);
        let share = ((at - a) / (b - a)).clamp(0.0, 1.0);
        match self.between[before] {
            Between::Smooth => CurvePlace::Smooth(before, share),
            Between::Jump => CurvePlace::Jump(before, share),
            Between::Hole => CurvePlace::Nowhere,
        }
    }
}

/// An observable along the points.
#[derive(Clone, Debug)]
pub(super) struct CurveLine {
    values: Vec<f64>,
    slopes: Vec<f64>,
    steps: Vec<f64>,
}

impl CurveLine {
    /// `values` of the points in their order; those of a phase, in degree, go on the short way round along a piece.
    pub fn of(points: &Points, mut values: Vec<f64>, is_phase: bool) -> Self {
        let steps: Vec<f64> = points.places.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let smooth = |n: usize| points.between.get(n) == Some(&Between::Smooth);
        if is_phase {
            for n in (1..values.len()).filter(|n| smooth(n - 1)) {
                values[n] -= 360.0 * ((values[n] - values[n - 1]) / 360.0).round();
            }
        }
        let rise = |n: usize| {
            let rise = (values[n + 1] - values[n]) / steps[n];
            (smooth(n) && rise.is_finite()).then_some((steps[n], rise))
        };
        let rises: Vec<Option<(f64, f64)>> = (0..steps.len()).map(rise).collect();
        let at = |n: usize| rises.get(n).copied().flatten();
        let before = |n: usize, back: usize| n.checked_sub(back).and_then(at);
        let slope = |n: usize| match (before(n, 1), at(n)) {
            (Some(left), Some(right)) => inner(left, right),
            (Some(left), None) => end(left, before(n, 2)),
            (None, Some(right)) => end(right, at(n + 1)),
            (None, None) => 0.0,
        };
        let slopes = (0..values.len()).map(slope).collect();
        Self { values, slopes, steps }
    }

    /// The cubic between a point and the next.
    pub fn smooth(&self, before: usize, share: f64) -> f64 {
        let (t, step) = (share, self.steps[before]);
        let (a, b) = (self.values[before], self.values[before + 1]);
        let (slope_a, slope_b) = (step * self.slopes[before], step * self.slopes[before + 1]);
        let rest = 1.0 - t;
        // Hermite's form, so that a straight line is one to the last digits.
        a + (b - a) * t * t * (3.0 - 2.0 * t) + slope_a * t * rest * rest - slope_b * t * t * rest
    }

    /// The two sides of a jump, each as it would go on.
    pub fn sides(&self, before: usize, share: f64) -> [f64; 2] {
        let step = self.steps[before];
        [
            self.values[before] + share * step * self.slopes[before],
            self.values[before + 1] - (1.0 - share) * step * self.slopes[before + 1],
        ]
    }
}

/// Slope at a point between two others, each given by its step and its rise: F. N. Fritsch and J. Butland, A method for
/// constructing local monotone piecewise cubic interpolants, SIAM J. Sci. Stat. Comput. 5, 300 (1984).
fn inner((left_step, left): (f64, f64), (right_step, right): (f64, f64)) -> f64 {
    if left * right <= 0.0 {
        return 0.0;
    }
    let (a, b) = (2.0 * right_step + left_step, right_step + 2.0 * left_step);
    (a + b) / (a / left + b / right)
}

/// Slope at the end of a piece: that of a parabola through three points, kept monotone.
fn end((step, rise): (f64, f64), next: Option<(f64, f64)>) -> f64 {
    let Some((next_step, next)) = next else { return rise };
    let slope = ((2.0 * step + next_step) * rise - step * next) / (step + next_step);
    if slope * rise <= 0.0 {
        0.0
    } else if rise * next <= 0.0 && slope.abs() > 3.0 * rise.abs() {
        3.0 * rise
    } else {
        slope
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(places: &[f64], values: &[f64], jumps: &[usize]) -> (Points, CurveLine) {
        let points = Points::of(places, |n| values[n].is_finite(), |n| jumps.contains(&n));
        let values = points.numbers.iter().map(|n| values[*n]).collect();
        let line = CurveLine::of(&points, values, false);
        (points, line)
    }

    fn at((points, line): &(Points, CurveLine), place: f64) -> f64 {
        match points.find(place) {
            CurvePlace::Smooth(before, share) => line.smooth(before, share),
            other => panic!("{place}: {other:?}"),
        }
    }

    /// Truth: SciPy 1.17, `PchipInterpolator`.
    #[test]
    fn cubics_are_scipys() {
        let curve = line(&[0.0, 1.0, 2.5, 3.0, 5.0], &[1.0, 2.0, 2.5, 2.0, 7.0], &[]);
        for (place, expected) in SCIPY {
            assert!((at(&curve, place) - expected).abs() < 1e-12, "{place}: {}", at(&curve, place));
        }
        assert_eq!(at(&curve, 5.0), 7.0);
        for outside in [-0.1, 5.1] {
            assert_eq!(curve.0.find(outside), CurvePlace::Nowhere);
        }
    }

    const SCIPY: [(f64, f64); 5] = [
        (0.3, 1.3696137931034482),
        (1.7, 2.3280255427841636),
        (2.75, 2.25),
        (3.1, 2.011075),
        (4.9, 6.485425000000002),
    ];

    /// Nothing is drawn across a jump: each side goes on by its own slope. Truth: two straight lines.
    #[test]
    fn a_jump_has_two_sides() {
        let (points, line) = line(&[0.0, 1.0, 2.0, 3.0, 4.0, 5.0], &[0.0, 1.0, 2.0, 13.0, 15.0, 17.0], &[2]);
        assert_eq!(points.find(2.25), CurvePlace::Jump(2, 0.25));
        assert_eq!(line.sides(2, 0.25), [2.25, 11.5]);
        assert_eq!(at(&(points.clone(), line.clone()), 1.5), 1.5);
        assert_eq!(at(&(points, line), 4.5), 16.0);
    }

    /// Two points that failed are bridged, three are a hole; a jump among bridged ones stays a jump.
    #[test]
    fn failed_points_are_bridged_or_a_hole() {
        let places: Vec<f64> = (0..8).map(f64::from).collect();
        let with = |failed: &[usize], jumps: &[usize]| {
            let values: Vec<f64> =
                (0..8).map(|n| if failed.contains(&n) { f64::NAN } else { 2.0 * n as f64 }).collect();
            line(&places, &values, jumps)
        };
        let bridged = with(&[3, 4], &[]);
        assert!((at(&bridged, 3.5) - 7.0).abs() < 1e-14 && bridged.0.bridged && bridged.0.hold(0.0, 7.0));
        let (hole, _) = with(&[3, 4, 5], &[]);
        assert_eq!(hole.find(3.5), CurvePlace::Nowhere);
        assert!(hole.hold(0.0, 2.0) && hole.hold(6.0, 7.0) && !hole.hold(1.0, 2.1) && !hole.hold(0.0, 7.0));
        assert!(matches!(with(&[3], &[3]).0.find(3.2), CurvePlace::Jump(2, _)));
        assert!(!with(&[0], &[]).0.hold(0.5, 3.0));
    }

    #[test]
    fn phases_go_the_short_way_round() {
        let points = Points::of(&[0.0, 1.0, 2.0], |_| true, |_| false);
        let line = CurveLine::of(&points, vec![358.0, 359.0, 0.0], true);
        assert!((line.smooth(1, 0.5) - 359.5).abs() < 1e-12);
    }
}

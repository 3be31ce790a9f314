//! One axis of a picture: what range it shows, linear or logarithmic, and where its ticks stand.

use super::labels::{ends, short};
use super::quantity_text::{DisplayUnit, number, superscript};
use crate::store::Coordinate;

/// A range of SI values, its unit and its label.
#[derive(Clone, Debug)]
pub(super) struct PlotAxis {
    /// Ends, in shown units (their decimal logarithm if `log`).
    low: f64,
    high: f64,
    pub log: bool,
    pub unit: DisplayUnit,
    /// With the unit.
    pub label: String,
    /// What stands at 0, 1 and so on in place of numbers.
    names: Vec<String>,
}

/// A labelled tick: its place along the axis from 0 to 1.
pub(super) type Tick = (f64, String);

impl PlotAxis {
    /// An axis over all finite `values`, widened by `margin` of its length at both ends.
    pub fn over(
        values: impl Iterator<Item = f64> + Clone,
        units: &str,
        label: &str,
        log: bool,
        margin: f64,
    ) -> Self {
        let finite = values.filter(|value| value.is_finite() && (!log || *value > 0.0));
        let largest = finite.clone().fold(0.0, |most: f64, value| most.max(value.abs()));
        let unit = DisplayUnit::fitting(units, largest);
        let scaled = |value: f64| if log { unit.show(value).log10() } else { unit.show(value) };
        let (mut low, mut high) = ends(finite.map(scaled));
        if low > high {
            (low, high) = (0.0, 1.0);
        }
        // A single value, or values whose differences are rounding, still need a range to stand in.
        if high - low <= 1e-9 * high.abs().max(low.abs()) {
            let half = if log || high == 0.0 { 0.5 } else { 0.1 * high.abs() };
            (low, high) = (low - half, high + half);
        } else {
            let margin = margin * (high - low);
            (low, high) = (low - margin, high + margin);
        }
        let label = unit.label(label);
        Self { low, high, log, unit, label, names: Vec::new() }
    }

    /// The axis of what is swept, with names where it has names.
    pub fn of(swept: &Coordinate, margin: f64) -> Self {
        let log = swept.words.is_empty() && is_log_spaced(&swept.values);
        let axis = Self::over(swept.values.iter().copied(), &swept.units, &short(swept), log, margin);
        match swept.words.len() {
            0 => axis,
            count => Self { names: swept.words.clone(), ..axis.between(-0.5, count as f64 - 0.5) },
        }
    }

    /// Whether names stand along it.
    pub fn has_names(&self) -> bool {
        !self.names.is_empty()
    }

    /// The same axis with these ends, given on the scale of [`PlotAxis::scaled`].
    pub fn between(mut self, low: f64, high: f64) -> Self {
        (self.low, self.high) = (low, high);
        self
    }

    /// A value in shown units, as a logarithm if the axis is logarithmic.
    pub fn scaled(&self, value: f64) -> f64 {
        let shown = self.unit.show(value);
        if self.log { shown.log10() } else { shown }
    }

    /// Where a value stands, from 0 to 1 within the axis; NaN for one that cannot be shown.
    pub fn place(&self, value: f64) -> f64 {
        self.place_scaled(self.scaled(value))
    }

    /// As [`PlotAxis::place`], for what [`PlotAxis::scaled`] gives.
    pub fn place_scaled(&self, scaled: f64) -> f64 {
        let place = (scaled - self.low) / (self.high - self.low);
        if place.is_finite() { place } else { f64::NAN }
    }

    /// About `count` labelled ticks, and the places of small ones between them.
    pub fn ticks(&self, count: usize) -> (Vec<Tick>, Vec<f64>) {
        match (self.names.as_slice(), self.log) {
            ([], true) => self.log_ticks(count),
            ([], false) => (self.linear_ticks(count), Vec::new()),
            (names, _) => {
                let tick = |(i, name): (usize, &String)| (self.place_scaled(i as f64), name.clone());
                (names.iter().enumerate().map(tick).collect(), Vec::new())
            }
        }
    }

    /// The first and the last multiple of a step on the axis, over the step.
    fn multiples(&self, step: f64) -> (f64, f64) {
        ((self.low / step - 1e-6).ceil(), (self.high / step + 1e-6).floor())
    }

    fn linear_ticks(&self, count: usize) -> Vec<Tick> {
        let span = self.high - self.low;
        let rough = span / (count.max(1) as f64 + 0.5);
        let power = 10f64.powf(rough.log10().floor());
        let angles = [5.0, 10.0, 15.0, 30.0, 45.0, 60.0, 90.0];
        let step = match angles.into_iter().find(|step| *step >= rough) {
            Some(step) if self.unit.text == "°" && rough > 2.0 => step,
            _ => {
                let round = [10.0, 5.0, 2.0, 1.0, 0.5].map(|m| m * power);
                let near = round.iter().rposition(|step| *step >= rough).unwrap_or(0);
                // One tick tells no scale.
                let tells = |step: &&f64| self.multiples(**step).1 > self.multiples(**step).0;
                round[near..].iter().find(tells).copied().unwrap_or(rough)
            }
        };
        let (first, last) = self.multiples(step);
        if !(step > 0.0 && (last - first) < 100.0) {
            return Vec::new();
        }
        // As many digits as tell neighbouring ticks apart.
        let largest = self.low.abs().max(self.high.abs());
        let digits = ((largest / step).log10().floor().max(0.0) as usize + 2).min(12);
        (first as i64..=last as i64)
            .map(|i| {
                let value = i as f64 * step;
                (self.place_scaled(value), number(value, digits))
            })
            .collect()
    }

    fn log_ticks(&self, count: usize) -> (Vec<Tick>, Vec<f64>) {
        let inside = |scaled: &f64| *scaled >= self.low - 1e-9 && *scaled <= self.high + 1e-9;
        let decades = (self.low.floor() as i32, self.high.ceil() as i32);
        let span = self.high - self.low;
        if span < 0.7 {
            // Less than a factor of 5: ordinary steps say more than powers of ten.
            let shown =
                Self { low: 10f64.powf(self.low), high: 10f64.powf(self.high), log: false, ..self.clone() };
            let ticks = shown.linear_ticks(count).into_iter().map(|(place, text)| {
                let value: f64 = shown.low + place * (shown.high - shown.low);
                (self.place_scaled(value.log10()), text)
            });
            return (ticks.collect(), Vec::new());
        }
        // A single power of ten gives no scale.
        let powers = (decades.0..=decades.1).filter(|power| inside(&f64::from(*power))).count();
        let multiples: &[f64] = if span < 1.6 || powers < 2 { &[1.0, 2.0, 5.0] } else { &[1.0] };
        let every = ((span / count.max(1) as f64).ceil() as i32).max(1);
        let mut ticks = Vec::new();
        let mut small = Vec::new();
        for power in decades.0..=decades.1 {
            for multiple in multiples {
                let scaled = f64::from(power) + multiple.log10();
                if inside(&scaled) && power.rem_euclid(every) == 0 {
                    let text = if (-3..5).contains(&power) {
                        number(multiple * 10f64.powi(power), 3)
                    } else {
                        format!("10{}", superscript(power))
                    };
                    ticks.push((self.place_scaled(scaled), text));
                }
            }
            if every == 1 {
                let between = (2..10).map(|m| f64::from(power) + f64::from(m).log10());
                small.extend(between.filter(inside).map(|scaled| self.place_scaled(scaled)));
            } else if inside(&f64::from(power)) {
                small.push(self.place_scaled(f64::from(power)));
            }
        }
        (ticks, small)
    }
}

/// True where values read better on a logarithmic axis: they span a factor of ten or more and are spaced
/// more evenly in the logarithm.
pub(super) fn is_log_spaced(values: &[f64]) -> bool {
    let mut sorted: Vec<f64> = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.dedup();
    let (Some(&low), Some(&high)) = (sorted.first(), sorted.last()) else { return false };
    if !(low > 0.0 && high.is_finite() && high / low >= 9.99) {
        return false;
    }
    let unevenness = |gaps: &mut dyn Iterator<Item = f64>| {
        let (mut least, mut most) = (f64::INFINITY, 0.0f64);
        for gap in gaps {
            (least, most) = (least.min(gap), most.max(gap));
        }
        most / least
    };
    if sorted.len() == 2 {
        return high / low >= 99.9;
    }
    let linear = unevenness(&mut sorted.windows(2).map(|pair| pair[1] - pair[0]));
    let logarithmic = unevenness(&mut sorted.windows(2).map(|pair| (pair[1] / pair[0]).ln()));
    logarithmic < linear
}

/// True where positive values span so many decades that a linear axis would hide most of them.
pub(super) fn spans_decades(values: impl Iterator<Item = f64>) -> bool {
    let (low, high) = ends(values.filter(|value| value.is_finite()));
    low > 0.0 && high / low > 300.0
}

/// The least value that a logarithmic axis goes down to, where these need one. A few that lie far below all others, as where
/// a tip grazes, are not what it goes by.
pub(super) fn least_of_decades(values: impl Iterator<Item = f64>) -> Option<f64> {
    let mut sorted: Vec<f64> = values.filter(|value| value.is_finite()).collect();
    sorted.sort_by(f64::total_cmp);
    let few = sorted.len().div_ceil(50).min(sorted.len() / 8);
    let (least, next) = (*sorted.first()?, *sorted.get(few)?);
    let low = if next > 10.0 * least { next } else { least };
    spans_decades([low, *sorted.last()?].into_iter()).then_some(low).filter(|_| least > 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(axis: &PlotAxis, count: usize) -> Vec<String> {
        axis.ticks(count).0.into_iter().map(|(_, text)| text).collect()
    }

    #[test]
    fn ticks_are_round_and_inside() {
        let axis = PlotAxis::over([0.0, 97e-9].into_iter(), "m", "gap", false, 0.0);
        assert_eq!(axis.label, "gap (nm)");
        assert_eq!(texts(&axis, 5), ["0", "20", "40", "60", "80"]);
        let axis = PlotAxis::over([1e8, 1e11].into_iter(), "Pa", "modulus", true, 0.0);
        assert_eq!(texts(&axis, 5), ["0.1", "1", "10", "100"]);
        let axis = PlotAxis::over([5e-9, 40e-9].into_iter(), "m", "radius", true, 0.0);
        assert_eq!(texts(&axis, 5), ["5", "10", "20"]);
        let axis = PlotAxis::over([-4.6e-9, 4.6e-9].into_iter(), "m", "travel", false, 0.0);
        assert_eq!(texts(&axis, 2), ["−4", "−2", "0", "2", "4"]);
        let axis = PlotAxis::over([0.0, 180.0].into_iter(), "degree", "phase", false, 0.0);
        assert_eq!(texts(&axis, 5), ["0", "45", "90", "135", "180"]);
    }

    #[test]
    fn no_values_one_value_and_huge_values_make_an_axis() {
        for values in [vec![], vec![f64::NAN], vec![0.0], vec![3.0], vec![1e300, -1e300], vec![1e-320]] {
            for log in [false, true] {
                let axis = PlotAxis::over(values.iter().copied(), "m", "x", log, 0.05);
                assert!(axis.ticks(5).0.iter().all(|(place, _)| place.is_finite()), "{values:?}");
            }
        }
    }

    /// Truth: the values put in.
    #[test]
    fn a_short_logarithmic_axis_has_more_ticks_than_one() {
        let axis = PlotAxis::over([1.3e9, 70e9].into_iter(), "Pa", "modulus", true, 0.0);
        assert_eq!(texts(&axis, 5), ["2", "5", "10", "20", "50"]);
    }

    #[test]
    fn one_value_far_below_the_others_stretches_no_axis() {
        let near: Vec<f64> = (1..40).map(f64::from).collect();
        assert_eq!(least_of_decades(near.iter().copied().chain([1e-4])), None);
        assert_eq!(least_of_decades(near.iter().copied()), None);
        let wide = || (0..40).map(|i| 10f64.powf(f64::from(i) / 10.0));
        assert_eq!(least_of_decades(wide()), Some(1.0));
        assert_eq!(least_of_decades(wide().chain([1e-9])), Some(1.0));
        assert_eq!(least_of_decades(wide().chain([0.0])), None);
    }

    #[test]
    fn names_are_the_ticks() {
        let material = Coordinate {
            name: "material".into(),
            words: vec!["PS".into(), "PMMA".into()],
            values: vec![0.0, 1.0].into(),
            ..Coordinate::default()
        };
        let axis = PlotAxis::of(&material, 0.0);
        assert_eq!(axis.ticks(9).0, [(0.25, "PS".to_owned()), (0.75, "PMMA".to_owned())]);
    }

    #[test]
    fn spacing_decides_on_the_logarithm() {
        assert!(is_log_spaced(&[1e8, 1e9, 1e10]));
        assert!(is_log_spaced(&[1.0, 2.0, 5.0, 10.0, 20.0, 50.0]));
        assert!(!is_log_spaced(&[5.0, 10.0, 15.0, 20.0, 40.0]));
        assert!(!is_log_spaced(&[0.0, 1.0, 10.0, 100.0]));
        assert!(!is_log_spaced(&[1.0, 20.0, 40.0, 60.0, 80.0]));
        assert!(!is_log_spaced(&[]));
    }
}

//! Many curves in one picture: at each point the middle of their values and the band that holds most of them.

use super::ReportError;
use super::axis::is_log_spaced;
use super::chart::{Chart, Field, Look, Plot};
use super::from_curve::{is_ok, jumps};
use super::labels::short;
use crate::store::{Results, Variable};

/// So many curves make a band.
const FEWEST: usize = 10;
/// Words of the two ways.
const WAYS: [&str; 2] = ["forward", "backward"];
/// Shares of the values below each line.
const SHARES: [f64; 3] = [0.05, 0.5, 0.95];

/// A picture, a note on it and its numbers.
pub(super) struct Band {
    pub svg: String,
    pub note: String,
    pub csv: String,
}

/// None where the results have no or few curves.
pub(super) fn draw(
    results: &Results,
    variable: &Variable,
    heading: &str,
) -> Result<Option<Band>, ReportError> {
    let (Some(_), Some(axis), None) = (jumps(results), results.axes.last(), variable.harmonics) else {
        return Ok(None);
    };
    let both = results.axes.iter().rev().nth(1).is_some_and(|axis| axis.name == "direction");
    let (length, ways) = (axis.values.len(), if both { 2 } else { 1 });
    let curves = results.status.len() / (length * ways).max(1);
    if curves < FEWEST || results.list {
        return Ok(None);
    }
    let (mut series, mut lines) = (Vec::new(), Vec::new());
    let mut csv = format!("way,{} [{}]", axis.name, axis.units);
    SHARES.iter().for_each(|share| csv += &format!(",share {share} [{}]", variable.units));
    csv.push('\n');
    for (way, word) in WAYS.iter().enumerate().take(ways) {
        let values = |point: usize| -> Vec<f64> {
            let instances = (0..curves).map(|curve| (curve * ways + way) * length + point);
            let held = instances.filter(|i| is_ok(results, *i)).map(|i| variable.data[i]);
            let mut held: Vec<f64> = held.filter(|value| value.is_finite()).collect();
            held.sort_by(f64::total_cmp);
            held
        };
        let bands: Vec<[f64; 3]> =
            (0..length).map(values).map(|held| SHARES.map(|share| quantile(&held, share))).collect();
        for (x, [low, middle, high]) in axis.values.iter().zip(&bands) {
            csv += &format!("{word},{x:e},{low:e},{middle:e},{high:e}\n");
        }
        let line = |which: usize| axis.values.iter().zip(&bands).map(move |(x, band)| (*x, band[which]));
        let gap = std::iter::once((f64::NAN, f64::NAN));
        let name = if both { format!("{word}, ") } else { String::new() };
        let look = |name: String, width, dashed| Look { name, width, dashed, dots: false };
        series.push(look(format!("{name}median"), 2.4, false));
        lines.push(line(1).collect());
        series.push(look(format!("{name}5 % and 95 %"), 1.4, true));
        lines.push(line(0).chain(gap).chain(line(2)).collect());
    }
    let label = if variable.long_name.is_empty() { &variable.name } else { &variable.long_name };
    let panel =
        Plot { label: label.clone(), units: variable.units.clone(), lines, marks: Vec::new(), height: 360.0 };
    let x = Field { label: short(axis), units: axis.units.clone(), log: is_log_spaced(&axis.values) };
    let chart = Chart { title: heading.to_owned(), x, series, panels: vec![panel] };
    let note = format!("Of {curves} curves, at each point of those that are ok.");
    Ok(Some(Band { svg: chart.draw()?, note, csv }))
}

/// The value below which this share of sorted values lies, between neighbours linear; NaN of none.
fn quantile(sorted: &[f64], share: f64) -> f64 {
    let place = share * sorted.len().saturating_sub(1) as f64;
    let (low, rest) = (place.floor() as usize, place.fract());
    match (sorted.get(low), sorted.get(low + 1)) {
        (Some(a), Some(b)) => a + rest * (b - a),
        (Some(a), None) => *a,
        _ => f64::NAN,
    }
}

#[cfg(test)]
mod tests {
    /// Truth: NumPy 2 (`numpy.quantile`, its default, linear).
    #[test]
    fn quantiles_are_numpys() {
        let values = [1.0, 2.0, 4.0, 8.0];
        for (share, expected) in [(0.05, 1.15), (0.5, 3.0), (0.95, 7.4), (1.0, 8.0)] {
            assert!((super::quantile(&values, share) - expected).abs() < 1e-12, "{share}");
        }
        assert!(super::quantile(&[], 0.5).is_nan());
    }
}

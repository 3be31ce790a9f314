//! What values are over an axis of many cases: the middle, and shaded where half of them and where nine of ten lie.

use super::axis::PlotAxis;
use super::canvas::{INK, LINES};
use super::curve_forces::{is_ok, jumps};
use super::frame::{Frame, Legend};
use super::hover::Hover;
use super::labels::{capital, names, shown};
use super::picture::{Picture, PictureKind, places};
use super::stack::Stack;
use super::view_request::DIRECTION;
use super::{SAMPLES, csv};
use crate::store::{Coordinate, Results, Variable};

const LAYOUT: Stack = Stack { width: 560.0, gap: 0.0, top: 40.0, key: None, beyond: 28.0 };
/// So many curves make a band.
const FEWEST: usize = 10;
/// Bands in one picture at most.
const MOST: usize = 6;
/// Shares of the values below each line of a band, the middle one among them.
pub(super) const SHARES: [f64; 5] = [0.05, 0.25, 0.5, 0.75, 0.95];
/// How much of the ground the outer and the inner band cover.
const COVER: [f64; 2] = [0.16, 0.3];

/// One band: its name and, at each place of the axis, the values at [`SHARES`].
pub(super) struct BandSeries {
    pub name: String,
    pub points: Vec<[f64; 5]>,
}

/// Bands over a common axis.
pub(super) struct Bands<'a> {
    pub title: &'a str,
    pub x: &'a Coordinate,
    pub label: &'a str,
    pub units: &'a str,
    pub series: Vec<BandSeries>,
}

impl Bands<'_> {
    /// The picture as SVG. Names along the axis have bars in place of areas.
    pub fn draw(&self) -> String {
        let x_axis = PlotAxis::of(self.x, 0.0);
        let values = self.series.iter().flat_map(|one| &one.points).flatten().copied();
        let y_axis = PlotAxis::over(values, self.units, self.label, false, 0.06);
        let mut entries: Vec<(Legend, String)> = Vec::new();
        for (number, one) in self.series.iter().enumerate().filter(|_| self.series.len() > 1) {
            entries.push((Legend::Line(LINES[number % LINES.len()]), one.name.clone()));
        }
        let middle = if self.series.len() > 1 { INK } else { LINES[0] };
        entries.push((Legend::Line(middle), "median".to_owned()));
        entries.push((Legend::Shade(middle, COVER[0] + COVER[1]), "25 to 75 %".to_owned()));
        entries.push((Legend::Shade(middle, COVER[0]), "5 to 95 %".to_owned()));
        LAYOUT.draw((self.title, &entries), &x_axis, &[(&y_axis, 360.0)], |_, frame| {
            frame.grid();
            for number in 0..self.series.len() {
                self.band(frame, number);
            }
            frame.edges(true, true)
        })
    }

    /// One band; places without values interrupt it.
    fn band(&self, frame: &Frame, number: usize) {
        let (canvas, shade) = (frame.canvas, LINES[number % LINES.len()]);
        let mut order: Vec<usize> = (0..self.x.values.len()).collect();
        order.sort_by(|a, b| self.x.values[*a].total_cmp(&self.x.values[*b]));
        let points = &self.series[number].points;
        let whole = |i: &usize| points[*i].iter().all(|value| value.is_finite());
        let beside = if frame.x.has_names() { 10.0 } else { 0.0 };
        let shift = beside * (number as f64 - 0.5 * (self.series.len() as f64 - 1.0));
        let at = |i: &usize, which: usize| {
            let (x, y) = frame.at(self.x.values[*i], points[*i][which]);
            (x + shift, y)
        };
        for piece in order.split(|i| !whole(i)).filter(|piece| !piece.is_empty()) {
            for ((low, high), cover) in [(0, 4), (1, 3)].into_iter().zip(COVER) {
                if frame.x.has_names() || piece.len() == 1 {
                    for i in piece {
                        let (a, b) = (at(i, low), at(i, high));
                        canvas.shade(
                            &[(a.0 - 4.0, a.1), (a.0 + 4.0, a.1), (b.0 + 4.0, b.1), (b.0 - 4.0, b.1)],
                            (shade, cover),
                        );
                    }
                } else {
                    let there = piece.iter().map(|i| at(i, low));
                    let back = piece.iter().rev().map(|i| at(i, high));
                    canvas.shade(&there.chain(back).collect::<Vec<_>>(), (shade, cover));
                }
            }
            let middle: Vec<(f64, f64)> = piece.iter().map(|i| at(i, 2)).collect();
            match frame.x.has_names() || piece.len() == 1 {
                true => middle.iter().for_each(|at| canvas.dot(*at, 3.4, shade)),
                false => canvas.line(&middle, shade, 2.2),
            }
        }
    }
}

/// The bands of a variable over many curves or samples. None where there are few.
pub(super) fn draw(results: &Results, variable: &Variable) -> Option<Picture> {
    let kind = PictureKind::of(variable);
    if results.list || variable.harmonics.is_some() || kind == PictureKind::Computed {
        return None;
    }
    let axes = &results.axes;
    let samples = axes.iter().position(|axis| axis.scene_path == SAMPLES);
    let x = axis_of(axes, samples.is_some() || jumps(results).is_some())?;
    // What is not pooled makes bands of their own: the ways, and beside samples all other axes.
    let apart: Vec<usize> = (0..axes.len())
        .filter(|axis| *axis != x && samples != Some(*axis))
        .filter(|axis| samples.is_some() || axes[*axis].name == DIRECTION)
        .collect();
    let count: usize = apart.iter().map(|axis| axes[*axis].values.len()).product();
    let pooled = results.status.len() / (count * axes[x].values.len()).max(1);
    if pooled < FEWEST {
        return None;
    }
    let shown_bands = count.min(MOST);
    let length = axes[x].values.len();
    let mut held: Vec<Vec<f64>> = vec![Vec::new(); shown_bands * length];
    let mut called = vec![String::new(); shown_bands];
    for i in (0..results.status.len()).filter(|i| is_ok(results, *i) && variable.data[*i].is_finite()) {
        let places = places(results, i);
        let band = apart.iter().fold(0, |band, axis| band * axes[*axis].values.len() + places[*axis].1);
        if band < shown_bands {
            held[band * length + places[x].1].push(variable.data[i]);
            if called[band].is_empty() {
                let one = |axis: &usize| shown(places[*axis].0, axes[*axis].values[places[*axis].1]);
                called[band] = apart.iter().map(one).collect::<Vec<_>>().join(", ");
            }
        }
    }
    let quantiles = |values: &mut Vec<f64>| {
        values.sort_by(f64::total_cmp);
        SHARES.map(|share| quantile(values, share))
    };
    let points: Vec<[f64; 5]> = held.iter_mut().map(quantiles).collect();
    let series = called.into_iter().zip(points.chunks(length));
    let series: Vec<BandSeries> =
        series.map(|(name, points)| BandSeries { name, points: points.to_vec() }).collect();
    let csv = numbers(&axes[x], variable, &series);
    let (name, label) = names(variable);
    let title = format!("{}, median and bands", capital(name));
    let bands = Bands { title: &title, x: &axes[x], label: &label, units: &variable.units, series };
    let what = if samples.is_some() { "samples" } else { "curves" };
    let mut note = format!("Of {pooled} {what}, at each point of those that are ok.");
    if count > MOST {
        note += &format!(" The first {MOST} of {count} bands.");
    }
    let (svg, hover, name) = (bands.draw(), Hover::default(), format!("{}_band", variable.name));
    Some(Picture { kind, name, title, note, svg, hover, csv: Some(csv) })
}

/// The axis that bands are drawn over: the last one of numbers; beside samples otherwise one of names.
fn axis_of(axes: &[Coordinate], many: bool) -> Option<usize> {
    let usable = |axis: &usize| axes[*axis].scene_path != SAMPLES && axes[*axis].values.len() > 1;
    let numbers = |axis: &usize| usable(axis) && axes[*axis].words.is_empty();
    let all = || (0..axes.len()).rev().filter(|_| many);
    all().find(numbers).or_else(|| all().find(usable))
}

fn numbers(x: &Coordinate, variable: &Variable, series: &[BandSeries]) -> String {
    let shares = SHARES.map(|share| format!("share {share} [{}]", variable.units));
    let mut rows =
        vec![["band".to_owned(), csv::head(&x.name, &x.units)].into_iter().chain(shares).collect()];
    for one in series {
        rows.extend(one.points.iter().take(x.values.len()).enumerate().map(|(i, point)| {
            let place = [csv::defused(one.name.clone()), csv::place(x, i)];
            place.into_iter().chain(point.map(csv::number)).collect()
        }));
    }
    csv::table(rows)
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

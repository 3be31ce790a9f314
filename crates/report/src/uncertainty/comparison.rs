//! A measured curve over what is predicted: points with their standard deviations, the median, the band of 95 %.

use super::super::axis::PlotAxis;
use super::super::canvas::{Anchor, INK, LINES};
use super::super::frame::{Frame, Legend, is_place, pieces};
use super::super::stack::Stack;
use crate::stats::StudyOutput;

/// A measured curve beside what the weighted samples say.
#[derive(Clone, Debug)]
pub struct Comparison {
    pub file: String,
    /// What its places are, in words and as a name, and their SI unit.
    pub along: String,
    pub name: String,
    pub units: String,
    /// Rows and values that count, and rows that do not.
    pub rows: usize,
    pub values: usize,
    pub left_out: usize,
    pub observables: Vec<String>,
    pub panels: Vec<Compared>,
}

/// An observable, by its number in the study, measured or not.
#[derive(Clone, Debug)]
pub struct Compared {
    pub output: usize,
    pub ways: Vec<PredictionPath>,
}

/// One way along a curve.
#[derive(Clone, Debug)]
pub struct PredictionPath {
    /// Empty where there is but one.
    pub name: String,
    /// Place, value and standard deviation of what was measured.
    pub points: Vec<(f64, f64, f64)>,
    /// Places, and 2.5 %, median and 97.5 % of what is predicted there, as it would be measured.
    pub band: Vec<(f64, [f64; 3])>,
}

/// Pixels of a slice of the band.
const SLICE: f64 = 1.5;
const LAYOUT: Stack = Stack { width: 560.0, gap: 30.0, top: 40.0, key: Some(44.0), beyond: 0.0 };

/// One panel for each way.
pub(super) fn draw(
    heading: &str,
    output: &StudyOutput,
    (along, units): (&str, &str),
    ways: &[PredictionPath],
) -> String {
    let places = ways.iter().flat_map(|way| way.band.iter().map(|(place, _)| *place));
    let x = PlotAxis::over(places, units, along, false, 0.02);
    let values = |way: &'_ PredictionPath| {
        let band = way.band.iter().flat_map(|(_, band)| *band);
        let points = way.points.iter().flat_map(|(_, value, sd)| [value - sd, value + sd]);
        band.chain(points).collect::<Vec<f64>>()
    };
    let label = super::called(output);
    let all: Vec<f64> = ways.iter().flat_map(values).collect();
    let y = PlotAxis::over(all.into_iter(), &output.units, &label, false, 0.06);
    let mut entries = vec![
        (Legend::Swatch(LINES[5]), "predicted, 95 %".to_owned()),
        (Legend::Line(INK), "median".to_owned()),
    ];
    if ways.iter().any(|way| !way.points.is_empty()) {
        entries.insert(0, (Legend::Dot(LINES[1]), "measured, one standard deviation".to_owned()));
    }
    let panels: Vec<(&PlotAxis, f64)> = ways.iter().map(|_| (&y, 280.0)).collect();
    LAYOUT.draw((heading, &entries), &x, &panels, |n, frame| {
        frame.grid();
        panel(frame, &ways[n]);
        frame.edges(n + 1 == ways.len(), true);
        if !ways[n].name.is_empty() {
            let at = (frame.left + 8.0, frame.top + 12.0);
            frame.canvas.text(&ways[n].name, at, 12.0, Anchor::Left, INK);
        }
    })
}

fn panel(frame: &Frame, way: &PredictionPath) {
    let canvas = frame.canvas;
    let at = |n: usize, share: usize| frame.at(way.band[n].0, way.band[n].1[share]);
    for n in 1..way.band.len() {
        let corners = [at(n - 1, 0), at(n, 0), at(n - 1, 2), at(n, 2)];
        if !corners.iter().all(is_place) {
            continue;
        }
        let [(from, low), (to, low_to), (_, high), (_, high_to)] = corners;
        // In slices, so that its edges are slanted.
        let slices = ((to - from).abs() / SLICE).ceil().max(1.0);
        for slice in 0..slices as usize {
            let share = |end: f64| (slice as f64 + end) / slices;
            let between = |a: f64, b: f64, share: f64| a + share * (b - a);
            let middle = share(0.5);
            let a = between(high, high_to, middle);
            // Where the band is thinner than a line it is one.
            let b = between(low, low_to, middle).max(a + 1.6);
            // Slices lie over each other by a hair: between two that only touch the ground shows.
            let end = between(from, to, share(1.0)) + 0.5 * (to - from).signum();
            canvas.rectangle((between(from, to, share(0.0)), a), (end, b), LINES[5]);
        }
    }
    let median: Vec<(f64, f64)> = (0..way.band.len()).map(|n| at(n, 1)).collect();
    for piece in pieces(&median) {
        canvas.line(piece, INK, 1.2);
    }
    for (place, value, sd) in &way.points {
        let (x, y) = frame.at(*place, *value);
        let (low, high) = (frame.at(*place, value - sd).1, frame.at(*place, value + sd).1);
        canvas.line(&[(x, low), (x, high)], LINES[1], 1.3);
        for end in [low, high] {
            canvas.line(&[(x - 2.5, end), (x + 2.5, end)], LINES[1], 1.3);
        }
        canvas.dot((x, y), 2.6, LINES[1]);
    }
}

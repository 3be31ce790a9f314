//! How values are distributed, weighted or not, with quantiles as lines.

use super::super::axis::PlotAxis;
use super::super::canvas::{INK, LINES};
use super::super::frame::{Frame, Legend};
use super::super::quantity_text::DisplayUnit;
use super::super::stack::Stack;

const LAYOUT: Stack = Stack { width: 560.0, gap: 0.0, top: 40.0, key: Some(44.0), beyond: 0.0 };

/// Most bars.
const BARS: usize = 60;

/// Values and their weights over equal steps of an axis.
pub(super) struct Bars {
    pub axis: PlotAxis,
    /// Share of the weight in each step.
    pub shares: Vec<f64>,
}

impl Bars {
    /// Over this axis, in as many steps as so many values fill; what lies beyond its ends is in no bar. `weights` has one for
    /// each value, or is empty where all count the same.
    pub fn over(axis: PlotAxis, values: &[f64], weights: &[f64], effective: f64) -> Self {
        let count = (effective.sqrt() as usize).clamp(8, BARS);
        let mut shares = vec![0.0; count];
        for (n, value) in values.iter().enumerate() {
            let place = axis.place(*value);
            if (0.0..=1.0).contains(&place) {
                let at = ((place * count as f64) as usize).min(count - 1);
                shares[at] += weights.get(n).copied().unwrap_or(1.0);
            }
        }
        let sum: f64 = match weights {
            [] => values.len() as f64,
            weights => weights.iter().sum(),
        };
        if sum > 0.0 {
            shares.iter_mut().for_each(|share| *share /= sum);
        }
        Self { axis, shares }
    }

    /// Draws the bars into a frame whose y axis holds their shares.
    pub fn draw(&self, frame: &Frame) {
        let bottom = frame.top + frame.height;
        let wide = frame.width / self.shares.len() as f64;
        for (n, share) in self.shares.iter().enumerate().filter(|(_, share)| **share > 0.0) {
            let left = frame.left + n as f64 * wide;
            let top = frame.top + (1.0 - frame.y.place(*share)) * frame.height;
            frame.canvas.rectangle((left + 0.3, top), (left + wide - 0.3, bottom), LINES[5]);
        }
    }
}

/// A picture of an observable: its bars, its mean and quantiles. `left_out` says which rows are not in it; it may be empty.
pub(super) fn draw(
    heading: &str,
    values: &[f64],
    (label, units): (&str, &str),
    quantiles: &[(f64, f64)],
    left_out: &str,
) -> String {
    let x = PlotAxis::over(values.iter().copied(), units, label, false, 0.0);
    let bars = Bars::over(x, values, &[], values.len() as f64);
    let shares = [0.0].into_iter().chain(bars.shares.iter().copied());
    let y = PlotAxis::over(shares, "1", "share of the rows", false, 0.02);
    let largest = quantiles.iter().fold(0.0, |most: f64, (_, value)| most.max(value.abs()));
    let unit = DisplayUnit::fitting(units, largest);
    let mut entries: Vec<(Legend, String)> = quantiles
        .iter()
        .map(|(share, value)| {
            let words = format!("{} % below {}", 100.0 * share, unit.value(*value));
            (if *share == 0.5 { Legend::Line(INK) } else { Legend::Dashes(INK) }, words)
        })
        .collect();
    if !left_out.is_empty() {
        entries.push((Legend::Hatched, format!("left out: {left_out}")));
    }
    LAYOUT.draw((heading, &entries), &bars.axis, &[(&y, 260.0)], |_, frame| {
        frame.grid();
        bars.draw(frame);
        for (share, value) in quantiles {
            let x = frame.at(*value, f64::NAN).0;
            let middle = *share == 0.5;
            let pen = (INK, if middle { 1.4 } else { 1.0 });
            frame.canvas.stroke(&[(x, frame.top), (x, frame.top + frame.height)], pen, !middle);
        }
        frame.edges(true, true)
    })
}

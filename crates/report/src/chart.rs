//! Lines over a common axis, in one panel or several above each other, with marked points.

use super::axis::{PlotAxis, spans_decades};
use super::canvas::{Anchor, Canvas, INK, LINES, WHITE};
use super::frame::{Frame, Legend, SMALL, is_place, pieces};
use super::stack::Stack;

const LAYOUT: Stack = Stack { width: 640.0, gap: 18.0, top: 48.0, key: Some(46.0), beyond: 24.0 };

/// How a series is drawn, the same in every panel.
#[derive(Clone, Debug)]
pub struct Look {
    /// For the key.
    pub name: String,
    /// Pixels. Series drawn later lie on top: with falling widths, lines in one place still show.
    pub width: f64,
    pub dashed: bool,
    /// Whether its points are marked.
    pub dots: bool,
}

/// A point worth a word.
#[derive(Clone, Debug)]
pub struct Mark {
    pub x: f64,
    pub y: f64,
    pub text: String,
    /// Where the words stand, in pixels from the point: right and up.
    pub offset: (f64, f64),
}

/// One panel.
#[derive(Clone, Debug)]
pub struct Plot {
    /// What its values are.
    pub label: String,
    /// SI unit of the values, as the results file writes it.
    pub units: String,
    /// Points (x, y), SI, for each series in the order of [`Chart::series`]; none for one that the panel
    /// does not show. A point that is not finite interrupts its line.
    pub lines: Vec<Vec<(f64, f64)>>,
    pub marks: Vec<Mark>,
    /// Height of the panel, pixels.
    pub height: f64,
}

/// The common axis.
#[derive(Clone, Debug)]
pub struct ChartField {
    pub label: String,
    /// SI unit, as the results file writes it.
    pub units: String,
    pub log: bool,
}

/// Panels above each other.
#[derive(Clone, Debug)]
pub struct Chart {
    pub title: String,
    pub x: ChartField,
    pub series: Vec<Look>,
    pub panels: Vec<Plot>,
}

impl Chart {
    /// The picture as SVG. Values that are all positive and span decades get a logarithmic axis.
    pub fn draw(&self) -> String {
        let points = || self.panels.iter().flat_map(|panel| panel.lines.iter().flatten());
        let x_axis =
            PlotAxis::over(points().map(|point| point.0), &self.x.units, &self.x.label, self.x.log, 0.0);
        let axes: Vec<PlotAxis> = self.panels.iter().map(Plot::axis).collect();
        let entries: Vec<(Legend, String)> = self
            .series
            .iter()
            .enumerate()
            .map(|(number, look)| {
                let shade = LINES[number % LINES.len()];
                let sample = if look.dashed { Legend::Dashes(shade) } else { Legend::Line(shade) };
                (sample, look.name.clone())
            })
            .collect();
        let heights = self.panels.iter().map(|panel| panel.height);
        let panels: Vec<(&PlotAxis, f64)> = axes.iter().zip(heights).collect();
        LAYOUT.draw((&self.title, &entries), &x_axis, &panels, |number, frame| {
            self.panel(frame, &self.panels[number]);
            frame.edges(number + 1 == panels.len(), true)
        })
    }

    fn panel(&self, frame: &Frame, panel: &Plot) {
        frame.grid();
        frame.zeros(false);
        for (number, (line, look)) in panel.lines.iter().zip(&self.series).enumerate() {
            let shade = LINES[number % LINES.len()];
            let places: Vec<(f64, f64)> = line.iter().map(|&(x, y)| frame.at(x, y)).collect();
            for piece in pieces(&places) {
                frame.canvas.stroke(piece, (shade, look.width), look.dashed);
                if look.dots {
                    piece.iter().for_each(|at| frame.canvas.dot(*at, 1.2 + look.width, shade));
                }
            }
        }
        panel.marks.iter().for_each(|mark| mark.draw(frame.canvas, frame.at(mark.x, mark.y)))
    }
}

impl Look {
    /// A line without marks at its points.
    pub fn line(name: &str, width: f64, dashed: bool) -> Self {
        Self { name: name.to_owned(), width, dashed, dots: false }
    }
}

impl Plot {
    /// A panel of this height without marked points.
    pub fn new(label: &str, units: &str, height: f64, lines: Vec<Vec<(f64, f64)>>) -> Self {
        Self { label: label.to_owned(), units: units.to_owned(), lines, marks: Vec::new(), height }
    }

    fn axis(&self) -> PlotAxis {
        let values = self.lines.iter().flatten().map(|point| point.1);
        PlotAxis::over(values.clone(), &self.units, &self.label, spans_decades(values), 0.06)
    }
}

impl Mark {
    fn draw(&self, canvas: &Canvas, at: (f64, f64)) {
        if !is_place(&at) {
            return;
        }
        canvas.dot(at, 4.4, WHITE);
        canvas.dot(at, 3.2, INK);
        let anchor = if self.offset.0 < 0.0 { Anchor::Right } else { Anchor::Left };
        let place = (at.0 + self.offset.0, at.1 - self.offset.1);
        canvas.line(&[at, place], INK, 0.7);
        canvas.text(&self.text, (place.0 + self.offset.0.signum() * 3.0, place.1), SMALL, anchor, INK)
    }
}

//! Lines over a common axis, in one panel or several above each other, with marked points.

use super::ReportError;
use super::axis::{PlotAxis, spans_decades};
use super::canvas::{Anchor, Canvas, INK, LINES, WHITE, picture};
use super::frame::{Frame, KEY_ROW, Legend, SMALL, key, key_rows, left_margin, title};

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
    ///
    /// # Errors
    /// [`ReportError::Draw`].
    pub fn draw(&self) -> Result<String, ReportError> {
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
        let (width, gap) = (640.0, 18.0);
        let margins = self.panels.iter().zip(&axes).map(|(panel, axis)| left_margin(axis, panel.height));
        let left = margins.fold(0.0, f64::max);
        let total_width = left + width + 24.0;
        let top = 48.0 + key_rows(width, &entries) * KEY_ROW;
        let heights: f64 = self.panels.iter().map(|panel| panel.height + gap).sum();
        picture((total_width, top + heights - gap + 52.0), |canvas| {
            title(canvas, &self.title, left, total_width)?;
            key(canvas, (left, 46.0), left + width, &entries)?;
            let mut at = top;
            for (number, (panel, y_axis)) in self.panels.iter().zip(&axes).enumerate() {
                let height = panel.height;
                let frame = Frame { canvas, left, top: at, width, height, x: &x_axis, y: y_axis };
                self.panel(&frame, panel)?;
                frame.edges(number + 1 == self.panels.len(), true)?;
                at += height + gap;
            }
            Ok(())
        })
    }

    fn panel(&self, frame: &Frame, panel: &Plot) -> Result<(), ReportError> {
        frame.grid()?;
        let zero = frame.y.place(0.0);
        if (0.0..=1.0).contains(&zero) {
            let y = frame.top + (1.0 - zero) * frame.height;
            frame.canvas.line(&[(frame.left, y), (frame.left + frame.width, y)], INK, 0.8)?;
        }
        for (number, (line, look)) in panel.lines.iter().zip(&self.series).enumerate() {
            let shade = LINES[number % LINES.len()];
            let places: Vec<(f64, f64)> = line.iter().map(|&(x, y)| frame.at(x, y)).collect();
            for piece in places.split(|at| !(at.0.is_finite() && at.1.is_finite())) {
                match look.dashed {
                    true => frame.canvas.dashes(piece, shade, look.width)?,
                    false => frame.canvas.line(piece, shade, look.width)?,
                }
                if look.dots {
                    piece.iter().try_for_each(|at| frame.canvas.dot(*at, 1.2 + look.width, shade))?;
                }
            }
        }
        panel.marks.iter().try_for_each(|mark| mark.draw(frame.canvas, frame.at(mark.x, mark.y)))
    }
}

impl Plot {
    fn axis(&self) -> PlotAxis {
        let values = self.lines.iter().flatten().map(|point| point.1);
        PlotAxis::over(values.clone(), &self.units, &self.label, spans_decades(values), 0.06)
    }
}

impl Mark {
    fn draw(&self, canvas: &Canvas, at: (f64, f64)) -> Result<(), ReportError> {
        if !(at.0.is_finite() && at.1.is_finite()) {
            return Ok(());
        }
        canvas.dot(at, 4.4, WHITE)?;
        canvas.dot(at, 3.2, INK)?;
        let anchor = if self.offset.0 < 0.0 { Anchor::Right } else { Anchor::Left };
        let place = (at.0 + self.offset.0, at.1 - self.offset.1);
        canvas.line(&[at, place], INK, 0.7)?;
        canvas.text(&self.text, (place.0 + self.offset.0.signum() * 3.0, place.1), SMALL, anchor, INK)
    }
}

//! Values over two axes as coloured cells, alone or as panels over slices of further axes.

use super::axis::{PlotAxis, least_of_decades, spans_decades};
use super::canvas::{Anchor, BACK, Canvas, INK, PALE, WHITE, picture};
use super::contour;
use super::frame::{
    Frame, KEY_ROW, LABEL, Legend, SMALL, State, Tally, colour, key, key_rows, left_margin, title, upward,
};
use super::heat_cells::{CellField, HeatCells, MARKED, MOST_CELLS, NONE, RASTER};
use super::hover::Hover;
use crate::store::Coordinate;

/// One field: a row of values for each value of the y axis.
#[derive(Debug, Default)]
pub struct Panel {
    pub caption: String,
    /// The x axis runs fastest.
    pub values: Vec<(f64, State)>,
    /// The branch of each value by its code, 0 where it is on none: no line of equal value leads from one branch to
    /// another. Empty where nothing is known of branches.
    pub branches: Vec<u8>,
    /// Lines over the cells, in SI units of the axes: the `i`-th goes by the `i`-th name of
    /// [`Heatmap::lines`]. What lies outside the axes is left out.
    pub lines: Vec<Vec<(f64, f64)>>,
}

/// Panels in rows of `columns`, on common axes and one colour scale.
pub struct Heatmap<'a> {
    pub title: String,
    /// SI unit of the values, as the results file writes it.
    pub units: &'a str,
    /// What the values are, for the colour bar.
    pub long_name: &'a str,
    pub x: &'a Coordinate,
    pub y: &'a Coordinate,
    pub columns: usize,
    pub panels: Vec<Panel>,
    /// Names of the lines over the cells: the first is drawn through, the others dashed.
    pub lines: Vec<String>,
}

impl Heatmap<'_> {
    /// The picture as SVG.
    pub fn draw(&self) -> String {
        let values = || self.values();
        self.over(spans_decades(values()), values(), false).0
    }

    /// The picture with lines at round values, and what lies where in it.
    pub(super) fn draw_told(&self) -> (String, Hover) {
        let least = least_of_decades(self.values());
        self.over(
            least.is_some(),
            self.values().filter(|value| least.is_none_or(|least| *value >= least)),
            true,
        )
    }

    fn values(&self) -> impl Iterator<Item = f64> + Clone {
        let all = self.panels.iter().flat_map(|panel| &panel.values);
        all.filter(|(_, state)| state.has_value()).map(|(value, _)| *value)
    }

    /// Over a bar of these values, with contours or without.
    fn over(&self, log: bool, values: impl Iterator<Item = f64> + Clone, contours: bool) -> (String, Hover) {
        let mut hover = Hover::default();
        let (across, up) = (HeatCells::along(self.x), HeatCells::along(self.y));
        let states = self.panels.iter().flat_map(|panel| &panel.values).map(|(_, state)| *state);
        let bar = PlotAxis::over(values, self.units, self.long_name, log, 0.0);
        let columns = self.columns.clamp(1, self.panels.len().max(1));
        let rows = self.panels.len().div_ceil(columns);
        let single = self.panels.len() == 1;
        let (width, height) = match (single, columns) {
            (true, _) => (520.0, 400.0),
            (_, 1..=2) => (300.0, 240.0),
            _ => (230.0, 200.0),
        };
        let captions = if single { 0.0 } else { 20.0 };
        let (left, top, gap) = (left_margin(&up.axis, height), 40.0, 28.0);
        let field = (columns as f64 * (width + gap) - gap, rows as f64 * (height + captions + gap) - gap);
        let bar_left = left + field.0 + 22.0;
        let bar_labels = left_margin(&bar, field.1);
        let total_width = bar_left + 18.0 + bar_labels + 6.0;
        let per_panel = across.members.len() * up.members.len();
        let entries = self.entries(states, per_panel);
        let raster = per_panel * self.panels.len() > RASTER;
        let key_top = top + field.1 + 64.0;
        let total = (total_width, key_top + key_rows(total_width - left, &entries) * KEY_ROW);
        let svg = picture(total, |canvas| {
            title(canvas, &self.title, left, total_width);
            for (number, panel) in self.panels.iter().enumerate() {
                let (row, column) = (number / columns, number % columns);
                let frame = Frame {
                    canvas,
                    left: left + column as f64 * (width + gap),
                    top: top + row as f64 * (height + captions + gap) + captions,
                    width,
                    height,
                    x: &across.axis,
                    y: &up.axis,
                };
                let caption_at = (frame.left + width / 2.0, frame.top - 10.0);
                canvas.text(&panel.caption, caption_at, SMALL, Anchor::Middle, INK);
                let map = CellField { frame: &frame, across: &across, up: &up, bar: &bar };
                self.panel(&map, panel, (raster, contours), &mut hover);
                let lowest = number + columns >= self.panels.len();
                frame.ticks(lowest, column == 0);
                // One label for all columns, below the lowest row.
                if number + 1 == self.panels.len() {
                    frame.x_label(left + field.0 / 2.0);
                }
            }
            colour_bar(canvas, &bar, (bar_left, top + captions), field.1 - captions);
            key(canvas, (left, key_top), total_width, &entries)
        });
        (svg, hover)
    }

    /// The cells of a panel and the lines over them.
    fn panel(&self, map: &CellField, panel: &Panel, (raster, contours): (bool, bool), hover: &mut Hover) {
        let cells = map.merged(&panel.values, self.x.values.len());
        map.draw(&cells, raster);
        if contours {
            let branches = map.firsts(&panel.branches, self.x.values.len());
            contour::draw(map, &cells, &branches);
        }
        hover.cells(map.told(&cells, self.x, self.y));
        overlay(map.frame, &panel.lines)
    }

    fn entries(&self, states: impl Iterator<Item = State>, cells: usize) -> Vec<(Legend, String)> {
        let tally = Tally::of(states);
        let mut entries: Vec<(Legend, String)> = Vec::new();
        for (number, name) in self.lines.iter().enumerate() {
            let sample = if number == 0 { Legend::Line(INK) } else { Legend::Dashes(INK) };
            entries.push((sample, name.clone()));
        }
        let [marked, back] = [Legend::Marked(colour(0.4)), Legend::Swatch(BACK)];
        let samples = [marked, Legend::Swatch(NONE), Legend::Swatch(PALE), Legend::Hatched, back];
        for (sample, mut words) in tally.entries(samples) {
            if matches!(sample, Legend::Marked(_)) && cells > MARKED {
                words += ", not marked";
            }
            entries.push((sample, words));
        }
        if self.x.values.len().max(self.y.values.len()) > MOST_CELLS {
            let text = "each cell is the mean of its neighbouring instances that have a value".to_owned();
            entries.push((Legend::Swatch(colour(0.6)), text));
        }
        entries
    }
}

/// Lines over the cells: dark on a light border, to be seen on any colour.
fn overlay(frame: &Frame, lines: &[Vec<(f64, f64)>]) {
    for (number, line) in lines.iter().enumerate() {
        let places: Vec<(f64, f64)> = line.iter().map(|&(x, y)| frame.at(x, y)).collect();
        for piece in places.split(|&at| !frame.holds(at)) {
            frame.canvas.line(piece, WHITE, 3.6);
            frame.canvas.stroke(piece, (INK, 1.6), number > 0);
        }
    }
}

fn colour_bar(canvas: &Canvas, bar: &PlotAxis, (left, top): (f64, f64), height: f64) {
    const STEPS: usize = 100;
    let (width, bottom) = (18.0, top + height);
    for step in 0..STEPS {
        let from = bottom - height * step as f64 / STEPS as f64;
        let to = bottom - height * (step + 1) as f64 / STEPS as f64;
        let shade = colour((step as f64 + 0.5) / STEPS as f64);
        canvas.rectangle((left, from), (left + width, (to - 1.0).max(top)), shade);
    }
    canvas.outline((left, top), (left + width, bottom));
    let (ticks, small) = bar.ticks((height / 45.0) as usize + 1);
    for (place, text) in &ticks {
        let y = bottom - place * height;
        canvas.line(&[(left + width, y), (left + width + 5.0, y)], INK, 1.0);
        canvas.text(text, (left + width + 8.0, y), SMALL, Anchor::Left, INK);
    }
    for place in small {
        let y = bottom - place * height;
        canvas.line(&[(left + width, y), (left + width + 3.0, y)], INK, 0.8);
    }
    let x = left + width + left_margin(bar, height) - LABEL * 0.6;
    upward(canvas, bar, (x, top + height / 2.0), height)
}

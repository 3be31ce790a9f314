//! The cells of a map: which values they show, and how they are drawn.

use super::axis::PlotAxis;
use super::canvas::{BACK, Canvas, GREY, PALE, Rgb};
use super::frame::{BEYOND, Frame, NOTHING, State, colour, mark, status_word};
use super::hover;
use super::labels::{short, shown};
use super::raster::{self, CLEAR, FINER, Pixel, solid};
use crate::store::Coordinate;

/// The colour of a value that is nothing within its error.
pub(super) const NONE: Rgb = Rgb(176, 176, 176);
/// Cells along an axis at most; finer grids are averaged.
pub(super) const MOST_CELLS: usize = 512;
/// Over [`PALE`], what [`BACK`] is on a light and on a dark page.
const VEIL: Pixel = [144, 144, 144, 79];
/// More cells than this in a picture are drawn as images.
pub(super) const RASTER: usize = 2000;
/// Doubtful cells of panels with at most so many are marked.
pub(super) const MARKED: usize = 2500;

/// The cells along one axis: where they end and which values they show.
pub(super) struct HeatCells {
    pub axis: PlotAxis,
    /// Ends on the axis' scale, one more than there are cells.
    pub edges: Vec<f64>,
    /// Numbers of the values that each cell shows.
    pub members: Vec<Vec<usize>>,
}

impl HeatCells {
    pub fn along(coordinate: &Coordinate) -> Self {
        let values = &coordinate.values;
        let mut order: Vec<usize> = (0..values.len()).collect();
        order.sort_by(|&a, &b| values[a].total_cmp(&values[b]));
        let usable = values.iter().all(|value| value.is_finite())
            && order.windows(2).all(|pair| values[pair[0]] < values[pair[1]]);
        // Values that occur twice or are not finite have no place of their own; their number has.
        let (axis, places) = if usable {
            let axis = PlotAxis::of(coordinate, 0.0);
            let places: Vec<f64> = order.iter().map(|&i| axis.scaled(values[i])).collect();
            (axis, places)
        } else {
            order.sort_unstable();
            let places: Vec<f64> = (0..values.len()).map(|i| i as f64).collect();
            let label = format!("{}, number of the value", short(coordinate));
            (PlotAxis::over(places.iter().copied(), "1", &label, false, 0.0), places)
        };
        let mut edges: Vec<f64> = places.windows(2).map(|pair| (pair[0] + pair[1]) / 2.0).collect();
        let (first, last) = match places.as_slice() {
            [] => (0.0, 1.0),
            [only] => (only - 0.5 * only.abs().max(1e-3), only + 0.5 * only.abs().max(1e-3)),
            [a, b] => (a - (b - a) / 2.0, b + (b - a) / 2.0),
            [a, b, .., y, z] => (a - (b - a) / 2.0, z + (z - y) / 2.0),
            [a, b, c] => (a - (b - a) / 2.0, c + (c - b) / 2.0),
        };
        edges.insert(0, first);
        edges.push(last);
        let block = values.len().div_ceil(MOST_CELLS).max(1);
        let members: Vec<Vec<usize>> = order.chunks(block).map(<[usize]>::to_vec).collect();
        let mut ends: Vec<f64> = (0..members.len()).map(|i| edges[i * block]).collect();
        ends.push(last);
        Self { axis: axis.between(first, last), edges: ends, members }
    }
}

/// One panel's cells on their frame.
pub(super) struct CellField<'a> {
    pub frame: &'a Frame<'a>,
    pub across: &'a HeatCells,
    pub up: &'a HeatCells,
    pub bar: &'a PlotAxis,
}

impl CellField<'_> {
    /// What each cell shows, the lowest row first, of values in rows of this width.
    pub fn merged(&self, values: &[(f64, State)], width: usize) -> Vec<(f64, State)> {
        self.of_each(width, |members| merge(members.filter_map(|i| values.get(i))))
    }

    /// The code of the first value that each cell shows, likewise; 0 where there is none.
    pub fn firsts(&self, codes: &[u8], width: usize) -> Vec<u8> {
        self.of_each(width, |members| members.next().and_then(|i| codes.get(i)).copied().unwrap_or(0))
    }

    /// What `of` makes of the numbers of the values that each cell shows.
    fn of_each<T>(&self, width: usize, of: impl Fn(&mut dyn Iterator<Item = usize>) -> T) -> Vec<T> {
        let cell = |ys: &Vec<usize>, xs: &Vec<usize>| {
            of(&mut ys.iter().flat_map(|&y| xs.iter().map(move |&x| y * width + x)))
        };
        self.up.members.iter().flat_map(|ys| self.across.members.iter().map(|xs| cell(ys, xs))).collect()
    }

    /// Pixels of the middles of the columns, and of the rows from below.
    pub fn centres(&self) -> (Vec<f64>, Vec<f64>) {
        let middle = |pair: &[f64], at: &dyn Fn(f64) -> f64| (at(pair[0]) + at(pair[1])) / 2.0;
        let columns = self.across.edges.windows(2).map(|pair| middle(pair, &|edge| self.x_at(edge)));
        let rows = self.up.edges.windows(2).map(|pair| middle(pair, &|edge| self.y_at(edge)));
        (columns.collect(), rows.collect())
    }

    fn x_at(&self, edge: f64) -> f64 {
        self.frame.left + self.frame.x.place_scaled(edge) * self.frame.width
    }

    fn y_at(&self, edge: f64) -> f64 {
        self.frame.top + (1.0 - self.frame.y.place_scaled(edge)) * self.frame.height
    }

    /// Draws them, as an image where asked for, and marks what is doubtful.
    pub fn draw(&self, cells: &[(f64, State)], raster: bool) {
        if raster {
            self.image(cells)
        } else {
            self.shapes(cells)
        }
        if cells.len() > MARKED {
            return;
        }
        let (columns, rows) = self.centres();
        for (number, _) in cells.iter().enumerate().filter(|(_, cell)| matches!(cell.1, State::Doubtful(_))) {
            mark(self.frame.canvas, (columns[number % columns.len()], rows[number / columns.len()]));
        }
    }

    /// The colour of a cell, except of one that failed.
    fn shade(&self, (value, state): (f64, State)) -> Option<Rgb> {
        match state {
            State::Failed(_) => None,
            State::Empty => Some(PALE),
            State::Zero => Some(NONE),
            State::Good | State::Doubtful(_) => Some(colour(self.bar.place(value))),
            State::Excluded => Some(BACK),
        }
    }

    /// Rectangles: neighbours of one colour are one.
    fn shapes(&self, cells: &[(f64, State)]) {
        let canvas = self.frame.canvas;
        let end = (self.frame.left + self.frame.width, self.frame.top);
        for (row, cells) in cells.chunks(self.across.members.len().max(1)).enumerate() {
            let mut run = None;
            let (bottom, top) = (self.y_at(self.up.edges[row]), self.y_at(self.up.edges[row + 1]));
            for (column, cell) in cells.iter().enumerate() {
                let left = self.x_at(self.across.edges[column]);
                let right = self.x_at(self.across.edges[column + 1]);
                // Over a pixel of the neighbours drawn next, or the background shows through the seams.
                let (a, b) = ((left, bottom), ((right + 1.0).min(end.0), (top - 1.0).max(end.1)));
                match (self.shade(*cell), &mut run) {
                    (Some(shade), Some((_, end, same))) if shade == *same => *end = b,
                    (shade, _) => {
                        fill(canvas, run.take());
                        match shade {
                            Some(shade) => run = Some((a, b, shade)),
                            None => canvas.hatched(a, b),
                        }
                    }
                }
            }
            fill(canvas, run);
        }
    }

    /// One image of all cells; what failed is striped in it. What has no value is clear: the ground behind it follows the
    /// page's colours.
    fn image(&self, cells: &[(f64, State)]) {
        let Frame { canvas, left, top, width, height, .. } = *self.frame;
        let (wide, high) = ((width * FINER) as usize, (height * FINER) as usize);
        let right: Vec<f64> = self.across.edges[1..].iter().map(|edge| self.x_at(*edge)).collect();
        let upper: Vec<f64> = self.up.edges[1..].iter().map(|edge| self.y_at(*edge)).collect();
        let columns = right.len();
        let column_of: Vec<usize> = (0..wide)
            .map(|i| right.partition_point(|end| *end <= left + (i as f64 + 0.5) / FINER).min(columns - 1))
            .collect();
        let mut colours = Vec::with_capacity(wide * high);
        for j in 0..high {
            let y = top + (j as f64 + 0.5) / FINER;
            let row = upper.partition_point(|end| *end > y).min(upper.len() - 1);
            for (i, column) in column_of.iter().enumerate() {
                colours.push(match self.shade(cells[row * columns + column]) {
                    None if (i + j) % 12 < 2 => solid(GREY),
                    None | Some(PALE) => CLEAR,
                    Some(BACK) => VEIL,
                    Some(shade) => solid(shade),
                });
            }
        }
        canvas.rectangle((left, top), (left + width, top + height), PALE);
        canvas.image((left, top), (left + width, top + height), &raster::image(wide, high, &colours));
    }

    /// What the cells stand for, for the pointer.
    pub fn told(&self, cells: &[(f64, State)], x: &Coordinate, y: &Coordinate) -> hover::HoverCells {
        let middle = |axis: &Coordinate, members: &[usize]| {
            members.get(members.len() / 2).map_or(String::new(), |i| shown(axis, axis.values[*i]))
        };
        let names = |axis: &Coordinate, cells: &HeatCells| -> Vec<String> {
            cells.members.iter().map(|members| middle(axis, members)).collect()
        };
        let value = |(value, state): &(f64, State)| match state {
            State::Good => self.bar.unit.value(*value),
            State::Doubtful(code) => {
                format!("{} ({})", self.bar.unit.value(*value), status_word(*code))
            }
            State::Excluded => format!("{} ({BEYOND})", self.bar.unit.value(*value)),
            State::Zero => NOTHING.to_owned(),
            State::Empty => "no value".to_owned(),
            State::Failed(code) => status_word(*code),
        };
        hover::HoverCells {
            corner: (self.frame.left, self.frame.top),
            right: self.across.edges[1..].iter().map(|edge| self.x_at(*edge)).collect(),
            top: self.up.edges[1..].iter().map(|edge| self.y_at(*edge)).collect(),
            bottom: self.frame.top + self.frame.height,
            x: names(x, self.across),
            y: names(y, self.up),
            values: cells.iter().map(value).collect(),
        }
    }
}

/// Corners and colour of cells to be drawn as one.
type Run = ((f64, f64), (f64, f64), Rgb);

fn fill(canvas: &Canvas, run: Option<Run>) {
    if let Some((a, b, shade)) = run {
        canvas.rectangle(a, b, shade);
    }
}

/// The mean of a cell's values, and what most of its instances are.
fn merge<'a>(cell: impl Iterator<Item = &'a (f64, State)>) -> (f64, State) {
    // Counts and sums of what has a value, is outside the limits, nothing, without a value, failed.
    let mut counts = [0usize; 5];
    let mut sums = [0.0; 5];
    let (mut doubtful, mut doubt, mut failure) = (0, State::Good, State::Empty);
    for (value, state) in cell {
        let kind = match state {
            State::Good => 0,
            State::Doubtful(_) => {
                (doubtful, doubt) = (doubtful + 1, *state);
                0
            }
            State::Excluded => 1,
            State::Zero => 2,
            State::Empty => 3,
            State::Failed(_) => {
                failure = *state;
                4
            }
        };
        counts[kind] += 1;
        sums[kind] += value;
    }
    let [valued, excluded, zero, empty, failed] = counts;
    let mean = |kind: usize| sums[kind] / counts[kind].max(1) as f64;
    match () {
        () if excluded > valued && excluded >= empty + failed => (mean(1), State::Excluded),
        () if zero > valued && zero >= empty + failed => (0.0, State::Zero),
        () if valued == 0 || valued < empty + failed => {
            (f64::NAN, if failed >= empty { failure } else { State::Empty })
        }
        () if 2 * doubtful > valued => (mean(0), doubt),
        () => (mean(0), State::Good),
    }
}

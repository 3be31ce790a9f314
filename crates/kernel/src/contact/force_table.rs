//! Forces that are given by numbers: piecewise cubics, which all lanes and the shader read from the same rows.
//!
//! A process holds each different table once, under a number that a law has among its constants.

use std::sync::{Mutex, OnceLock, PoisonError};

/// Rows of a table; those beyond its knots are never met.
pub const ROWS: usize = 1024;
/// Most knots: one row stands for all that lies before the first.
pub const KNOTS: usize = ROWS - 1;
/// Numbers of a row: its place and the next, the four coefficients of its cubic, the sums of work and of moment up to there,
/// and the force and these two at its end.
pub const COLUMNS: usize = 11;
/// The columns of the two sums at a row's begin; those at its end are three behind.
const WORK: usize = 6;
const MOMENT: usize = 7;
/// Most instances that a lane holds.
pub const MOST_WIDTH: usize = 32;
/// Most different tables of a process.
pub const TABLES: usize = 4096;
/// The tables that the program makes itself: of e^x and of 1/(1 - x) outside contact, where x is at most 0; 1 inside.
pub const EXPONENTIAL: usize = 0;
pub const INVERSE: usize = 1;

/// Beyond any knot, within f32.
const FAR: f64 = crate::constants::FAR;

static BANK: [OnceLock<ForceTable>; TABLES] = [const { OnceLock::new() }; TABLES];

/// A point of a table: where, the force there, and its slope on both sides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Knot {
    pub at: f64,
    pub force: f64,
    pub slope_before: f64,
    pub slope_after: f64,
}

impl Knot {
    /// A point at which the slope is the same on both sides.
    pub fn smooth(at: f64, force: f64, slope: f64) -> Self {
        Self { at, force, slope_before: slope, slope_after: slope }
    }
}

/// A force over the indentation, in units of its own: cubic between knots, constant before the first, straight after the last.
#[derive(Clone, Debug, PartialEq)]
pub struct ForceTable {
    rows: Vec<[f64; COLUMNS]>,
    /// Where the rows begin, once more: a search reads these alone.
    places: Vec<f64>,
    /// The same rounded to f32.
    narrow: Vec<f64>,
    knots: usize,
}

impl ForceTable {
    /// Through these knots, which rise; at least one, at most [`KNOTS`].
    fn new(knots: &[Knot]) -> Self {
        let mut rows = vec![[FAR; COLUMNS]; ROWS];
        let (first, last) = (knots[0], knots[knots.len() - 1]);
        rows[0] = [-FAR, first.at, first.force, 0.0, 0.0, 0.0, 0.0, 0.0, first.force, 0.0, 0.0];
        // Integrals of the force and of its product with the indentation, at first from the first knot on.
        let (mut work, mut moment) = (0.0, 0.0);
        for (row, pair) in rows[1..].iter_mut().zip(knots.windows(2)) {
            let (knot, next) = (pair[0], pair[1]);
            let width = next.at - knot.at;
            let (rise, before) = (next.force - knot.force, (knot.slope_after, next.slope_before));
            let square = (3.0 * rise / width - 2.0 * before.0 - before.1) / width;
            let cube = (before.0 + before.1 - 2.0 * rise / width) / (width * width);
            let power = |n: i32| width.powi(n);
            let area = knot.force * width
                + before.0 * power(2) / 2.0
                + square * power(3) / 3.0
                + cube * power(4) / 4.0;
            let turn = knot.force * power(2) / 2.0
                + before.0 * power(3) / 3.0
                + square * power(4) / 4.0
                + cube * power(5) / 5.0;
            let (next_work, next_moment) = (work + area, moment + knot.at * area + turn);
            *row = [
                knot.at,
                next.at,
                knot.force,
                before.0,
                square,
                cube,
                work,
                moment,
                next.force,
                next_work,
                next_moment,
            ];
            (work, moment) = (next_work, next_moment);
        }
        rows[knots.len()] =
            [last.at, FAR, last.force, last.slope_after, 0.0, 0.0, work, moment, last.force, work, moment];
        // Where forces are large, near touch, f32 needs small sums.
        let touch = knots.partition_point(|knot| knot.at <= 0.0).max(1);
        let (work, moment) = (rows[touch][WORK], rows[touch][MOMENT]);
        for row in &mut rows[..=knots.len()] {
            for (column, sum) in [(WORK, work), (WORK + 3, work), (MOMENT, moment), (MOMENT + 3, moment)] {
                row[column] -= sum;
            }
        }
        let places: Vec<f64> = rows.iter().map(|row| row[0]).collect();
        let narrow = places.iter().map(|place| f64::from(*place as f32)).collect();
        Self { rows, places, narrow, knots: knots.len() }
    }

    /// The number of the table through these knots, which must rise: at least one, at most [`KNOTS`]. None where a process has
    /// no room for one more.
    pub fn number(knots: &[Knot]) -> Option<usize> {
        static ADDING: Mutex<()> = Mutex::new(());
        let table = Self::new(knots);
        let _adding = ADDING.lock().unwrap_or_else(PoisonError::into_inner);
        for (number, place) in BANK.iter().enumerate().skip(INVERSE + 1) {
            match place.get() {
                Some(known) if *known == table => return Some(number),
                Some(_) => {}
                None => return place.set(table).ok().map(|()| number),
            }
        }
        None
    }

    /// The table of that number; the exponential one where there is none.
    pub fn numbered(number: usize) -> &'static Self {
        match BANK.get(number).and_then(OnceLock::get) {
            Some(table) => table,
            None if number == INVERSE => BANK[INVERSE].get_or_init(|| Self::new(&inverse())),
            None => BANK[EXPONENTIAL].get_or_init(|| Self::new(&exponential())),
        }
    }

    /// All rows, as a shader reads them.
    pub fn rows(&self) -> &[[f64; COLUMNS]] {
        &self.rows
    }

    /// Where its first and its last knot are.
    pub fn ends(&self) -> (f64, f64) {
        (self.rows[1][0], self.rows[self.knots][0])
    }

    /// The numbers of the rows that hold each of `x`, side by side. As shaders/table.wgsl does it.
    #[inline]
    fn find(&self, x: &[f64], narrow: bool, rows: &mut [usize]) {
        let places: &[f64] = if narrow { &self.narrow } else { &self.places };
        let mut step = ROWS / 2;
        while step > 0 {
            for (row, x) in rows.iter_mut().zip(x) {
                *row += step * usize::from(*x >= places[*row + step]);
            }
            step /= 2;
        }
    }

    /// Force, slope, and the force's integral from the first knot on, at `x`.
    pub fn at(&self, x: f64) -> [f64; 3] {
        let [at, _, force, rise, square, cube, work, ..] = {
            let mut row = [0];
            self.find(&[x], false, &mut row);
            self.rows[row[0]]
        };
        if at == -FAR {
            return [force, 0.0, force * (x - self.rows[1][0])];
        }
        let d = x - at;
        [
            force + d * (rise + d * (square + d * cube)),
            rise + d * (2.0 * square + 3.0 * cube * d),
            work - self.rows[1][WORK] + d * (force + d * (rise / 2.0 + d * (square / 3.0 + d * cube / 4.0))),
        ]
    }
}

/// Puts the row of each `x` in the table of its number into columns; `element` rounds to the lane's precision.
#[inline(never)]
pub fn fill<E: Copy + Into<f64>>(
    (x, number): (&[E], &[E]),
    element: fn(f64) -> E,
    columns: &mut [[E; MOST_WIDTH]; COLUMNS],
) {
    let narrow = size_of::<E>() < size_of::<f64>();
    let (mut places, mut rows) = ([0.0; MOST_WIDTH], [0; MOST_WIDTH]);
    let count = x.len();
    for (place, x) in places.iter_mut().zip(x) {
        *place = (*x).into();
    }
    let table_of = |number: &E| ForceTable::numbered((*number).into() as usize);
    let first: f64 = number[0].into();
    if number.iter().all(|other| (*other).into() == first) {
        table_of(&number[0]).find(&places[..count], narrow, &mut rows[..count]);
    } else {
        for (n, number) in number.iter().enumerate() {
            table_of(number).find(&places[n..=n], narrow, &mut rows[n..=n]);
        }
    }
    for (lane, number) in number.iter().enumerate() {
        let row = &table_of(number).rows[rows[lane]];
        for (column, value) in columns.iter_mut().zip(row) {
            column[lane] = element(*value);
        }
    }
}

/// Knots so dense that the cubic is right to 1e-8 of the force at contact, from far away to contact at 0.
fn outside(places: impl Iterator<Item = f64>, force: impl Fn(f64) -> (f64, f64)) -> Vec<Knot> {
    let knot = |at| {
        let (force, slope) = force(at);
        Knot::smooth(at, force, slope)
    };
    let mut knots: Vec<Knot> = places.map(knot).collect();
    if let [first, .., last] = &mut knots[..] {
        (first.slope_before, last.slope_after) = (0.0, 0.0);
    }
    knots
}

/// As many places as a table can have, from -20 to 0: the fourth power of their distance falls off as e^x.
pub fn decaying_places() -> impl Iterator<Item = f64> {
    let all = (KNOTS - 1) as f64;
    (0..KNOTS).map(move |n| {
        let share = (1.0 - n as f64 / all) * (1.0 - (-5f64).exp());
        4.0 * (1.0 - share).ln()
    })
}

/// The knots of a force that falls off outside contact and keeps its value inside: force and slope at x, at most 0.
pub fn decaying(force: impl Fn(f64) -> (f64, f64)) -> Vec<Knot> {
    outside(decaying_places(), force)
}

fn exponential() -> Vec<Knot> {
    decaying(|x| (x.exp(), x.exp()))
}

fn inverse() -> Vec<Knot> {
    let all = (KNOTS - 1) as f64;
    let places = (0..KNOTS).map(|n| 1.0 - (1e6f64.ln() * (1.0 - n as f64 / all)).exp());
    outside(places, |x| (1.0 / (1.0 - x), (1.0 - x).powi(-2)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: the functions themselves and their antiderivatives.
    #[test]
    fn the_programs_tables_are_their_functions() {
        for x in [-19.0, -7.3, -1.0, -0.31, -0.01, -1e-6] {
            let [force, slope, work] = ForceTable::numbered(EXPONENTIAL).at(x);
            assert!((force - f64::exp(x)).abs() < 1e-11, "{x}: {force}");
            assert!((slope - f64::exp(x)).abs() < 1e-8, "{x}: {slope}");
            assert!((work - f64::exp(x) + f64::exp(-20.0)).abs() < 1e-11, "{x}: {work}");
        }
        for x in [-1e5, -300.0, -7.3, -1.0, -0.31, -0.01, -1e-6] {
            let [force, slope, work] = ForceTable::numbered(INVERSE).at(x);
            assert!((force * (1.0 - x) - 1.0).abs() < 1e-8, "{x}: {force}");
            assert!((slope * (1.0 - x).powi(2) - 1.0).abs() < 1e-4, "{x}: {slope}");
            assert!((work - (1e6f64 / (1.0 - x)).ln()).abs() < 1e-7, "{x}: {work}");
        }
        for number in [EXPONENTIAL, INVERSE] {
            assert_eq!(ForceTable::numbered(number).at(0.7)[..2], [1.0, 0.0]);
        }
    }

    /// Truth: a cubic is its own interpolant; a table is known by its knots, and goes straight on behind the last.
    #[test]
    fn a_table_is_kept_once_and_holds_cubics() {
        let cubic = |x: f64| (x * x * x - 2.0 * x + 0.5, 3.0 * x * x - 2.0);
        let knots = [-2.0, -0.5, 0.25, 1.0].map(|x| Knot::smooth(x, cubic(x).0, cubic(x).1));
        let number = ForceTable::number(&knots).unwrap();
        assert_eq!(ForceTable::number(&knots), Some(number));
        assert_ne!(ForceTable::number(&knots[1..]), Some(number));
        let table = ForceTable::numbered(number);
        let area = |x: f64| x.powi(4) / 4.0 - x * x + 0.5 * x;
        for x in [-2.0, -1.3, 0.0, 0.9, 1.0] {
            let [force, slope, work] = table.at(x);
            assert!((force - cubic(x).0).abs() < 1e-13 && (slope - cubic(x).1).abs() < 1e-13, "{x}");
            assert!((work - area(x) + area(-2.0)).abs() < 1e-13, "{x}");
        }
        assert_eq!(table.ends(), (-2.0, 1.0));
        assert_eq!(table.at(2.0)[0], cubic(1.0).0 + cubic(1.0).1);
        assert_eq!(table.at(-5.0)[..2], [cubic(-2.0).0, 0.0]);
    }
}

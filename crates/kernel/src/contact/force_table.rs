//! Forces that are given by numbers: piecewise cubics, which all lanes and the shader read from the same rows.
//!
//! A process holds each different table once, under a number that a law has among its constants.

use std::collections::BTreeMap;
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
    /// Where the rows begin, and the same rounded to f32.
    wide: Places,
    narrow: Places,
    knots: usize,
}

/// Where the rows of a table begin, and a guide to them: a number's bits without their last say between which rows it lies.
#[derive(Clone, Debug, PartialEq)]
struct Places {
    places: Vec<f64>,
    /// The bits of the place nearest to zero, and of the farthest; how many of their last bits the guide leaves out.
    nearest: u64,
    farthest: u64,
    shift: u32,
    /// How many rows begin in cells before each cell.
    begun: Vec<u16>,
}

impl Places {
    /// Cells of the guide, at most, on each side of zero.
    const CELLS: u64 = 2048;

    fn new(places: Vec<f64>) -> Self {
        let sizes = places.iter().map(|place| place.abs()).filter(|size| *size > 0.0 && *size < FAR / 2.0);
        let (nearest, farthest) =
            sizes.fold((FAR / 2.0, 0.0), |(least, most): (f64, f64), size| (least.min(size), most.max(size)));
        let (nearest, farthest) = (nearest.min(farthest).to_bits(), farthest.to_bits());
        let mut shift = 0;
        while (farthest - nearest) >> shift >= Self::CELLS {
            shift += 1;
        }
        let mut guided = Self { places, nearest, farthest, shift, begun: Vec::new() };
        let cells = 2 + 2 * ((farthest - nearest) >> shift) as usize;
        guided.begun = vec![0; cells + 1];
        for place in &guided.places {
            let cell = guided.cell(*place);
            guided.begun[cell + 1] += 1;
        }
        for cell in 1..=cells {
            guided.begun[cell] += guided.begun[cell - 1];
        }
        guided
    }

    /// Larger numbers have no smaller cell.
    #[inline(always)]
    fn cell(&self, x: f64) -> usize {
        let size = (x.abs().to_bits().clamp(self.nearest, self.farthest) - self.nearest) >> self.shift;
        let most = (self.farthest - self.nearest) >> self.shift;
        (if x < 0.0 { most - size } else { most + 1 + size }) as usize
    }

    /// The last row that does not begin behind `x`: what shaders/table.wgsl finds.
    #[inline(always)]
    fn row(&self, x: f64) -> usize {
        let cell = self.cell(x);
        let mut row = usize::from(self.begun[cell]).saturating_sub(1);
        let mut more = usize::from(self.begun[cell + 1]).saturating_sub(1 + row);
        while more > 0 {
            let half = more.div_ceil(2);
            if x >= self.places[row + half] {
                row += half;
                more -= half;
            } else {
                more = half - 1;
            }
        }
        row
    }
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
        let wide = Places::new(rows.iter().map(|row| row[0]).collect());
        let narrow = Places::new(rows.iter().map(|row| f64::from(row[0] as f32)).collect());
        Self { rows, wide, narrow, knots: knots.len() }
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

    /// The number of the table with these parameters in a family of tables, as [`ForceTable::number`] gives it; only the first
    /// call makes its knots.
    pub fn member(
        family: &'static str,
        parameters: [f64; 2],
        knots: impl FnOnce() -> Vec<Knot>,
    ) -> Option<usize> {
        type Members = BTreeMap<(&'static str, [u64; 2]), Option<usize>>;
        static MEMBERS: Mutex<Members> = Mutex::new(BTreeMap::new());
        let mut members = MEMBERS.lock().unwrap_or_else(PoisonError::into_inner);
        let member = members.entry((family, parameters.map(f64::to_bits)));
        *member.or_insert_with(|| Self::number(&knots()))
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

    /// Force, slope, and the force's integral from the first knot on, at `x`.
    pub fn at(&self, x: f64) -> [f64; 3] {
        let [at, _, force, rise, square, cube, work, ..] = self.rows[self.wide.row(x)];
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

/// For each instance the row that holds its `x` in the table of its `number`, column by column; `element` rounds to the lane's
/// precision.
#[inline(never)]
pub fn columns<E: Copy + Into<f64>, const WIDTH: usize>(
    (x, number): (&[E; WIDTH], &[E; WIDTH]),
    element: fn(f64) -> E,
) -> [[E; WIDTH]; COLUMNS] {
    let narrow = size_of::<E>() < size_of::<f64>();
    let mut columns = [[x[0]; WIDTH]; COLUMNS];
    for lane in 0..WIDTH {
        let table = ForceTable::numbered(number[lane].into() as usize);
        let places = if narrow { &table.narrow } else { &table.wide };
        let row = &table.rows[places.row(x[lane].into())];
        for column in 0..COLUMNS {
            columns[column][lane] = element(row[column]);
        }
    }
    columns
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

/// As [`decaying`], of a force that falls off as a power of 1 - x.
pub fn falling(force: impl Fn(f64) -> (f64, f64)) -> Vec<Knot> {
    let all = (KNOTS - 1) as f64;
    let places = (0..KNOTS).map(|n| 1.0 - (1e6f64.ln() * (1.0 - n as f64 / all)).exp());
    outside(places, force)
}

fn inverse() -> Vec<Knot> {
    falling(|x| (1.0 / (1.0 - x), (1.0 - x).powi(-2)))
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

    /// Truth: each row in turn. Knots that are graded, even, crowded or single, and numbers at, between and beyond them.
    #[test]
    fn rows_are_those_that_a_look_at_each_finds() {
        let even: Vec<f64> = (0..500).map(|n| -3.0 + 0.01 * f64::from(n)).collect();
        let crowded: Vec<f64> = (0..900).map(|n| 5.0 + 1e-9 * f64::from(n)).chain([6.0]).collect();
        let graded = decaying_places().collect();
        for knots in
            [even, crowded, graded, vec![0.0], vec![-2.0], vec![0.0, 1e-12], vec![-1e20, 0.0, 1e-300]]
        {
            let all: Vec<Knot> = knots.iter().map(|at| Knot::smooth(*at, 1.0, 0.0)).collect();
            let table = ForceTable::new(&all);
            let between = knots.windows(2).map(|pair| 0.5 * (pair[0] + pair[1]));
            let beside = knots.iter().flat_map(|at| [at.next_down(), *at, at.next_up()]);
            let far = [-1e300, -1e3, -1.0, -0.0, 0.0, 1e-310, 1.0, 1e3, 1e300, f64::NEG_INFINITY];
            for x in between.chain(beside).chain(far) {
                for places in [&table.wide, &table.narrow] {
                    let truth = places.places.iter().rposition(|place| x >= *place).unwrap_or(0);
                    assert_eq!(places.row(x), truth, "{x:e}");
                }
            }
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

//! One step of Gragg's midpoint rule, extrapolated (Bulirsch-Stoer with fixed columns): order 12.
//!
//! No coefficient tables, so nothing to mistype; all sums run over increments, which keeps rounding low.

/// Substeps of the columns.
const SUBSTEPS: [usize; 6] = [2, 4, 6, 8, 10, 12];

/// Order of the error estimate, the next to last column.
pub const ESTIMATE_ORDER: i32 = 10;

/// Work space for one system size.
#[derive(Clone, Debug)]
pub struct Extrapolation {
    slope: Vec<f64>,
    first: Vec<f64>,
    old: Vec<f64>,
    new: Vec<f64>,
    place: Vec<f64>,
    table: [Vec<f64>; SUBSTEPS.len()],
    /// Right-hand sides evaluated so far.
    pub evaluations: u64,
}

impl Extrapolation {
    pub fn new(size: usize) -> Self {
        let zeros = || vec![0.0; size];
        Self {
            slope: zeros(),
            first: zeros(),
            old: zeros(),
            new: zeros(),
            place: zeros(),
            table: std::array::from_fn(|_| zeros()),
            evaluations: 0,
        }
    }

    /// Steps from `(t, y)` by `h` into `end`; `error` receives the estimated error of each component.
    pub fn step(
        &mut self,
        rhs: &mut impl FnMut(f64, &[f64], &mut [f64]),
        (t, y): (f64, &[f64]),
        h: f64,
        end: &mut [f64],
        error: &mut [f64],
    ) {
        rhs(t, y, &mut self.first);
        self.evaluations += 1;
        for (column, &n) in SUBSTEPS.iter().enumerate() {
            let sub = h / n as f64;
            self.old.fill(0.0);
            for (new, first) in self.new.iter_mut().zip(&self.first) {
                *new = sub * first;
            }
            for m in 1..n {
                for ((place, start), gone) in self.place.iter_mut().zip(y).zip(&self.new) {
                    *place = start + gone;
                }
                rhs(t + sub * m as f64, &self.place, &mut self.slope);
                for ((old, new), slope) in self.old.iter_mut().zip(&mut self.new).zip(&self.slope) {
                    let next = *old + 2.0 * sub * slope;
                    *old = *new;
                    *new = next;
                }
            }
            self.evaluations += n as u64 - 1;
            self.table[column].copy_from_slice(&self.new);
            // Neville in 1/n^2, in place: table[j] becomes the entry of this row.
            for j in (0..column).rev() {
                let ratio = n as f64 / SUBSTEPS[j] as f64;
                let factor = 1.0 / (ratio * ratio - 1.0);
                let (low, high) = self.table.split_at_mut(j + 1);
                for (low, high) in low[j].iter_mut().zip(&high[0]) {
                    *low = high + (high - *low) * factor;
                }
            }
        }
        // table[0] is the last row's best entry, table[1] the one before it
        for i in 0..y.len() {
            end[i] = y[i] + self.table[0][i];
            error[i] = self.table[0][i] - self.table[1][i];
        }
    }
}

/// Step at which `value`, positive at 0 and negative at `end`, passes through 0; the last call of
/// `value` is made at the step returned. Bisection sped up by the Illinois rule, to the last digits.
pub fn locate(end: f64, mut value: impl FnMut(f64) -> f64) -> f64 {
    let mut high = (end, value(end));
    let mut low = (0.0, value(0.0));
    if low.1 <= 0.0 {
        // the step starts on the event itself, by rounding
        low.1 = f64::MIN_POSITIVE;
    }
    let mut kept = 0;
    for round in 0..200 {
        let secant = high.0 - high.1 * (high.0 - low.0) / (high.1 - low.1);
        let inside = secant > low.0 && secant < high.0;
        let h = if inside && round % 8 != 7 { secant } else { 0.5 * (low.0 + high.0) };
        if high.0 - low.0 <= 4.0 * f64::EPSILON * end || h <= low.0 || h >= high.0 {
            break;
        }
        let here = value(h);
        if here == 0.0 {
            return h;
        }
        if here < 0.0 {
            high = (h, here);
            if kept == -1 {
                low.1 *= 0.5;
            }
            kept = -1;
        } else {
            low = (h, here);
            if kept == 1 {
                high.1 *= 0.5;
            }
            kept = 1;
        }
    }
    value(high.0);
    high.0
}

//! Exact flow of the damped modes over one step, and what a kick does to each.

/// One mode as the plan gives it: angular frequency (rad/s), damping ratio 1/(2Q), its share of the tip's response to an
/// impulse, c_k b_k / sum(c b), and the largest angle (rad) that it turns by in a step that follows it. A step in which it turns
/// further meets it by its mean.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlowMode {
    pub omega: f64,
    pub damping: f64,
    pub share: f64,
    pub fast_angle: f64,
}

/// Coefficients of M modes for one step length. A mode's state is its part of the tip's travel, x,
/// and u = (dx/dt)/omega, both in kernel units of length.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Flow<L, const M: usize> {
    /// Modes that are gone through: all M where they are few, else as many as any instance has; less the law's memory.
    pub count: usize,
    /// Step matrix minus one: x += m00 x + m01 u, u += -m01 x + m11 u. Increments, because a step
    /// matrix rounded to f32 drifts and its increments do not.
    pub m00: [L; M],
    pub m01: [L; M],
    pub m11: [L; M],
    /// Travel per step of a unit of u: omega h.
    pub rate: [L; M],
    /// Acceleration per step squared of a unit of x and of u.
    pub pull: [L; M],
    pub drag: [L; M],
    /// What the speed midway through a kick is too large by when it counts as work, by x and by u.
    pub work_x: [L; M],
    pub work_u: [L; M],
    /// What a unit of impulse changes x and u by, seen at the next sample.
    pub land_x: [L; M],
    pub land_u: [L; M],
    /// What a unit of a kick's shift of the tip changes x and u by, seen at the next sample.
    pub shift_x: [L; M],
    pub shift_u: [L; M],
    /// What the path that is read has beyond the stepped one, by a unit of impulse, all modes together.
    pub corner: L,
    /// Change of the speed that counts as work by half a unit of impulse, all modes together.
    pub kick_paid: L,
    /// Travel that counts for the virial beyond the stepped path's mean, by a unit of impulse, all modes together.
    pub mean_corner: L,
}

/// A lever's constants for one step length, in f64 and without lanes: made once for all instances that share both.
///
/// The kick's factor tan(y)/y (1 - y^2/6), y = omega h/2, is 1 + (omega h)^2/24 + ...: the
/// term that the path average asks for, in the form that makes an undamped mode's answer to a
/// steady force exact however stiff it is. Its x-part is the average's damping term
/// (docs/method.md); with g = omega/Q it leaves the travel too large by (g h)^2/24, which the
/// factor's last term takes back.
///
/// Work: with f the force at the sample, f'' its second derivative and v a mode's true speed,
/// an impulse is f + h^2 f''/24 and the speed midway through it (Euler-Maclaurin)
/// v + h^2 (g f/24 + f'/8). Over a period f f' sums to nothing and f'' v to f v'' with
/// v'' = f' - g v' - omega^2 v, v' = f - g v - omega^2 x: what is left too much in the speed is
/// h^2/24 (g omega^2 x + (g^2 - omega^2) v), in which f itself cancels. Without it the loss is
/// of second order and shows a law without loss as one that feeds the lever.
///
/// Fast modes, which turn by more than their `fast_angle` in a step, are met by their mean over it (Gautschi 1961;
/// Garcia-Archilla, Sanz-Serna & Skeel 1998). The impulse moves such a mode as a force that is steady over the step does, by
/// sinc(y), and the contact hears its mean, by sinc(y) again: its x and u are stored with that factor. It adds no speed and no
/// acceleration to the path. Its own answer to the impulse within the step is its mean travel over it, where a
/// slow mode of the same share has a 12th: the law's units take that in by [`own_answer`]. A steady force is answered exactly.
#[derive(Clone, Debug, PartialEq)]
pub struct Lever {
    /// Modes, those filled up included.
    pub modes: usize,
    /// What the motion depends on: m00, m01, m11, rate, pull, drag, land_x, land_u, shift_x, shift_u of each mode, field
    /// after field, and corner.
    pub motion: Vec<f64>,
    /// What makes work of it: work_x, work_u of each mode, kick_paid and mean_corner.
    pub energy: Vec<f64>,
}

/// Fields of [`Lever::motion`] that each mode has.
pub(crate) const MOTION: usize = 10;

/// The row of an instance's constants where those of its law begin: behind the motion with its corner, the free motion's
/// three numbers and the gap.
pub(crate) const fn law_row(modes: usize) -> usize {
    MOTION * modes + 5
}

/// The angle (rad) of modes that steps may meet by their means.
pub const FAST_ANGLE: f64 = 1.2;

impl FlowMode {
    /// Whether a step of this length (s) meets the mode by its mean.
    fn is_fast(&self, step: f64) -> bool {
        self.omega * step > self.fast_angle
    }

    /// The share of the mode's travel and rate that its numbers in a state have, at steps of this length (s): of a fast mode they
    /// are means over a step.
    pub fn stored_share(&self, step: f64) -> f64 {
        let half = 0.5 * self.omega * step;
        if self.is_fast(step) { half.sin() / half } else { 1.0 }
    }

    /// Mean travel over a step of this length (s) by a unit of impulse that is steady over the step, of a mode of unit share.
    fn answer(&self, step: f64) -> f64 {
        let angle = self.omega * step;
        (1.0 - angle.sin() / angle) / (angle * angle)
    }
}

/// The answer of all modes to an impulse within its step, over that of slow ones of the same inverse mass. The contact sees a
/// lever lighter by this factor: its impulses are those of the force times it.
pub fn own_answer(modes: &[FlowMode], step: f64) -> f64 {
    if !modes.iter().any(|mode| mode.is_fast(step)) {
        return 1.0;
    }
    let answer = |mode: &FlowMode| if mode.is_fast(step) { 12.0 * mode.answer(step) } else { 1.0 };
    modes.iter().map(|mode| mode.share * answer(mode)).sum()
}

/// Of these, the ones that say what a unit of impulse does: land_x and land_u.
pub const LANDS: std::ops::Range<usize> = 6..8;

impl Lever {
    /// Of modes and a step in seconds, filled up to `count` with modes that no impulse moves.
    pub fn new(modes: &[FlowMode], step: f64, count: usize) -> Self {
        let rows = Row::all(modes, step, count);
        let fields: [fn(&Row) -> f64; MOTION] = [
            |row| row.step[0],
            |row| row.step[1],
            |row| row.step[3],
            |row| row.rate(),
            |row| -row.rate() * row.angle,
            |row| -2.0 * row.damping * row.rate() * row.angle,
            |row| row.land()[0],
            |row| row.land()[1],
            |row| row.shift() * (1.0 + row.step[0]),
            |row| row.shift() * row.step[2],
        ];
        let means = || rows.iter().filter_map(|row| row.mean);
        let mean_corner: f64 = means().sum();
        let corner = match means().next() {
            None => 1.0 / 24.0,
            Some(_) => rows.iter().map(|row| row.shift() / 24.0).sum::<f64>() + mean_corner,
        };
        let motion = fields.iter().flat_map(|field| rows.iter().map(field)).chain([corner]).collect();
        let paid = rows.iter().map(Row::kick_paid).sum();
        let works = rows.iter().map(Row::work_x).chain(rows.iter().map(Row::work_u));
        let energy = works.chain([paid, mean_corner]).collect();
        Self { modes: rows.len(), motion, energy }
    }

    /// Makes a memory of the last mode: no force moves it and it moves no tip; each step it loses a share, `1 - exp(-decay)`.
    pub fn remembering(mut self, decay: f64) -> Self {
        let Some(last) = self.modes.checked_sub(1) else { return self };
        let fields = &mut self.motion[..MOTION * self.modes];
        fields.iter_mut().skip(last).step_by(self.modes).for_each(|number| *number = 0.0);
        for field in [0, 2] {
            self.motion[field * self.modes + last] = (-decay).exp_m1();
        }
        for field in 0..2 {
            self.energy[field * self.modes + last] = 0.0;
        }
        self
    }
}

/// One mode over one step.
struct Row {
    angle: f64,
    damping: f64,
    share: f64,
    factor: f64,
    /// Of a fast mode its mean travel over the step by a unit of impulse.
    mean: Option<f64>,
    step: [f64; 4],
}

impl Row {
    fn all(modes: &[FlowMode], step: f64, count: usize) -> Vec<Self> {
        let still = FlowMode { omega: 1.0 / step, damping: 0.0, share: 0.0, fast_angle: f64::INFINITY };
        let own = own_answer(modes, step);
        let row = |mode: &FlowMode| Self::new(&FlowMode { share: mode.share / own, ..*mode }, step);
        let mut rows: Vec<Self> = modes.iter().map(row).collect();
        rows.resize_with(count, || Self::new(&still, step));
        rows
    }

    fn new(mode: &FlowMode, step: f64) -> Self {
        let FlowMode { omega, damping, share, .. } = *mode;
        let angle = omega * step;
        let half = 0.5 * angle;
        let loss = 2.0 * damping * angle;
        let (factor, mean) = match mode.is_fast(step) {
            true => (share * mode.stored_share(step).powi(2), Some(share * mode.answer(step))),
            false => {
                let (turn, loss) = (1.0 - angle * angle / 24.0, 1.0 - loss * loss / 24.0);
                (share * half.tan() / half * turn * loss, None)
            }
        };
        Self { angle, damping, share, factor, mean, step: increments(angle, damping) }
    }

    /// Travel per step of a unit of u along the path that the contact sees.
    fn rate(&self) -> f64 {
        if self.mean.is_some() { 0.0 } else { self.angle }
    }

    /// What a unit of a kick's shift moves the mode by.
    fn shift(&self) -> f64 {
        if self.mean.is_some() { 0.0 } else { self.share }
    }

    /// Damping rate per step, omega h/Q.
    fn loss(&self) -> f64 {
        2.0 * self.damping * self.angle
    }

    fn kick_u(&self) -> f64 {
        self.factor / self.angle
    }

    fn kick_x(&self) -> f64 {
        self.shift() * self.damping * self.angle / 12.0
    }

    /// The kick as the flow over a step leaves it.
    fn land(&self) -> [f64; 2] {
        let [m00, m01, m10, m11] = self.step;
        let (x, u) = (self.kick_x(), self.kick_u());
        [x + (m00 * x + m01 * u), u + (m10 * x + m11 * u)]
    }

    /// Half of the tip's change of speed, less its part of what `work_u` takes.
    fn kick_paid(&self) -> f64 {
        let path = if self.mean.is_some() { 0.0 } else { self.factor };
        0.5 * (path - self.work_u() * self.kick_u())
    }

    /// The path has none of a fast mode's speed, and its mean speed over the step counts as work.
    fn work_u(&self) -> f64 {
        if self.mean.is_some() {
            return -self.angle;
        }
        (self.loss() * self.loss() - self.angle * self.angle) * self.angle / 24.0
    }

    /// g omega^2/24 in the limit of short steps; in this form a steady force does no work at all. Its
    /// state is the one that a kick and a step lead back to: -m s = (1 + m) kick.
    fn work_x(&self) -> f64 {
        if self.share == 0.0 {
            return 0.0;
        }
        let [m00, m01, m10, m11] = self.step;
        let kick_u = self.kick_u();
        let [right_x, right_u] = self.land();
        let scale = m01 * m10 - m00 * m11;
        let still_x = (m11 * right_x - m01 * right_u) / scale;
        let still_u = (m00 * right_u - m10 * right_x) / scale;
        (self.rate() - self.work_u()) * (still_u + 0.5 * kick_u) / still_x
    }
}

/// Where a free damped oscillator at (x, x'/omega) is by the angle omega t later, or earlier.
pub fn flown(angle: f64, damping: f64, [x, u]: [f64; 2]) -> [f64; 2] {
    let [m00, m01, m10, m11] = increments(angle, damping);
    [x + (m00 * x + m01 * u), u + (m10 * x + m11 * u)]
}

/// The step matrix minus one of a damped oscillator over the angle omega h, in (x, x'/omega).
///
/// Written with sin^2 and expm1 so that nothing cancels however short the step.
pub fn increments(angle: f64, damping: f64) -> [f64; 4] {
    let decay = -damping * angle;
    let shrink = decay.exp_m1();
    if damping < 1.0 {
        let root = (1.0 - damping * damping).sqrt();
        let turn = root * angle;
        let sine = turn.sin();
        let versine = 2.0 * (0.5 * turn).sin().powi(2);
        let scaled = (shrink + 1.0) * sine / root;
        // exp(decay) cos(turn) - 1
        let cosine = shrink - (shrink + 1.0) * versine;
        [cosine + damping * scaled, scaled, -scaled, cosine - damping * scaled]
    } else {
        // Aperiodic (Q <= 1/2): the same with hyperbolic functions; sinh(y)/y at y = 0 is 1.
        let root = (damping * damping - 1.0).sqrt();
        let turn = root * angle;
        let scaled = (shrink + 1.0) * if turn < 1e-8 { angle } else { turn.sinh() / root };
        let cosine = shrink + (shrink + 1.0) * 2.0 * (0.5 * turn).sinh().powi(2);
        [cosine + damping * scaled, scaled, -scaled, cosine - damping * scaled]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    type Matrix = [[f64; 2]; 2];

    fn product(a: Matrix, b: Matrix) -> Matrix {
        std::array::from_fn(|i| std::array::from_fn(|j| a[i][0] * b[0][j] + a[i][1] * b[1][j]))
    }

    /// exp(A) - 1 by Taylor's series of a small part of A, then (1 + m)^2 - 1 = 2m + m^2.
    fn exponential(a: Matrix) -> Matrix {
        let halvings = 20;
        let part = a.map(|row| row.map(|v| v / f64::from(1 << halvings)));
        let mut term = part;
        let mut sum = part;
        for n in 2..12 {
            term = product(term, part).map(|row| row.map(|v| v / f64::from(n)));
            sum = std::array::from_fn(|i| std::array::from_fn(|j| sum[i][j] + term[i][j]));
        }
        for _ in 0..halvings {
            let square = product(sum, sum);
            sum = std::array::from_fn(|i| std::array::from_fn(|j| 2.0 * sum[i][j] + square[i][j]));
        }
        sum
    }

    #[test]
    fn increments_are_the_matrix_exponential() {
        for damping in [0.0, 1e-9, 1e-4, 0.02, 0.5, 0.999_999, 1.0, 1.000_001, 1.25] {
            for angle in [1e-6, 1e-3, 0.1, 0.9, 3.0] {
                let [m00, m01, m10, m11] = increments(angle, damping);
                let exact = exponential([[0.0, angle], [-angle, -2.0 * damping * angle]]);
                let got = [[m00, m01], [m10, m11]];
                for i in 0..2 {
                    for j in 0..2 {
                        // Relative to the entry while steps are short: increments must not cancel.
                        let scale = exact[i][j].abs().max(1e-3 * angle * angle);
                        let error = (got[i][j] - exact[i][j]).abs() / scale;
                        assert!(
                            error < 2e-9,
                            "damping {damping}, angle {angle}, entry {i}{j}: {:e}, expected {:e}",
                            got[i][j],
                            exact[i][j]
                        );
                    }
                }
            }
        }
    }

    /// The same of a mode that turns by radians in a step, by its mean over the step.
    #[test]
    fn a_fast_mode_answers_a_steady_force_exactly() {
        for damping in [1e-7, 1e-5, 0.003] {
            for angle in [1.3, 2.9, 3.2, 6.2, 6.4, 17.0, 41.5] {
                let mode = FlowMode { omega: angle, damping, share: 1.0, fast_angle: FAST_ANGLE };
                let lever = Lever::new(&[mode], 1.0, 1);
                let own = own_answer(&[mode], 1.0);
                let [m00, m01, m11, rate, pull, drag, rx, ru, .., corner] = lever.motion[..] else {
                    panic!()
                };
                let [work_x, work_u, kick_paid, mean_corner] = lever.energy[..] else { panic!() };
                assert_eq!([rate, pull, drag], [0.0; 3]);
                let scale = -m01 * m01 - m00 * m11;
                let (x, u) = ((m11 * rx - m01 * ru) / scale, (m00 * ru + m01 * rx) / scale);
                // Of a unit of the force's impulse per step: travel 1/angle^2.
                for part in [corner, mean_corner] {
                    let held = (x + part) * own * angle * angle;
                    let bound = 4.0 * damping / angle.sin().abs() + 1e-12;
                    assert!((held - 1.0).abs() < bound, "{damping}, {angle}: off by {:e}", held - 1.0);
                }
                let speed = kick_paid + rate * u - work_x * x - work_u * u;
                assert!(speed.abs() < 1e-9, "{damping}, {angle}: {speed:e}");
            }
        }
    }

    /// Under a steady force the kicked mode settles where the force holds it (to fourth order, and
    /// exactly without damping), and no work is done.
    #[test]
    fn a_steady_force_is_answered_exactly() {
        for damping in [1e-5, 0.003, 0.1, 0.7] {
            for angle in [0.01, 0.1, 0.5, 0.9] {
                let mode = FlowMode { omega: angle, damping, share: 1.0, fast_angle: f64::INFINITY };
                let lever = Lever::new(&[mode], 1.0, 1);
                // The state before a kick that kick and step lead back to: -m s = (1 + m) kick.
                let kx = Row::new(&mode, 1.0).kick_x();
                let [m00, m01, m11, rate, _, _, rx, ru, ..] = lever.motion[..] else { panic!() };
                let [work_x, work_u, kick_paid, _] = lever.energy[..] else { panic!() };
                let m10 = -m01;
                let scale = m01 * m10 - m00 * m11;
                let (x, u) = ((m11 * rx - m01 * ru) / scale, (m00 * ru - m10 * rx) / scale);
                // Of unit impulse per step: travel 1/angle^2. Midway through the kick, and with the
                // corner, a 24th of the impulse, that the sample puts back.
                let held = (x + 0.5 * kx + 1.0 / 24.0) * angle * angle;
                let bound = 0.1 * damping * damping * angle.powi(4) + 1e-12;
                assert!((held - 1.0).abs() < bound, "{damping}, {angle}: off by {:e}", held - 1.0);
                let speed = kick_paid + rate * u - work_x * x - work_u * u;
                assert!(speed.abs() < 1e-11, "{damping}, {angle}: {speed:e}");
            }
        }
    }
}

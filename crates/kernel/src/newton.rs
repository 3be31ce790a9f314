//! One step of Newton's way to a fixed point of a map that tells its slope: g(x) = x is solved by strides dx = (1 + 1/T - g')^-1
//! (g(x) - x). Of a short time T they follow the flow that repeating the map takes, of a long one they are Newton's; T grows as the
//! map's change falls (pseudo-transient continuation, Kelley and Keyes, SIAM J. Numer. Anal. 35 (1998) 508). A stride that leads no
//! nearer is shortened.
//!
//! Twin: shaders/search.wgsl, newton/walk.wgsl and solve.wgsl. One instance, on no heap, every operation rounds and sums have one order, so
//! that both give the same bits.

use super::broyden::{Arrival, Phase, dot, finite, less};
use super::constants::{FAR, FIVE, FOUR, HALF, LEAST, ONE, QUARTER, ZERO};
pub use super::constants::{FARTHEST, GAINS, LONGER, LONGEST, NEWTON};
use super::{Lane, MODES_MAX};

/// Most periods of a map, each with its slope, before the way to a state is given up.
pub const ROUNDS: u32 = 96;

/// Most numbers of a state.
const MOST: usize = 2 * MODES_MAX;

/// How near a fixed point is to be.
#[derive(Clone, Copy, Debug)]
pub struct Aim<E> {
    /// Length of a state that is not small.
    pub scale: E,
    /// The longest step of Newton's that leads to it, in units of that.
    pub near: E,
    /// The same where no stride leads nearer: the map is too rough.
    pub enough: E,
}

/// How an instance is on its way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Walk<E> {
    /// How far the map led from the place that was taken last.
    pub change: E,
    /// Time that the next stride stands for, periods.
    pub time: E,
    /// How often the stride was shortened; beyond four it is none, and the place taken last is looked at once more.
    pub tries: E,
}

impl<E: Lane<Element = E>> Walk<E> {
    /// Before the first period; the first stride stands for so many, Newton's for infinitely many.
    pub fn new(time: f64) -> Self {
        Self { change: E::splat(ZERO), time: E::splat(time.min(FAR)), tries: E::splat(ZERO) }
    }
}

/// Where an instance is on its way. A state has n numbers, and n is even.
#[derive(Debug)]
pub struct Striding<'a, E> {
    /// The place that was taken last. The period began a stride further.
    pub place: &'a mut [E],
    pub stride: &'a mut [E],
    pub walk: &'a mut Walk<E>,
    /// Room for a matrix.
    pub factors: &'a mut [E],
}

/// Takes in that a period has led to `end`, with its slope, column by column. What is found is at its place.
///
/// Nothing is done for a state of more than 2 [`MODES_MAX`] numbers: it is lost.
pub fn arrive<E: Lane<Element = E>>(
    end: &[E],
    slope: &[E],
    aim: &Aim<E>,
    arrival: Arrival,
    here: Striding<E>,
) -> Phase {
    let n = here.place.len();
    if n > MOST {
        return Phase::Lost;
    }
    let mut change = [E::splat(ZERO); MOST];
    for (k, change) in change[..n].iter_mut().enumerate() {
        *change = end[k] - (here.place[k] + here.stride[k]);
    }
    let steep = dot(slope, slope).sqrt();
    let sound = arrival.sound && finite(steep);
    if less(E::splat(FOUR), here.walk.tries) {
        return looked(slope, aim, (sound, &mut change[..n]), here);
    }
    let length = dot(&change[..n], &change[..n]).sqrt();
    let gain = here.walk.change / length.max(E::splat(LEAST));
    // Early strides may climb a little, as the flow does.
    let least = if less(here.walk.time, E::splat(NEWTON)) { E::splat(HALF) } else { E::splat(GAINS) };
    if !sound || (arrival.strode && less(gain, least)) {
        return refused(arrival.strode, here);
    }
    if arrival.strode {
        let longer = (E::splat(LONGER) * gain).min(E::splat(LONGEST));
        here.walk.time = (here.walk.time * longer).min(E::splat(FAR));
    }
    (here.walk.change, here.walk.tries) = (length, E::splat(ZERO));
    add(here.place, here.stride);
    strode(slope, aim, (steep, &mut change[..n]), here)
}

/// A stride has led nowhere: it is shortened, or the place that it began at is looked at once more.
fn refused<E: Lane<Element = E>>(strode: bool, here: Striding<E>) -> Phase {
    if !strode {
        return Phase::Lost;
    }
    let Striding { stride, walk, .. } = here;
    if less(walk.tries, E::splat(FOUR)) {
        walk.tries = walk.tries + E::splat(ONE);
        walk.time = (E::splat(QUARTER) * walk.time).min(E::splat(NEWTON));
        scale(stride, E::splat(QUARTER));
    } else {
        walk.tries = E::splat(FIVE);
        stride.fill(E::splat(ZERO));
    }
    Phase::On
}

/// Whether the place that no stride leads on from is as near as a rough map lets it be.
fn looked<E: Lane<Element = E>>(
    slope: &[E],
    aim: &Aim<E>,
    (sound, step): (bool, &mut [E]),
    here: Striding<E>,
) -> Phase {
    if !sound || !solve(slope, E::splat(ONE), here.factors, step) {
        return Phase::Lost;
    }
    let long = dot(step, step).sqrt();
    if finite(long) && !less(aim.enough * aim.scale, long) { Phase::Found } else { Phase::Lost }
}

/// The next stride from a place that was taken, of which the change is given; or the end where Newton's step is short enough.
fn strode<E: Lane<Element = E>>(
    slope: &[E],
    aim: &Aim<E>,
    (steep, step): (E, &mut [E]),
    here: Striding<E>,
) -> Phase {
    let Striding { place, stride, walk, factors } = here;
    let one = E::splat(ONE);
    let near = aim.near * aim.scale;
    // Newton's step is no shorter than the change that it undoes over the norm of 1 - slope.
    let far = less(near * (one + steep), walk.change);
    let flows = less(walk.time, E::splat(NEWTON));
    let shift = one / walk.time + one;
    stride.copy_from_slice(step);
    if !far {
        if !solve(slope, one, factors, step) {
            return Phase::Lost;
        }
        let long = dot(step, step).sqrt();
        if finite(long) && !less(near, long) {
            add(place, step);
            return Phase::Found;
        }
    }
    if far || flows {
        step.copy_from_slice(stride);
        if !solve(slope, if flows { shift } else { one }, factors, step) {
            return Phase::Lost;
        }
    }
    let long = dot(step, step).sqrt();
    if !finite(long) {
        return Phase::Lost;
    }
    let longest = E::splat(FARTHEST) * aim.scale;
    if less(longest, long) {
        scale(step, longest / long);
    }
    stride.copy_from_slice(step);
    Phase::On
}

fn add<E: Lane<Element = E>>(to: &mut [E], list: &[E]) {
    to.iter_mut().zip(list).for_each(|(to, value)| *to = *to + *value);
}

fn scale<E: Lane<Element = E>>(list: &mut [E], times: E) {
    list.iter_mut().for_each(|value| *value = *value * times);
}

/// Solves (shift - slope) step = step by Gauss' elimination with the largest of each column as its pivot; false where a column
/// has none. All matrices are column by column.
fn solve<E: Lane<Element = E>>(slope: &[E], shift: E, factors: &mut [E], step: &mut [E]) -> bool {
    let n = step.len();
    for column in 0..n {
        for row in 0..n {
            let one = if row == column { shift } else { E::splat(ZERO) };
            factors[column * n + row] = one - slope[column * n + row];
        }
    }
    for k in 0..n {
        let pivot = pivot(factors, n, k);
        let largest = factors[k * n + pivot];
        if !less(E::splat(ZERO), largest.abs()) {
            return false;
        }
        if pivot != k {
            (k..n).for_each(|column| factors.swap(column * n + k, column * n + pivot));
            step.swap(k, pivot);
        }
        clear(factors, k, E::splat(ONE) / largest, step);
    }
    for k in (0..n).rev() {
        step[k] = step[k] / factors[k * n + k];
        for row in 0..k {
            step[row] = (-factors[k * n + row]).mul_add(step[k], step[row]);
        }
    }
    true
}

/// The row of the largest number of a column, from the diagonal on.
fn pivot<E: Lane<Element = E>>(factors: &[E], n: usize, k: usize) -> usize {
    let mut pivot = k;
    let mut largest = factors[k * n + k].abs();
    for row in k + 1..n {
        let size = factors[k * n + row].abs();
        if less(largest, size) {
            (largest, pivot) = (size, row);
        }
    }
    pivot
}

/// Takes the k-th row from those below it, so that nothing is left of the k-th column there.
fn clear<E: Lane<Element = E>>(factors: &mut [E], k: usize, inverse: E, step: &mut [E]) {
    let n = step.len();
    for row in k + 1..n {
        let share = factors[k * n + row] * inverse;
        factors[k * n + row] = share;
        step[row] = (-share).mul_add(step[k], step[row]);
    }
    for column in k + 1..n {
        let by = factors[column * n + k];
        for row in k + 1..n {
            let place = column * n + row;
            factors[place] = (-factors[k * n + row]).mul_add(by, factors[place]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One on its way under a map.
    struct Way<E> {
        place: Vec<E>,
        stride: Vec<E>,
        walk: Walk<E>,
        rounds: u32,
    }

    impl<E: Lane<Element = E>> Way<E> {
        fn new(place: &[f64], time: f64) -> Self {
            let place: Vec<E> = place.iter().map(|value| E::element(*value)).collect();
            let stride = vec![E::splat(0.0); place.len()];
            Self { place, stride, walk: Walk::new(time), rounds: 0 }
        }

        /// Where the next period begins.
        fn from(&self) -> Vec<f64> {
            self.place.iter().zip(&self.stride).map(|(a, b)| a.lane(0) + b.lane(0)).collect()
        }

        fn step(&mut self, (end, slope): (Vec<f64>, Vec<f64>), sound: bool) -> Phase {
            let numbers = |list: &[f64]| list.iter().map(|value| E::element(*value)).collect::<Vec<E>>();
            let aim = Aim { scale: E::splat(2.0), near: E::splat(1e-6), enough: E::splat(1e-2) };
            let mut factors = vec![E::splat(0.0); slope.len()];
            let arrival = Arrival { strode: self.rounds > 0, sound };
            self.rounds += 1;
            let Self { place, stride, walk, .. } = self;
            let here = Striding { place, stride, walk, factors: &mut factors };
            arrive(&numbers(&end), &numbers(&slope), &aim, arrival, here)
        }

        /// To the end under a map.
        fn run(&mut self, map: impl Fn(&[f64]) -> (Vec<f64>, Vec<f64>)) -> Phase {
            loop {
                let phase = self.step(map(&self.from()), true);
                if phase != Phase::On || self.rounds == ROUNDS {
                    return phase;
                }
            }
        }
    }

    fn noise(seed: &mut u64) -> f64 {
        *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (*seed >> 40) as f64 / (1u64 << 23) as f64 - 1.0
    }

    fn apart(a: &[f64], b: &[f64]) -> f64 {
        a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
    }

    /// A linear map around a point.
    fn linear(slope: &[f64], point: &[f64]) -> impl Fn(&[f64]) -> (Vec<f64>, Vec<f64>) {
        let (slope, point) = (slope.to_vec(), point.to_vec());
        move |place| {
            let n = place.len();
            let row = |i: usize| {
                let off = (0..n).map(|j| slope[j * n + i] * (place[j] - point[j]));
                point[i] + off.sum::<f64>()
            };
            ((0..n).map(row).collect(), slope.clone())
        }
    }

    fn lands<E: Lane<Element = E>>(near: f64) {
        for n in [2, 4, 6, 16, 48] {
            let mut seed = n as u64;
            // Large beside one, so that rows have to be swapped.
            let slope: Vec<f64> = (0..n * n).map(|_| 3.0 * noise(&mut seed)).collect();
            let point: Vec<f64> = (0..n).map(|_| noise(&mut seed)).collect();
            let place: Vec<f64> =
                point.iter().map(|value| value + 0.1 / (n as f64).sqrt() * noise(&mut seed)).collect();
            let mut way = Way::<E>::new(&place, f64::INFINITY);
            assert_eq!(way.step(linear(&slope, &point)(&place), true), Phase::On, "{n}");
            assert!(apart(&way.from(), &point) < near, "{n}: {:e}", apart(&way.from(), &point));
        }
    }

    /// Truth: a linear map's fixed point is one of Newton's steps away.
    #[test]
    fn a_linear_map_takes_one_step() {
        lands::<f64>(1e-12);
        lands::<f32>(1e-4);
        let mut way = Way::<f64>::new(&[0.3, 0.2], f64::INFINITY);
        let phase = way.run(linear(&[0.5, 0.1, -0.2, 0.6], &[0.2, 0.3]));
        assert_eq!((phase, way.rounds), (Phase::Found, 2));
        assert!(apart(&way.from(), &[0.2, 0.3]) < 1e-12, "{:?}", way.from());
    }

    /// Truth: a stride of a short time is that of the flow, and no stride is longer than it may be.
    #[test]
    fn the_first_strides_follow_the_flow() {
        let map = linear(&[0.99, 0.0, 0.0, 0.5], &[0.0, 0.0]);
        let mut way = Way::<f64>::new(&[0.2, 0.1], 20.0);
        assert_eq!(way.step(map(&[0.2, 0.1]), true), Phase::On);
        let exact = [0.2 - 0.002 / (0.01 + 0.05), 0.1 - 0.05 / (0.5 + 0.05)];
        assert!(apart(&way.from(), &exact) < 1e-12, "{:?}", way.from());
        let mut way = Way::<f64>::new(&[5.0, 0.0], 20.0);
        assert_eq!(way.step(map(&[5.0, 0.0]), true), Phase::On);
        assert!(apart(&way.from(), &[4.8, 0.0]) < 1e-12, "{:?}", way.from());
        assert_eq!(way.run(map), Phase::Found);
        assert!(apart(&way.from(), &[0.0, 0.0]) < 1e-9 && way.rounds < 40, "{} {:?}", way.rounds, way.from());
    }

    /// A step that leads farther away is shortened until it does not.
    #[test]
    fn a_step_too_far_is_shortened() {
        // Of x -> x + atan x with the sign turned: from beyond 1.39 Newton's step leads away.
        let map = |x: &[f64]| {
            let far = 30.0 * x[0];
            (vec![x[0] - far.atan() / 30.0, 0.0], vec![1.0 - 1.0 / (1.0 + far * far), 0.0, 0.0, 0.0])
        };
        let mut way = Way::<f64>::new(&[0.09, 0.0], f64::INFINITY);
        assert_eq!(way.step(map(&[0.09, 0.0]), true), Phase::On);
        let first = way.stride[0];
        assert_eq!(way.step(map(&way.from()), true), Phase::On);
        assert_eq!((way.stride[0], way.walk.tries, way.walk.time), (0.25 * first, 1.0, 1e5));
        assert_eq!(way.run(map), Phase::Found);
        assert!(way.from()[0].abs() < 1e-9, "{:?}", way.from());
    }

    /// Where the map jumps as one comes near, a place near enough is taken.
    #[test]
    fn a_rough_map_is_left_at_what_is_near_enough() {
        let rough = |size: f64| {
            move |x: &[f64]| {
                let jump = if x[0] == 0.3 { 0.3 * size } else { size };
                (vec![x[0] + jump, 0.5 * x[1]], vec![0.0, 0.0, 0.0, 0.5])
            }
        };
        for (size, end) in [(0.05, Phase::Found), (0.1, Phase::Lost)] {
            let mut way = Way::<f64>::new(&[0.3, 0.0], f64::INFINITY);
            assert_eq!((way.run(rough(size)), way.rounds), (end, 7), "{size}");
            assert_eq!(way.from(), [0.3, 0.0]);
        }
    }

    #[test]
    fn what_leads_nowhere_is_lost() {
        let half = vec![0.5, 0.0, 0.0, 0.5];
        for (end, slope, sound) in [
            (vec![0.1, 0.2], half.clone(), false),
            (vec![0.1, 0.2], vec![f64::NAN; 4], true),
            (vec![0.1, 0.2], vec![1.0, 0.0, 0.0, 1.0], true),
            (vec![f64::INFINITY, 0.0], half, true),
        ] {
            let mut way = Way::<f64>::new(&[0.3, 0.1], f64::INFINITY);
            assert_eq!(way.step((end.clone(), slope.clone()), sound), Phase::Lost, "{end:?} {slope:?}");
        }
        // Larger than any state.
        let mut way = Way::<f64>::new(&[0.0; 50], 20.0);
        assert_eq!(way.step((vec![0.0; 50], vec![0.0; 2500]), true), Phase::Lost);
    }
}

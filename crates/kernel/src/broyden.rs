//! One stride of Broyden's method towards a fixed point of a map: g(x) = x is solved by strides dx = H (g(x) - x), with H near
//! the inverse of one minus the map's slope, and after each stride H is corrected by what the map has shown of itself (Broyden,
//! Math. Comp. 19 (1965) 577; of the inverse by Sherman and Morrison).
//!
//! Twin: shaders/search.wgsl and broyden/stride.wgsl. One instance, on no heap, every operation rounds and sums have one order, so that both
//! give the same bits; sums along a column go by its even and its odd numbers, which a processor adds up side by side.

use super::constants::{FARTHEST, ONE, ZERO};
use super::{Lane, MODES_MAX};

/// Most periods of a map before the way to a state is given up.
pub const ROUNDS: u32 = 16;

/// Numbers of modes that states are taken to have, and that searches are compiled for: each costs about a second of compiling.
/// Between them a state is larger than it need be, but no period is stepped for what is at rest in it.
pub const STATE_MODES: [usize; 9] = [1, 2, 3, 4, 6, 8, 12, 16, MODES_MAX];

/// The number of modes that a state of so many is taken to have.
pub fn state_modes(modes: usize) -> usize {
    STATE_MODES.into_iter().find(|size| modes <= *size).unwrap_or(MODES_MAX)
}

/// What becomes of an instance after a period.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Phase {
    /// It has another place to try.
    On = 0,
    /// The place where the period began is a fixed point, as near as was asked for.
    Found = 1,
    /// It leads nowhere.
    Lost = 2,
}

/// How near a fixed point is to be.
#[derive(Clone, Copy, Debug)]
pub struct Goal<E> {
    /// Length of a state that is not small.
    pub scale: E,
    /// The longest stride that need not be taken, in units of it.
    pub near: E,
    /// The largest bound on the distance of a place that is a fixed point, in units of it.
    pub sure: E,
}

/// Where an instance is on its way. A state has n numbers.
#[derive(Debug)]
pub struct Standing<'a, E> {
    /// Where the period began; then where the next one is to.
    pub place: &'a mut [E],
    /// The stride that led there, if one did; then the next one.
    pub stride: &'a mut [E],
    /// H, column by column.
    pub undoes: &'a mut [E],
}

/// What is known of a period.
#[derive(Clone, Copy, Debug)]
pub struct Arrival {
    /// Whether a stride led to where it began.
    pub strode: bool,
    /// Whether all numbers of its end are numbers, and nothing else says that it is of no use.
    pub sound: bool,
}

/// Takes in that a period has led to `end`. What is found or lost stays where it is, and of what is lost H does, too.
///
/// Nothing is done for a state of more than 2 [`MODES_MAX`] numbers: it is lost.
pub fn stride<E: Lane<Element = E>>(end: &[E], goal: &Goal<E>, arrival: Arrival, here: Standing<E>) -> Phase {
    const MOST: usize = 2 * MODES_MAX;
    match here.place.len() {
        2 => of::<E, 2>(2, end, goal, arrival, here),
        4 => of::<E, 4>(4, end, goal, arrival, here),
        6 => of::<E, 6>(6, end, goal, arrival, here),
        8 => of::<E, 8>(8, end, goal, arrival, here),
        12 => of::<E, 12>(12, end, goal, arrival, here),
        n @ ..=MOST => of::<E, MOST>(n, end, goal, arrival, here),
        _ => Phase::Lost,
    }
}

/// Of n numbers, N at the most.
#[inline(always)]
fn of<E: Lane<Element = E>, const N: usize>(
    n: usize,
    end: &[E],
    goal: &Goal<E>,
    arrival: Arrival,
    here: Standing<E>,
) -> Phase {
    if !arrival.sound {
        return Phase::Lost;
    }
    let Standing { place, stride, undoes } = here;
    let zero = E::splat(ZERO);
    let (mut change, mut next) = ([zero; N], [zero; N]);
    for (k, change) in change[..n].iter_mut().enumerate() {
        *change = end[k] - place[k];
    }
    let change = &change[..n];
    for (column, change) in undoes.chunks_exact(n).zip(change) {
        add(&mut next[..n], column, *change);
    }
    let undone = next;
    // One minus the slope loses the change times the stride over its square, so H gains what undoes the change times `along`.
    let mut along = [zero; N];
    if arrival.strode {
        for (column, along) in undoes.chunks_exact(n).zip(&mut along) {
            *along = dot(column, stride);
        }
        let square = dot(stride, stride);
        let share = E::splat(ONE) / (square - dot(&along[..n], change));
        along.iter_mut().for_each(|along| *along = *along * share);
        // What H then makes of the change.
        let longer = square * share;
        next.iter_mut().for_each(|next| *next = *next * longer);
    }
    let next = &next[..n];
    let left = dot(next, next).sqrt() / goal.scale;
    if !finite(left) || less(E::splat(FARTHEST), left) {
        return Phase::Lost;
    }
    if arrival.strode {
        for (column, along) in undoes.chunks_exact_mut(n).zip(&along) {
            add(column, &undone[..n], *along);
        }
    }
    if !less(goal.near, left) {
        let bound = dot(change, change).sqrt() * dot(undoes, undoes).sqrt() / goal.scale;
        if finite(bound) && !less(goal.sure, bound) {
            return Phase::Found;
        }
    }
    for (k, next) in next.iter().enumerate() {
        place[k] = place[k] + *next;
        stride[k] = *next;
    }
    Phase::On
}

/// Adds so many times a list of numbers.
#[inline(always)]
fn add<E: Lane<Element = E>>(to: &mut [E], list: &[E], times: E) {
    to.iter_mut().zip(list).for_each(|(to, value)| *to = value.mul_add(times, *to));
}

/// The sum of the products of an even number of numbers.
#[inline(always)]
pub(super) fn dot<E: Lane<Element = E>>(a: &[E], b: &[E]) -> E {
    let mut sums = [E::splat(ZERO); 2];
    for (a, b) in a.chunks_exact(2).zip(b.chunks_exact(2)) {
        sums = [a[0].mul_add(b[0], sums[0]), a[1].mul_add(b[1], sums[1])];
    }
    sums[0] + sums[1]
}

#[inline(always)]
pub(super) fn less<E: Lane<Element = E>>(a: E, b: E) -> bool {
    E::any(a.less(b))
}

/// Whether it is a number, and not beyond f32: as the shader tells it.
#[inline(always)]
pub(super) fn finite<E: Lane<Element = E>>(value: E) -> bool {
    (value.lane(0) as f32).is_finite()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers without a pattern, from -1 to 1.
    fn noise(seed: &mut u64) -> f64 {
        *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (*seed >> 40) as f64 / (1u64 << 23) as f64 - 1.0
    }

    /// A square matrix, column by column.
    #[derive(Clone)]
    struct Matrix(usize, Vec<f64>);

    impl Matrix {
        fn new(n: usize, entry: impl Fn(usize, usize) -> f64) -> Self {
            Self(n, (0..n * n).map(|place| entry(place % n, place / n)).collect())
        }

        fn times(&self, vector: &[f64]) -> Vec<f64> {
            let row = |i: usize| (0..self.0).map(|j| self.1[j * self.0 + i] * vector[j]).sum();
            (0..self.0).map(row).collect()
        }

        /// By Gauss and Jordan; the matrices here ask for no pivots.
        fn inverse(&self) -> Self {
            let n = self.0;
            let mut rows: Vec<Vec<f64>> = (0..n)
                .map(|i| {
                    let own = (0..n).map(|j| self.1[j * n + i]);
                    own.chain((0..n).map(|j| f64::from(u8::from(i == j)))).collect()
                })
                .collect();
            for k in 0..n {
                let pivot = rows[k][k];
                rows[k].iter_mut().for_each(|value| *value /= pivot);
                let own = rows[k].clone();
                for row in rows.iter_mut().enumerate().filter(|(i, _)| *i != k).map(|(_, row)| row) {
                    let factor = row[k];
                    row.iter_mut().zip(&own).for_each(|(value, own)| *value -= factor * own);
                }
            }
            Self::new(n, |i, j| rows[i][n + j])
        }
    }

    fn length(vector: &[f64]) -> f64 {
        vector.iter().map(|value| value * value).sum::<f64>().sqrt()
    }

    fn apart(a: &[f64], b: &[f64]) -> f64 {
        length(&a.iter().zip(b).map(|(a, b)| a - b).collect::<Vec<f64>>())
    }

    /// One on its way under a map, in either precision.
    struct Walk<E> {
        place: Vec<E>,
        stride: Vec<E>,
        undoes: Vec<E>,
        strode: bool,
    }

    impl<E: Lane<Element = E>> Walk<E> {
        fn new(place: &[f64], undoes: &Matrix) -> Self {
            let numbers = |list: &[f64]| list.iter().map(|value| E::element(*value)).collect::<Vec<E>>();
            let stride = numbers(&vec![0.0; place.len()]);
            Self { place: numbers(place), stride, undoes: numbers(&undoes.1), strode: false }
        }

        fn step(&mut self, end: &[f64], sound: bool) -> Phase {
            let end: Vec<E> = end.iter().map(|value| E::element(*value)).collect();
            let goal = Goal { scale: E::splat(2.0), near: E::splat(1e-6), sure: E::splat(3e-5) };
            let arrival = Arrival { strode: self.strode, sound };
            let Self { place, stride: last, undoes, .. } = self;
            let here = Standing { place, stride: last, undoes };
            self.strode = true;
            stride(&end, &goal, arrival, here)
        }
    }

    fn read<E: Lane<Element = E>>(list: &[E]) -> Vec<f64> {
        list.iter().map(|value| value.lane(0)).collect()
    }

    /// Of a linear map with a fixed point: the slope, the point, and a place next to it.
    fn problem(n: usize, seed: u64) -> (Matrix, Vec<f64>, Vec<f64>) {
        let mut seed = seed;
        let share = 0.5 / n as f64;
        let numbers: Vec<f64> = (0..n * n).map(|_| share * noise(&mut seed)).collect();
        let slope = Matrix(n, numbers);
        let point: Vec<f64> = (0..n).map(|_| noise(&mut seed)).collect();
        let place = point.iter().map(|value| value + 0.02 / (n as f64).sqrt() * noise(&mut seed)).collect();
        (slope, point, place)
    }

    fn mapped(slope: &Matrix, point: &[f64], place: &[f64]) -> Vec<f64> {
        let off: Vec<f64> = place.iter().zip(point).map(|(a, b)| a - b).collect();
        slope.times(&off).iter().zip(point).map(|(off, point)| point + off).collect()
    }

    fn unit(i: usize, j: usize) -> f64 {
        f64::from(u8::from(i == j))
    }

    fn lands<E: Lane<Element = E>>(near: f64) {
        for n in [2, 4, 6, 8, 12, 16, 24, 32, 48, 10] {
            let (slope, point, place) = problem(n, n as u64);
            let undoes = Matrix::new(n, |i, j| unit(i, j) - slope.1[j * n + i]).inverse();
            let mut walk = Walk::<E>::new(&place, &undoes);
            assert_eq!(walk.step(&mapped(&slope, &point, &place), true), Phase::On, "{n}");
            let there = read(&walk.place);
            assert!(apart(&there, &point) < near, "{n}: {:e}", apart(&there, &point));
            let before = read(&walk.place);
            assert_eq!(walk.step(&mapped(&slope, &point, &before), true), Phase::Found, "{n}");
            assert_eq!(read(&walk.place), before, "{n}: what is found stays");
        }
    }

    /// Truth: a linear map's fixed point is one stride by its own inverse away.
    #[test]
    fn a_linear_map_takes_one_stride() {
        lands::<f64>(1e-13);
        lands::<f32>(2e-6);
    }

    /// Truth: Broyden's update of one minus the slope itself, inverted by Gauss and Jordan; and the secant condition, that H
    /// takes by how much the change has fallen to the stride that it fell by.
    #[test]
    fn the_inverse_is_that_of_broydens_update() {
        for n in [2, 6, 8, 16, 48] {
            let (slope, point, place) = problem(n, 31 + n as u64);
            // The slope is not known.
            let begun = Matrix::new(n, unit);
            let mut walk = Walk::<f64>::new(&place, &begun);
            let before: Vec<f64> =
                mapped(&slope, &point, &place).iter().zip(&place).map(|(a, b)| a - b).collect();
            assert_eq!(walk.step(&mapped(&slope, &point, &place), true), Phase::On);
            let (there, taken) = (walk.place.clone(), walk.stride.clone());
            assert!(apart(&taken, &before) < 1e-15, "{n}: by the identity the stride is the change");
            let after: Vec<f64> =
                mapped(&slope, &point, &there).iter().zip(&there).map(|(a, b)| a - b).collect();
            assert_eq!(walk.step(&mapped(&slope, &point, &there), true), Phase::On);
            let square = length(&taken).powi(2);
            let minus = Matrix::new(n, |i, j| unit(i, j) - after[i] * taken[j] / square);
            let exact = minus.inverse();
            assert!(apart(&walk.undoes, &exact.1) < 1e-12 * length(&exact.1), "{n}: the inverse");
            let fallen: Vec<f64> = before.iter().zip(&after).map(|(a, b)| a - b).collect();
            let secant = Matrix(n, walk.undoes.clone()).times(&fallen);
            assert!(apart(&secant, &taken) < 1e-12 * length(&taken), "{n}: the secant");
            let next = exact.times(&after);
            assert!(apart(&walk.stride, &next) < 1e-12 * length(&next), "{n}: the stride after it");
        }
    }

    /// Truth: on a map with a bend the method comes nearer by ever larger factors, and ends where the map stands still.
    #[test]
    fn a_bent_map_takes_some_strides() {
        let map =
            |x: &[f64]| vec![0.3 * x[0] + 0.2 * x[1] * x[1] + 0.05, 0.4 * x[1] - 0.3 * x[0] * x[1] + 0.1];
        let slope = Matrix(2, vec![0.3, 0.0, 0.0, 0.4]);
        let undoes = Matrix::new(2, |i, j| unit(i, j) - slope.1[j * 2 + i]).inverse();
        let mut walk = Walk::<f64>::new(&[0.1, 0.15], &undoes);
        let mut rounds = 0;
        let phase = loop {
            rounds += 1;
            match walk.step(&map(&walk.place), true) {
                Phase::On if rounds < 8 => {}
                phase => break phase,
            }
        };
        assert_eq!(phase, Phase::Found);
        assert!((2..=5).contains(&rounds), "{rounds} periods");
        assert!(apart(&map(&walk.place), &walk.place) < 1e-6, "{:?}", walk.place);
    }

    #[test]
    fn what_leads_nowhere_is_lost_and_left_as_it_is() {
        let undoes = Matrix::new(4, unit);
        let place = [0.1, 0.2, 0.3, 0.4];
        let far = place.map(|value| value + 0.2);
        for (end, sound) in [(far, true), (place, false), ([f64::NAN; 4], true), ([f64::INFINITY; 4], true)] {
            let mut walk = Walk::<f64>::new(&place, &undoes);
            assert_eq!(walk.step(&end, sound), Phase::Lost, "{end:?}");
            assert_eq!((walk.place, walk.undoes), (place.to_vec(), undoes.1.clone()));
        }
        // As near as may be, but the bound on the distance is too large.
        let mut steep = undoes.clone();
        steep.1[15] = 1e3;
        let end = [0.1 + 1e-7, 0.2, 0.3, 0.4];
        assert_eq!(Walk::<f64>::new(&place, &undoes).step(&end, true), Phase::Found);
        assert_eq!(Walk::<f64>::new(&place, &steep).step(&end, true), Phase::On);
        // Larger than any state.
        let long = vec![0.0; 50];
        assert_eq!(Walk::<f64>::new(&long, &Matrix::new(50, unit)).step(&long, true), Phase::Lost);
    }

    #[test]
    fn states_have_the_next_larger_number_of_modes() {
        assert_eq!([1, 4, 5, 7, 9, 17, 24].map(state_modes), [1, 4, 6, 8, 12, 24, 24]);
    }
}

//! One drive period, and the slope of where it ends by where it begins.
//!
//! A kick depends on the tip's indentation, speed and acceleration alone, and on the law's memory, if it has one, which is the
//! last mode. Between kicks the slope flows as the modes do.
//! So the period is stepped as ever and what each kick is given is written down; then the kicks' own slopes are worked out,
//! many side by side whichever instance and step they are of, and last each instance's slope is carried through those of its
//! steps in which the law acts.

use super::Lane;
use super::WRITTEN_OUT;
use super::constants::{ONE, ZERO};
use super::contact::{Approach, Interaction};
use super::dual::Dual;
use super::sample::Wave;
use super::step::{Case, State};

/// Rows that a step leaves: indentation, speed and acceleration before the kick, contact before it, and what it did: the size
/// of its impulse and the share of the step in contact.
const SEEN: usize = 6;

/// The same, followed by the memory of a law that has one.
pub(crate) const fn seen_rows(memory: bool) -> usize {
    if memory { SEEN + 2 } else { SEEN }
}

/// What a kick changes by with each number of its approach: the impulse's three, then the shift's.
pub(crate) const PARTIALS: usize = 6;

/// The same, followed by what impulse and shift change by with the law's memory, two each, and by what the kick's own changes
/// of the memory change by, five each: with the numbers of the approach, and with the memory.
pub(crate) const PARTIALS_WITH_MEMORY: usize = PARTIALS + 4 + 10;

const fn partial_rows(memory: bool) -> usize {
    if memory { PARTIALS_WITH_MEMORY } else { PARTIALS }
}

/// One drive period from steady free motion, of whose steps `seen` are rows.
pub(crate) fn seen_period<L: Lane, I: Interaction<L>, const M: usize>(
    case: &Case<L, I, M>,
    state: &mut State<L, M>,
    waves: &[Wave<L::Element>],
    seen: &mut [L::Element],
) {
    L::run(
        #[inline(always)]
        || {
            // As in `each_step`.
            std::hint::black_box(&L::splat(ZERO));
            let mut here = *state;
            for (step, wave) in waves.iter().enumerate() {
                let count = seen_rows(I::MEMORY) * L::WIDTH;
                let rows = &mut seen[step * count..][..count];
                here.touching.store(&mut rows[3 * L::WIDTH..]);
                let (at, kick) = case.kicked(&mut here, *wave);
                at.indentation.store(rows);
                at.speed.store(&mut rows[L::WIDTH..]);
                at.acceleration.store(&mut rows[2 * L::WIDTH..]);
                kick.impulse.abs().store(&mut rows[4 * L::WIDTH..]);
                kick.contact.store(&mut rows[5 * L::WIDTH..]);
                if I::MEMORY {
                    at.memory[0].store(&mut rows[SEEN * L::WIDTH..]);
                    at.memory[1].store(&mut rows[(SEEN + 1) * L::WIDTH..]);
                }
            }
            *state = here;
        },
    );
}

/// The partials of the kicks of a period that was seen, of those steps in which the law acts in some lane: `steps` are these,
/// and `out` rows of [`PARTIALS`] or [`PARTIALS_WITH_MEMORY`] for each of them. `laws` are rows of the law's constants.
///
/// Out of contact a kick that changes by less than `little` of the way from step to step is left out.
pub(crate) fn partials<L: Lane, I: Interaction<Dual<L>>>(
    (laws, little): (&[L::Element], &[L::Element]),
    seen: &[L::Element],
    steps: &mut Vec<u32>,
    out: &mut Vec<L::Element>,
) {
    let (rows, partials) = (seen_rows(I::MEMORY) * L::WIDTH, partial_rows(I::MEMORY) * L::WIDTH);
    let count = seen.len() / rows;
    steps.clear();
    out.resize(count * partials, L::element(ZERO));
    L::run(
        #[inline(always)]
        || {
            let (zero, little) = (L::splat(ZERO), L::load(little));
            let mut numbers = laws.chunks_exact(L::WIDTH);
            let law = I::from_numbers(|| Dual::constant(numbers.next().map_or(zero, L::load)));
            let mut left = out.chunks_exact_mut(partials);
            for step in 0..count {
                let here = &seen[step * rows..][..rows];
                let steep = either_steep::<L>((seen, rows), step, count, little);
                let (size, contact) = (row::<L>(here, 4), row::<L>(here, 5));
                let acts = L::either(zero.less(contact), L::both(zero.less(size), steep));
                if !L::any(acts) {
                    continue;
                }
                let at = Approach {
                    indentation: Dual::own(row(here, 0), 0),
                    speed: Dual::own(row(here, 1), 1),
                    acceleration: Dual::own(row(here, 2), 2),
                    memory: memory::<L, I>(here).map(Dual::constant),
                };
                let touching = Dual::constant(row(here, 3));
                let kick = law.kick(at, touching);
                let Some(to) = left.next() else { break };
                let mut put = |n: usize, by: L| L::select(acts, by, zero).store(&mut to[n * L::WIDTH..]);
                steps.push(step as u32);
                for n in 0..3 {
                    put(n, kick.impulse.by[n]);
                    put(3 + n, kick.shift.by[n]);
                }
                if !I::MEMORY {
                    continue;
                }
                let by_memory = law.kick(by_memory(at), touching);
                for n in 0..2 {
                    put(PARTIALS + n, by_memory.impulse.by[n]);
                    put(PARTIALS + 2 + n, by_memory.shift.by[n]);
                    let own = PARTIALS + 4 + 5 * n;
                    (0..3).for_each(|m| put(own + m, kick.memory[n].by[m]));
                    (0..2).for_each(|m| put(own + 3 + m, by_memory.memory[n].by[m]));
                }
            }
        },
    );
}

/// The same approach, of which the memory alone counts as what derivatives are by.
#[inline(always)]
fn by_memory<L: Lane>(at: Approach<Dual<L>>) -> Approach<Dual<L>> {
    Approach {
        indentation: Dual::constant(at.indentation.value),
        speed: Dual::constant(at.speed.value),
        acceleration: Dual::constant(at.acceleration.value),
        memory: [Dual::own(at.memory[0].value, 0), Dual::own(at.memory[1].value, 1)],
    }
}

/// What a law remembered before a step that was seen.
#[inline(always)]
fn memory<L: Lane, I: Interaction<Dual<L>>>(here: &[L::Element]) -> [L; 2] {
    if I::MEMORY { [row(here, SEEN), row(here, SEEN + 1)] } else { [L::splat(ZERO); 2] }
}

#[inline(always)]
fn row<L: Lane>(rows: &[L::Element], n: usize) -> L {
    L::load(&rows[n * L::WIDTH..])
}

/// Whether a kick's size changes by as much as `little` of the way, from the step before to this one or to the next.
#[inline(always)]
fn either_steep<L: Lane>(
    (seen, rows): (&[L::Element], usize),
    step: usize,
    count: usize,
    little: L,
) -> L::Mask {
    let here = &seen[step * rows..][..rows];
    let last = &seen[(step.max(1) - 1) * rows..][..rows];
    let next = &seen[(step + 1).min(count - 1) * rows..][..rows];
    L::not(L::both(flat(here, last, little), flat(here, next, little)))
}

#[inline(always)]
fn flat<L: Lane>(a: &[L::Element], b: &[L::Element], little: L) -> L::Mask {
    let (change, way): (L, L) = (row::<L>(a, 4) - row(b, 4), row::<L>(a, 0) - row(b, 0));
    change.abs().less(little * way.abs())
}

/// An instance's kicks that may have a slope.
#[derive(Clone, Copy)]
pub(crate) struct Events<'a, E> {
    /// Their steps.
    pub steps: &'a [u32],
    /// Rows of the kicks' partials, so many numbers wide: for each step, or for as many of them as a row has numbers.
    pub partials: &'a [E],
    pub width: usize,
    /// The instance's place in a row; none where it has all of them.
    pub lane: Option<usize>,
}

impl<E: Copy + Into<f64>> Events<'_, E> {
    /// The n-th kick's partials; none where it is another instance's alone.
    #[inline(always)]
    fn own<const N: usize>(&self, n: usize) -> Option<[E; N]> {
        let (pack, lane) = match self.lane {
            Some(lane) => (n, lane),
            None => (n / self.width, n % self.width),
        };
        let rows = &self.partials[pack * N * self.width..][..N * self.width];
        let mut by = [rows[lane]; N];
        let mut some = false;
        for (row, value) in by.iter_mut().enumerate() {
            *value = rows[row * self.width + lane];
            some |= (*value).into() != 0.0;
        }
        some.then_some(by)
    }
}

/// A lever's constants, field after field, as [`super::Lever::motion`] has them.
#[derive(Clone, Copy)]
struct Fields<'a, E> {
    motion: &'a [E],
    modes: usize,
}

impl<E: Copy> Fields<'_, E> {
    #[inline(always)]
    fn of<L: Lane<Element = E>>(&self, field: usize, k: usize) -> L {
        L::broadcast(self.motion[field * self.modes + k])
    }
}

/// Places of the fields.
const FLOW: [usize; 3] = [0, 1, 2];
const RATE: usize = 3;
const PULL: usize = 4;
const DRAG: usize = 5;
const LAND: [usize; 2] = [6, 7];
const SHIFT: [usize; 2] = [8, 9];

/// Numbers from one row of a slope to the next.
pub(crate) fn stride<L: Lane>(modes: usize) -> usize {
    (2 * modes).next_multiple_of(L::WIDTH)
}

/// Carries the slope of an instance whose lever has the constants `motion` and [`powers`], of so many modes, through a period
/// of `steps`, and puts it down in rows of the travels, then of the rates, each filled up to whole lanes. The lanes are columns
/// of the slope.
///
/// Of each kick there are N partials.
pub(crate) fn carry<L: Lane, const M: usize, const N: usize>(
    (motion, flows): (&[L::Element], &[[L::Element; 3]]),
    modes: usize,
    steps: u32,
    events: Events<L::Element>,
    slope: &mut Vec<L::Element>,
) {
    let stride = stride::<L>(modes);
    slope.resize(2 * modes * stride, L::element(ZERO));
    L::run(
        #[inline(always)]
        || {
            let lever = Fields { motion, modes };
            for first in (0..stride).step_by(L::WIDTH) {
                let mut columns = Columns::<L, M>::first(modes, first);
                let mut here = 0;
                for (n, step) in events.steps.iter().enumerate() {
                    let Some(by) = events.own::<N>(n) else { continue };
                    columns.fly(flows, step - here);
                    columns.kick(&lever, &by);
                    here = step + 1;
                }
                columns.fly(flows, steps - here);
                for k in 0..columns.count {
                    columns.x[k].store(&mut slope[k * stride + first..]);
                    columns.u[k].store(&mut slope[(modes + k) * stride + first..]);
                }
            }
        },
    );
}

/// Increments over 1, 2, 4, ... steps, up to so many: m00, m01, m11 of each mode. One number, not a lane.
pub fn powers<E: Lane<Element = E>>(motion: &[E], modes: usize, steps: u32, all: &mut Vec<[E; 3]>) {
    all.clear();
    all.extend((0..modes).map(|k| FLOW.map(|field| motion[field * modes + k])));
    while all.len() < (u32::BITS - steps.leading_zeros()) as usize * modes {
        let [a, b, d] = all[all.len() - modes];
        // (1 + m)^2 - 1, where the rates take from the travels what these give them.
        let cross = b.mul_add(d, b.mul_add(a, b + b));
        all.push([(-b).mul_add(b, a.mul_add(a, a + a)), cross, (-b).mul_add(b, d.mul_add(d, d + d))]);
    }
}

/// Columns of a slope, one a lane: travels and rates of the modes.
struct Columns<L, const M: usize> {
    x: [L; M],
    u: [L; M],
    count: usize,
}

/// Where a mode is after some steps, by their increments.
#[inline(always)]
fn flown<L: Lane>([m00, m01, m11]: [L; 3], x: L, u: L) -> (L, L) {
    (m01.mul_add(u, m00.mul_add(x, x)), m11.mul_add(u, (-m01).mul_add(x, u)))
}

impl<L: Lane, const M: usize> Columns<L, M> {
    /// The columns from `first` on before the first step.
    #[inline(always)]
    fn first(modes: usize, first: usize) -> Self {
        let zero = L::splat(ZERO);
        let count = if M <= WRITTEN_OUT { M } else { modes.min(M) };
        let mut columns = Self { x: [zero; M], u: [zero; M], count };
        for k in 0..count {
            columns.x[k] = unit(k, first);
            columns.u[k] = unit(modes + k, first);
        }
        columns
    }

    /// So many steps without a kick.
    #[inline(always)]
    fn fly(&mut self, flows: &[[L::Element; 3]], steps: u32) {
        let mut left = steps;
        while left > 0 {
            let flow = &flows[left.trailing_zeros() as usize * self.count..][..self.count];
            left &= left - 1;
            for (k, [a, b, d]) in flow.iter().enumerate() {
                let over = [L::broadcast(*a), L::broadcast(*b), L::broadcast(*d)];
                (self.x[k], self.u[k]) = flown(over, self.x[k], self.u[k]);
            }
        }
    }

    /// A kick and the flow to the next sample.
    #[inline(always)]
    fn kick<const N: usize>(&mut self, lever: &Fields<L::Element>, by: &[L::Element; N]) {
        // How the approach changes: indentation and speed into the sample are the opposites of the tip's motion.
        let zero = L::splat(ZERO);
        let (mut travel, mut speed, mut pulled, mut dragged) = (zero, zero, zero, zero);
        // The law's memory moves no tip.
        let swinging = if N > PARTIALS { self.count - 1 } else { self.count };
        for k in 0..swinging {
            travel = travel - self.x[k];
            speed = (-lever.of::<L>(RATE, k)).mul_add(self.u[k], speed);
            pulled = (-lever.of::<L>(PULL, k)).mul_add(self.x[k], pulled);
            dragged = (-lever.of::<L>(DRAG, k)).mul_add(self.u[k], dragged);
        }
        let acceleration = pulled + dragged;
        let by = |n: usize| L::broadcast(by[n]);
        let mut impulse = by(0).mul_add(travel, by(1).mul_add(speed, by(2) * acceleration));
        let (mut of_memory, mut remembered) = (zero, [zero; 2]);
        if N > PARTIALS {
            let (x, u) = (self.x[swinging], self.u[swinging]);
            impulse = by(6).mul_add(x, by(7).mul_add(u, impulse));
            of_memory = by(8).mul_add(x, by(9) * u);
            remembered = [10, 15].map(|n| {
                let held = by(n + 3).mul_add(x, by(n + 4) * u);
                by(n).mul_add(travel, by(n + 1).mul_add(speed, by(n + 2).mul_add(acceleration, held)))
            });
        }
        for k in 0..self.count {
            let step = [lever.of(FLOW[0], k), lever.of(FLOW[1], k), lever.of(FLOW[2], k)];
            let (x, u) = flown(step, self.x[k], self.u[k]);
            self.x[k] = lever.of::<L>(LAND[0], k).mul_add(impulse, x);
            self.u[k] = lever.of::<L>(LAND[1], k).mul_add(impulse, u);
        }
        let mut size = by(3).abs() + by(4).abs() + by(5).abs();
        if N > PARTIALS {
            size = size + (by(8).abs() + by(9).abs());
        }
        if L::any(zero.less(size)) {
            let mut shift = by(3).mul_add(travel, by(4).mul_add(speed, by(5) * acceleration));
            if N > PARTIALS {
                shift = shift + of_memory;
            }
            for k in 0..self.count {
                self.x[k] = lever.of::<L>(SHIFT[0], k).mul_add(shift, self.x[k]);
                self.u[k] = lever.of::<L>(SHIFT[1], k).mul_add(shift, self.u[k]);
            }
        }
        if N > PARTIALS {
            self.x[swinging] = self.x[swinging] + remembered[0];
            self.u[swinging] = self.u[swinging] + remembered[1];
        }
    }
}

/// 1 in the column of this number, of those from `first` on, and 0 in the others.
#[inline(always)]
fn unit<L: Lane>(number: usize, first: usize) -> L {
    let mut places = [L::element(ZERO); WIDEST];
    if number >= first && number < first + L::WIDTH {
        places[number - first] = L::element(ONE);
    }
    L::load(&places)
}

/// Most numbers of a lane.
const WIDEST: usize = 16;

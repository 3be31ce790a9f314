//! ode_solvers' Dopri5 and Dop853. It has no root finding: where JKR's memory changes within an accepted step, the
//! run is stopped, the place is found on the quintic between the step's ends, the solver goes there from the step's
//! beginning, and starts anew from there.
//!
//! Dop853 of version 0.6.2 takes its twelfth stage at the step's beginning (`C[11]` of its `butcher_tableau.rs` is 0 in place
//! of 1), which makes it of first order where time stands in the equations. It gets the angle as one more unknown, which
//! mends that.

use crate::answer::{Answer, Place};
use crate::measure::LONGEST;
use crate::problem::Reduced;
use crate::walk::{Equations, MEASURING, STATE, Seen};
use ode_solvers::dop_shared::OutputType;
use ode_solvers::{Dop853, Dopri5, SVector, System};
use std::cell::Cell;

/// Most steps of one integration.
const MOST: u32 = 50_000_000;

/// Which method.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    Dopri5,
    Dop853,
}

/// The instances' answers, and the mean of steps per period; none where the solver gives up.
pub fn run(
    reduced: &Reduced,
    instances: &[usize],
    method: Method,
    tolerance: f64,
) -> (Vec<Option<Answer>>, f64) {
    let mut steps = 0;
    let answers = instances
        .iter()
        .map(|&instance| {
            let walk = Walk::new(Equations::of(reduced, instance));
            let answer = walk.whole(method, tolerance);
            steps += walk.seen.get().steps;
            answer
        })
        .collect();
    (answers, steps as f64 / (instances.len() as f64 * f64::from(reduced.periods)))
}

struct Walk<'a> {
    equations: Equations<'a>,
    seen: Cell<Seen>,
    /// Angle and place of the last accepted step.
    last: Cell<(f64, Place)>,
    /// Where the memory changes, once it is known.
    crossing: Cell<Option<f64>>,
    /// On the way to a crossing nothing is looked at.
    landing: Cell<bool>,
}

/// What the solver takes.
struct Rates<'w, 'a>(&'w Walk<'a>);

impl<const N: usize> System<f64, SVector<f64, N>> for Rates<'_, '_> {
    fn system(&self, theta: f64, y: &SVector<f64, N>, out: &mut SVector<f64, N>) {
        let walk = self.0;
        let body = body(N);
        let theta = if body < N { y[body] } else { theta };
        let touching = walk.seen.get().touching;
        walk.equations.rates(theta, &y.as_slice()[..body], touching, &mut out.as_mut_slice()[..body]);
        out.as_mut_slice()[body..].fill(1.0);
    }

    fn solout(&mut self, theta: f64, y: &SVector<f64, N>, rates: &SVector<f64, N>) -> bool {
        self.0.accepted(theta, y.as_slice(), rates.as_slice())
    }
}

/// Unknowns without the angle.
fn body(unknowns: usize) -> usize {
    if unknowns < MEASURING { STATE } else { MEASURING }
}

impl<'a> Walk<'a> {
    fn new(equations: Equations<'a>) -> Self {
        Self {
            equations,
            seen: Cell::new(Seen::new()),
            last: Cell::new((0.0, [0.0; 3])),
            crossing: Cell::new(None),
            landing: Cell::new(false),
        }
    }

    fn accepted(&self, theta: f64, y: &[f64], rates: &[f64]) -> bool {
        if self.landing.get() {
            return false;
        }
        let (before, from) = self.last.get();
        let to = self.equations.place(theta, y, rates);
        let mut seen = self.seen.get();
        let crossing = seen.crossing(&self.equations, theta - before, &from, &to);
        if let Some(share) = crossing {
            self.crossing.set(Some(before + share * (theta - before)));
            return true;
        }
        seen.step(&self.equations, theta - before, &from, &to);
        self.seen.set(seen);
        self.last.set((theta, to));
        false
    }

    fn whole(&self, method: Method, tolerance: f64) -> Option<Answer> {
        match method {
            Method::Dopri5 => self.both::<STATE, MEASURING>(method, tolerance),
            Method::Dop853 => self.both::<{ STATE + 1 }, { MEASURING + 1 }>(method, tolerance),
        }
    }

    fn both<const N: usize, const M: usize>(&self, method: Method, tolerance: f64) -> Option<Answer> {
        let (begin, end) = self.equations.span();
        let warm = self.to::<N>(method, tolerance, 0.0, begin, SVector::zeros())?;
        self.seen.set(Seen { measuring: true, ..self.seen.get() });
        let mut state = SVector::<f64, M>::zeros();
        state.as_mut_slice()[..STATE].copy_from_slice(&warm.as_slice()[..STATE]);
        state.as_mut_slice()[MEASURING..].fill(begin);
        let state = self.to::<M>(method, tolerance, begin, end, state)?;
        Some(self.equations.answer(state.as_slice(), self.seen.get().force_max))
    }

    /// From one angle to another, over every change of the memory.
    fn to<const N: usize>(
        &self,
        method: Method,
        tolerance: f64,
        mut theta: f64,
        end: f64,
        mut y: SVector<f64, N>,
    ) -> Option<SVector<f64, N>> {
        loop {
            self.note(theta, &y);
            let (before, next) = self.integrate(method, tolerance, theta, end, y)?;
            let Some(at) = self.crossing.take() else { return Some(next) };
            let from = self.last.get().0;
            y = before;
            if at > from {
                self.landing.set(true);
                let landed = self.integrate(method, tolerance, from, at, before);
                self.landing.set(false);
                y = landed?.1;
                self.note_step(from, at, &y);
            }
            theta = at;
            let mut seen = self.seen.get();
            seen.touching = !seen.touching;
            self.seen.set(seen);
        }
    }

    /// The place where an integration begins.
    fn note<const N: usize>(&self, theta: f64, y: &SVector<f64, N>) {
        let mut rates = SVector::<f64, N>::zeros();
        let (y, body) = (y.as_slice(), body(N));
        let touching = self.seen.get().touching;
        self.equations.rates(theta, &y[..body], touching, &mut rates.as_mut_slice()[..body]);
        self.last.set((theta, self.equations.place(theta, y, rates.as_slice())));
    }

    /// The part of a step before the memory changes.
    fn note_step<const N: usize>(&self, from: f64, at: f64, y: &SVector<f64, N>) {
        let begin = self.last.get().1;
        self.note(at, y);
        let mut seen = self.seen.get();
        seen.step(&self.equations, at - from, &begin, &self.last.get().1);
        self.seen.set(seen);
    }

    /// The last state but one and the last state of an integration.
    fn integrate<const N: usize>(
        &self,
        method: Method,
        tolerance: f64,
        from: f64,
        to: f64,
        y: SVector<f64, N>,
    ) -> Option<(SVector<f64, N>, SVector<f64, N>)> {
        let rates = Rates(self);
        let longest = LONGEST.min(to - from);
        // Safety factor, beta and the limits of a step's growth are the library's defaults; no test for stiffness.
        match method {
            Method::Dopri5 => {
                let mut solver = Dopri5::from_param(
                    rates,
                    from,
                    to,
                    1.0,
                    y,
                    tolerance,
                    tolerance,
                    0.9,
                    0.04,
                    0.2,
                    10.0,
                    longest,
                    0.0,
                    MOST,
                    u32::MAX,
                    OutputType::Sparse,
                );
                solver.integrate().ok()?;
                tail(solver.y_out())
            }
            Method::Dop853 => {
                let mut solver = Dop853::from_param(
                    rates,
                    from,
                    to,
                    1.0,
                    y,
                    tolerance,
                    tolerance,
                    0.9,
                    0.0,
                    0.333,
                    6.0,
                    longest,
                    0.0,
                    MOST,
                    u32::MAX,
                    OutputType::Sparse,
                );
                solver.integrate().ok()?;
                tail(solver.y_out())
            }
        }
    }
}

fn tail<V: Copy>(states: &[V]) -> Option<(V, V)> {
    match states {
        [.., before, last] => Some((*before, *last)),
        _ => None,
    }
}

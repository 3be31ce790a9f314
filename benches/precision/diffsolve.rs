//! diffsol's Tsitouras 4(5), the only explicit method it comes with, with its own root finding for JKR's memory.

use crate::answer::{Answer, Place};
use crate::measure::LONGEST;
use crate::problem::Reduced;
use crate::walk::{Equations, Kind, MEASURING, STATE, Seen};
use diffsol::{
    DiffsolError, NalgebraMat, OdeBuilder, OdeEquations, OdeSolverMethod, OdeSolverProblem,
    OdeSolverStopReason, Vector, VectorCommon,
};
use std::cell::Cell;

/// The instances' answers, and the mean of steps per period; none where the solver gives up.
pub fn run(reduced: &Reduced, instances: &[usize], tolerance: f64) -> (Vec<Option<Answer>>, f64) {
    let mut steps = 0;
    let answers = instances
        .iter()
        .map(|&instance| {
            let walk = Walk { equations: Equations::of(reduced, instance), touching: Cell::new(false) };
            let mut seen = Seen::new();
            let answer = walk.whole(tolerance, &mut seen).ok();
            steps += seen.steps;
            answer
        })
        .collect();
    (answers, steps as f64 / (instances.len() as f64 * f64::from(reduced.periods)))
}

struct Walk<'a> {
    equations: Equations<'a>,
    touching: Cell<bool>,
}

impl Walk<'_> {
    fn whole(&self, tolerance: f64, seen: &mut Seen) -> Result<Answer, DiffsolError> {
        let (begin, end) = self.equations.span();
        let warm = self.to(tolerance, 0.0, begin, &[0.0; STATE], seen)?;
        seen.measuring = true;
        let mut state = [0.0; MEASURING];
        state[..STATE].copy_from_slice(&warm);
        let state = self.to(tolerance, begin, end, &state, seen)?;
        Ok(self.equations.answer(&state, seen.force_max))
    }

    fn to(
        &self,
        tolerance: f64,
        from: f64,
        to: f64,
        start: &[f64],
        seen: &mut Seen,
    ) -> Result<Vec<f64>, DiffsolError> {
        let equations = self.equations;
        let builder = OdeBuilder::<NalgebraMat<f64>>::new()
            .t0(from)
            .h0(1e-3)
            .rtol(tolerance)
            .atol([tolerance])
            .rhs(|y, _, theta, out| equations.rates(theta, y, self.touching.get(), out))
            .init(|_, _, y| y.copy_from_slice(start), start.len());
        if equations.law != Kind::Jkr {
            return self.walk(&builder.build()?, to, seen);
        }
        let room = |y: &[f64], _: &[f64], theta: f64, out: &mut [f64]| {
            let travel = theta.cos() + y[0] + y[1] + y[2];
            out[0] = -(equations.sample.gap + travel) - equations.sample.level(self.touching.get());
        };
        self.walk(&builder.root(room, 1).build()?, to, seen)
    }

    fn walk<E>(
        &self,
        problem: &OdeSolverProblem<E>,
        to: f64,
        seen: &mut Seen,
    ) -> Result<Vec<f64>, DiffsolError>
    where
        E: OdeEquations<
                T = f64,
                M = NalgebraMat<f64>,
                V = diffsol::NalgebraVec<f64>,
                C = diffsol::NalgebraContext,
            >,
    {
        let mut solver = problem.tsit45()?;
        solver.set_stop_time(to)?;
        let (mut theta, mut from) = self.place(solver.state().t, solver.state().y.inner().as_slice());
        loop {
            let reason = solver.step()?;
            if let OdeSolverStopReason::RootFound(at, _) = reason {
                solver.state_mut_back(at)?;
            }
            let (at, place) = self.place(solver.state().t, solver.state().y.inner().as_slice());
            seen.step(&self.equations, at - theta, &from, &place);
            (theta, from) = (at, place);
            match reason {
                OdeSolverStopReason::TstopReached => return Ok(solver.state().y.inner().as_slice().to_vec()),
                OdeSolverStopReason::RootFound(..) => {
                    seen.touching = !seen.touching;
                    self.touching.set(seen.touching);
                    let y = solver.state().y.inner().as_slice().to_vec();
                    let state = solver.state_mut();
                    self.equations.rates(theta, &y, seen.touching, state.dy.inner_mut().as_mut_slice());
                    from = self.place(theta, &y).1;
                }
                OdeSolverStopReason::InternalTimestep => {}
            }
            if solver.state().h > LONGEST {
                *solver.state_mut().h = LONGEST;
            }
        }
    }

    fn place(&self, theta: f64, y: &[f64]) -> (f64, Place) {
        let mut rates = vec![0.0; y.len()];
        self.equations.rates(theta, y, self.touching.get(), &mut rates);
        (theta, self.equations.place(theta, y, &rates))
    }
}

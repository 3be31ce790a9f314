//! The reference engine: one instance at a time, f64, adaptive order 8, contact events located.
//!
//! It answers what the stepped engines' error is. It shares the instrument, the free motion and the laws'
//! parameters with them, and neither the stepping nor the forces: the deviation from free motion is integrated with
//! DOP853 (`tableau.rs`), the laws stand in forms of their own (`reference_law.rs`), every touch, release and turning
//! point is located (`step_control.rs`), and observables are integrals over the continuous path (`meter.rs`).

mod dop853;
mod indenter;
mod meter;
mod reference_fixed_point;
mod reference_force;
mod reference_jkr;
mod reference_law;
mod reference_neck;
mod reference_relaxing;
mod reference_viscous;
mod step_control;
mod system;
mod tableau;

pub use reference_fixed_point::solve_near;

use super::measurement::{finish_free, first_seen, fundamental, settled};
use super::{Engine, EngineError, Finished, Outcome, Progress, start};
use crate::observe::{HARMONICS, Measured, MeasuredSums, Status, Wants};
use crate::plan::{Case, Driven, Plan};
use crate::scene::Run;
use meter::Meter;
use nalgebra::Complex;
use rayon::prelude::*;
use reference_jkr::ReferenceJkr;
use reference_law::{NoForce, ReferenceDmt, ReferenceHertz, ReferenceShaped};
use reference_relaxing::ReferenceRelaxing;
use reference_viscous::ReferenceViscous;
use std::f64::consts::TAU;
use step_control::Integrator;
use system::System;

/// What the reference engine integrates.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Model {
    /// The instrument's own modes until less than 1e-6 of the tip's flexibility is left, and less than 1e-5 of it at the
    /// contact's rate among modes that are up to 16 times as fast or slower than one that stays; at least those that the plan
    /// keeps. Shows the error of reduction and steps together.
    #[default]
    Whole,
    /// The plan's oscillators: shows the error of the steps alone.
    Kept,
}

/// Error that a step may make, on the scales of the largest travel, force and energy met.
pub const TOLERANCE: f64 = 1e-12;

/// The reference engine.
#[derive(Clone, Copy, Debug)]
pub struct Reference {
    /// See [`TOLERANCE`]; from 1e-14 to 1e-3.
    pub tolerance: f64,
    pub model: Model,
}

impl Default for Reference {
    fn default() -> Self {
        Self { tolerance: TOLERANCE, model: Model::Whole }
    }
}

/// What an integration took.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Work {
    /// Steps taken, and tried in vain.
    pub accepted: u64,
    pub rejected: u64,
    /// Evaluations of the equations, each with one of the contact force.
    pub evaluations: u64,
    /// Touches and releases.
    pub events: u64,
    /// Oscillators integrated.
    pub modes: usize,
    /// Share of the tip's flexibility that none of them carries.
    pub left_out: f64,
}

impl Engine for Reference {
    fn device(&self) -> String {
        format!(
            "reference integrator, DOP853, tolerance {:e}, {}",
            self.tolerance,
            super::threads::described()
        )
    }

    fn kind(&self) -> String {
        // Its searches begin where the CPU engine's end.
        format!("reference {:e} beside {}", self.tolerance, super::Cpu::default().kind())
    }

    /// It takes a tenth of a second for an instance, or many.
    fn portions(&self) -> (usize, usize) {
        (256, 1)
    }

    fn resumes(&self) -> bool {
        false
    }

    fn run(&self, plan: &Plan, progress: &Progress) -> Result<Outcome, EngineError> {
        let one = |index| self.alone(plan, index, progress);
        let results = (0..plan.len()).into_par_iter().map(one).collect::<Result<_, EngineError>>()?;
        Ok(Outcome { results, ..Outcome::of(plan) })
    }
}

/// One instance of a plan by the reference engine, and what it took; for audits.
///
/// # Errors
/// An instance that the plan does not have, a tolerance out of range, a tip that no mode moves.
pub fn solve(plan: &Plan, instance: usize, options: &Reference) -> Result<(Finished, Work), EngineError> {
    options.instance(plan, instance, &Progress::default())
}

impl Reference {
    /// What [`Engine::run`] makes of one instance of a plan.
    ///
    /// # Errors
    /// As [`solve`], and a plan that begins at states.
    pub fn alone(&self, plan: &Plan, instance: usize, progress: &Progress) -> Result<Finished, EngineError> {
        match plan.starts {
            Some(_) => Err(EngineError::Starts),
            None => Ok(self.instance(plan, instance, progress)?.0),
        }
    }

    fn checked<'a>(&self, plan: &'a Plan, instance: usize) -> Result<(Case, &'a Driven), EngineError> {
        if !(1e-14..=1e-3).contains(&self.tolerance) {
            return Err(EngineError::Tolerance(self.tolerance));
        }
        if instance >= plan.len() {
            return Err(EngineError::NoInstance { instance, count: plan.len() });
        }
        Ok((plan.case(instance as u32), plan.driven(instance as u32)))
    }

    fn instance(
        &self,
        plan: &Plan,
        instance: usize,
        progress: &Progress,
    ) -> Result<(Finished, Work), EngineError> {
        let (case, driven) = self.checked(plan, instance)?;
        if case.steps == 0 {
            return Ok((finish_free(case.gap, driven, plan.wants), Work::default()));
        }
        let system = System::new(&case, driven, plan.run.start, self.model, None);
        if system.modes() == 0 {
            return Err(EngineError::NoModes);
        }
        let mut walk = Integrator::new(system, self.tolerance);
        let finished = integrate(&mut walk, (&plan.run, plan.wants), &case, driven, progress);
        Ok((finished, Work { modes: walk.system.modes(), left_out: walk.system.left_out, ..walk.work }))
    }
}

/// Goes through the run's periods and measures the last ones.
fn integrate(
    walk: &mut Integrator,
    (run, wants): (&Run, Wants),
    case: &Case,
    driven: &Driven,
    progress: &Progress,
) -> Finished {
    let warm = run.periods - run.measure;
    let seen = first_seen(run);
    let mut sums = Sums::new(wants);
    let mut last = (0.0, 0.0);
    let mut change: f64 = 0.0;
    for number in 0..run.periods {
        if progress.stopped() {
            return Finished::NOT_RUN;
        }
        let measured = number >= warm;
        if measured && wants.energy {
            walk.system.measuring = true;
        }
        let mut look = Meter::new(Wants::FUNDAMENTAL);
        let meter = if measured { &mut sums.meter } else { &mut look };
        meter.cosine = [0.0; HARMONICS];
        meter.sine = [0.0; HARMONICS];
        if !walk.period(number, (number >= seen).then_some(&mut *meter)) {
            return Finished { measured: Measured::NONE, status: Status::NonFinite };
        }
        progress.add(u64::from(case.steps));
        if number < seen {
            continue;
        }
        let now = (meter.cosine[0], meter.sine[0]);
        if number > seen || seen == 0 {
            change = change.max((now.0 - last.0).hypot(now.1 - last.1) / std::f64::consts::PI);
        }
        last = now;
        if measured {
            sums.close_period();
        }
    }
    let measured = sums.measured(walk, (run, wants), driven);
    let settled = settled(change, sums.meter.sums.begun, case.least_change, driven, run);
    // A graze that is shallower than the accuracy of lengths has no significant force.
    let graze = case.contact.law().elastic_force(run.accuracy * driven.free_amplitude());
    let force = graze.max(sums.hits.1.abs()).max(sums.meter.sums.weakest.abs());
    let alternates = sums.hits.1 - sums.hits.0 > run.accuracy * force;
    let status = if settled && !alternates { Status::Ok } else { Status::NotSteady };
    Finished { measured, status }
}

/// What is summed over the measured periods.
struct Sums {
    /// Its harmonics are those of the latest period.
    meter: Meter,
    /// Harmonics of all periods that are over.
    cosine: [f64; HARMONICS],
    sine: [f64; HARMONICS],
    /// Least and largest of the periods' largest forces, N.
    hits: (f64, f64),
}

impl Sums {
    fn new(wants: Wants) -> Self {
        let hits = (f64::INFINITY, f64::NEG_INFINITY);
        Self { meter: Meter::new(wants), cosine: [0.0; HARMONICS], sine: [0.0; HARMONICS], hits }
    }

    /// Takes in the harmonics and the largest force of the latest period.
    fn close_period(&mut self) {
        let hit = std::mem::replace(&mut self.meter.sums.strongest, f64::NEG_INFINITY);
        self.hits = (self.hits.0.min(hit), self.hits.1.max(hit));
        for n in 0..HARMONICS {
            self.cosine[n] += self.meter.cosine[n];
            self.sine[n] += self.meter.sine[n];
        }
    }

    /// The observables that are wanted, the walk being at the end of the last period.
    fn measured(&self, walk: &Integrator, (run, wants): (&Run, Wants), driven: &Driven) -> Measured {
        let span = TAU * f64::from(run.measure);
        let mut measured = Measured { gap: walk.system.gap, ..Measured::NONE };
        for n in 0..wants.harmonics {
            let travel = self.travel(n, run, driven);
            measured.harmonics[n] = travel.norm();
            if n == 0 {
                fundamental(&mut measured, travel, driven);
            }
        }
        let mut sums = self.meter.sums;
        if sums.apart == 0.0 {
            // Steps add up to a period but for rounding.
            sums.time = span;
        }
        if wants.energy {
            let n = walk.system.remembered();
            [sums.impulse, sums.work, sums.virial] = [walk.y[n], walk.y[n + 1], walk.y[n + 2]];
        }
        let (periods, bending) = (f64::from(run.measure), driven.free.bending);
        let summed = MeasuredSums { sums, periods, span, force: 1.0, length: 1.0, bending };
        measured.take_sums(Some(&summed), wants);
        if wants.extremes {
            (measured.force_min, measured.force_max) = (sums.weakest, self.hits.1);
            measured.indentation_max = if self.meter.touched { sums.deepest } else { f64::NAN };
        }
        measured
    }

    /// The tip's travel (m) at n + 1 times the drive's frequency, the free motion included.
    fn travel(&self, n: usize, run: &Run, driven: &Driven) -> Complex<f64> {
        let span = TAU * f64::from(run.measure);
        let free = if n == 0 { start::amplitudes(driven, run.start) } else { (0.0, 0.0) };
        let parts = (free.0 + 2.0 * self.cosine[n] / span, free.1 + 2.0 * self.sine[n] / span);
        start::phasor(parts.0, parts.1, n + 1, start::phase(driven, run.start))
    }
}

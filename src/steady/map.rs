//! The period map of some instances, on whatever engine there is.

use crate::engine::{Cpu, Engine, EngineError, Progress};
use crate::kernel::{MODES_MAX, increments};
use crate::plan::{Plan, Precision, Station};
use nalgebra::{Complex, DVector};
use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::Arc;

/// Takes instances of a plan from one place to where they are some periods later, in f64.
pub(super) struct PeriodMap<'a> {
    pub plan: &'a Plan,
    engine: &'a dyn Engine,
    /// In place of an engine that cannot compute in f64.
    cpu: Cpu,
    progress: &'a Progress,
    /// What the engine had to say.
    pub notes: Vec<String>,
}

impl<'a> PeriodMap<'a> {
    pub fn new(plan: &'a Plan, engine: &'a dyn Engine, progress: &'a Progress) -> Self {
        Self { plan, engine, cpu: Cpu::default(), progress, notes: Vec::new() }
    }

    /// Where each of `starts` (an instance and its place) is after `periods`; none where the run was stopped.
    pub fn after(
        &mut self,
        starts: Vec<(u32, Station)>,
        periods: u32,
    ) -> Result<Vec<Option<Station>>, EngineError> {
        let (instances, stations): (Vec<u32>, Vec<Station>) = starts.into_iter().unzip();
        let mut trial = self.plan.trial(&instances, periods, 1);
        trial.precision = Precision::F64;
        trial.stations = Some(Arc::new(stations));
        self.progress.foresee(trial.instance_steps());
        let engine: &dyn Engine = if self.engine.double() { self.engine } else { &self.cpu };
        let outcome = engine.run(&trial, self.progress)?;
        self.notes.extend(outcome.notes);
        Ok(outcome.ends.into_iter().map(|end| end.map(|end| *end)).collect())
    }

    /// At rest but for the modes that are not kept, with the sample just there: a swing that grows from nothing.
    pub fn still(&self, instance: u32) -> Station {
        let case = &self.plan.cases[instance as usize];
        let driven = &self.plan.drives[case.drive as usize];
        let free = &driven.free;
        // The run begins at the top of the free swing; stations stand half a step later.
        let angle = FRAC_PI_2 - free.tip.arg() + PI / f64::from(case.steps);
        let turn = Complex::from_polar(1.0, angle);
        let mut station = Station::FREE;
        for (k, mode) in driven.kept.modes.iter().enumerate().take(MODES_MAX) {
            let Some(index) = mode.index else { continue };
            let swing = free.modes[index] * turn * driven.instrument.modes[index].tip;
            (station.x[k], station.u[k]) = (-swing.im, -swing.re * free.omega / mode.omega);
        }
        let travel = free.tip.norm() * (PI / f64::from(case.steps)).cos() + station.x.iter().sum::<f64>();
        station.touching = case.contact.next_contact(-(case.gap + travel), false);
        station
    }

    /// A place met with `steps` steps a period as it is met with the instance's own: stations stand half a step
    /// into the period.
    pub fn with_own_steps(&self, instance: u32, station: &Station, steps: u32) -> Station {
        let case = &self.plan.cases[instance as usize];
        let driven = &self.plan.drives[case.drive as usize];
        let later = PI / driven.free.omega * (1.0 / f64::from(case.steps) - 1.0 / f64::from(steps));
        let mut moved = *station;
        for (k, mode) in driven.kept.modes.iter().enumerate() {
            let [m00, m01, m10, m11] = increments(mode.omega * later, mode.damping);
            let (x, u) = (station.x[k], station.u[k]);
            (moved.x[k], moved.u[k]) = (x + m00 * x + m01 * u, u + m10 * x + m11 * u);
        }
        moved
    }
}

/// Travel and rate of each mode, one after the other.
pub(super) fn vector(station: &Station, modes: usize) -> DVector<f64> {
    DVector::from_iterator(2 * modes, station.x[..modes].iter().chain(&station.u[..modes]).copied())
}

/// The other way.
pub(super) fn station(vector: &DVector<f64>, touching: bool) -> Station {
    let modes = vector.len() / 2;
    let mut station = Station { touching, ..Station::FREE };
    for k in 0..modes {
        (station.x[k], station.u[k]) = (vector[k], vector[modes + k]);
    }
    station
}

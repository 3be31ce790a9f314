//! Spectra of chosen instances: harmonics of the drive in one steady period.
//!
//! The fundamental of the travel is that of the observables, computed from samples. Any other harmonic follows from the same
//! harmonic of the force, because the instrument is linear: `X_n = C(n omega) F_n`. `C` contains all modes, even those that
//! the steps leave out because the force hardly excites them.

use super::waveforms::gathered;
use crate::control::JournaledRun;
use crate::engine::{EngineError, lag, trace};
use crate::instrument::MotionPlace;
use crate::orbit::OrbitTable;
use crate::plan::{Driven, Plan, STEPS_MIN, SectionState};
use crate::store::Spectra;
use nalgebra::Complex;
use rayon::prelude::*;
use std::f64::consts::{PI, TAU};

/// Most harmonics of an instance.
const MAX_HARMONIC: u32 = 1024;

/// Computes the spectra of these instances of a plan that ran. `found` has the periodic states by instance. Without a state,
/// the spectrum is that of the run's last period.
///
/// # Errors
/// Those of the engine.
pub fn spectra(plan: &Plan, found: &OrbitTable, instances: &[usize]) -> Result<Spectra, EngineError> {
    let places: Vec<u32> = instances.iter().map(|&instance| instance as u32).collect();
    spectra_of((plan, found), &places, instances)
}

/// Computes the [`spectra`] of a run.
///
/// # Errors
/// Those of the engine.
pub fn spectra_of_run(run: &JournaledRun, instances: &[usize]) -> Result<Spectra, EngineError> {
    let (some, places) = gathered(run, instances)?;
    spectra_of((&some.plan, &some.found), &places, instances)
}

fn spectra_of(
    (plan, found): (&Plan, &OrbitTable),
    places: &[u32],
    instances: &[usize],
) -> Result<Spectra, EngineError> {
    let all: Vec<Vec<Harmonic>> = places
        .par_iter()
        .map(|&i| {
            let place = found.get(i as usize);
            harmonics(plan, i, place.as_ref().map(|place| &place.section))
        })
        .collect::<Result<_, EngineError>>()?;
    let most = all.iter().map(Vec::len).max().unwrap_or(0);
    let rows = |value: fn(&Harmonic) -> f64| -> Vec<Vec<f64>> {
        let row = |one: &Vec<Harmonic>| {
            let mut row: Vec<f64> = one.iter().map(value).collect();
            row.resize(most, f64::NAN);
            row
        };
        all.iter().map(row).collect()
    };
    let frequency = |&i: &u32| {
        let first = plan.driven(i).free.omega / TAU;
        (1..=most).map(|n| n as f64 * first).collect()
    };
    Ok(Spectra {
        instances: instances.iter().map(|&instance| instance as u64).collect(),
        frequency: places.iter().map(frequency).collect(),
        tip_amplitude: rows(|one| one.tip.norm()),
        tip_phase: rows(|one| phase(one.tip)),
        deflection_amplitude: rows(|one| one.deflection.norm()),
        deflection_phase: rows(|one| phase(one.deflection)),
        force_amplitude: rows(|one| one.force.norm()),
        force_phase: rows(|one| phase(one.force)),
    })
}

/// Phasors of one harmonic, relative to that multiple of the drive's phase: `z = Im(Z exp(i n (omega t)))`.
struct Harmonic {
    tip: Complex<f64>,
    deflection: Complex<f64>,
    force: Complex<f64>,
}

/// Lag of a phasor, degree. NaN for zero.
fn phase(phasor: Complex<f64>) -> f64 {
    if phasor.norm() == 0.0 { f64::NAN } else { lag(phasor.arg()) }
}

/// Harmonics of an instance, up to a quarter of its steps.
fn harmonics(plan: &Plan, instance: u32, from: Option<&SectionState>) -> Result<Vec<Harmonic>, EngineError> {
    let driven = plan.driven(instance);
    let steps = plan.steps(instance);
    let orders = 1..=(steps.max(STEPS_MIN) / 4).min(MAX_HARMONIC);
    if steps == 0 {
        let none = Complex::new(0.0, 0.0);
        return Ok(orders
            .map(|n| harmonic(driven, n, if n == 1 { driven.free.tip } else { none }, none))
            .collect());
    }
    let periods = if from.is_some() { 1 } else { plan.run.periods };
    let trace = trace(plan, instance as usize, from, periods, 1)?;
    let turns: Vec<Complex<f64>> =
        (0..2 * steps).map(|k| Complex::from_polar(1.0, -PI * f64::from(k) / f64::from(steps))).collect();
    let one = |n: u32| {
        let [mut travel, mut mean, mut moment] = [Complex::new(0.0, 0.0); 3];
        for (j, sample) in (0u64..).zip(&trace.samples) {
            // Whole numbers keep the angle exact for any harmonic.
            let turn = turns[((u64::from(n) * (2 * j + 1)) % u64::from(2 * steps)) as usize];
            travel += turn * sample.travel;
            mean += turn * sample.force;
            moment += turn * sample.moment;
        }
        let own = Complex::from_polar(2.0 / f64::from(steps), -f64::from(n) * trace.phase) * Complex::i();
        // The mean over a step reduces the harmonic, and a force that acts late in its step lags.
        let half = PI * f64::from(n) / f64::from(steps);
        let force = mean * (half / half.sin()) + moment * Complex::new(0.0, -2.0 * half);
        harmonic(driven, n, travel * own, force * own)
    };
    Ok(orders.map(one).collect())
}

/// The fundamental has this travel; any other harmonic follows from the force.
fn harmonic(driven: &Driven, n: u32, travel: Complex<f64>, force: Complex<f64>) -> Harmonic {
    if n == 1 {
        return Harmonic { tip: travel, deflection: driven.free.deflection(travel), force };
    }
    let follows = |place| driven.instrument.follows(place, f64::from(n) * driven.free.omega);
    let (tip, top) = (follows(MotionPlace::Tip), follows(MotionPlace::Top));
    Harmonic { tip: tip * force, deflection: (tip - top) * force, force }
}

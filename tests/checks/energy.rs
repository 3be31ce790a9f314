//! Where the drive's work goes, from the contact force's harmonics and the instrument's exact
//! linear response to each of them: nothing of the stepping enters but the force itself.

use afmsweep::engine::{TraceSample, trace};
use afmsweep::plan::{Driven, Plan};
use nalgebra::Complex;
use std::f64::consts::{PI, TAU};

/// J per period.
#[derive(Clone, Copy, Debug)]
pub struct Balance {
    /// Work of the drive.
    pub drive: f64,
    /// Losses in all modes of the instrument.
    pub modes: f64,
    /// Work that the contact force takes out of the free motion, and the losses of the motion that
    /// it excites beside it: their difference is the sample's loss in any linear instrument,
    /// one whose rod does not feel its lever included.
    pub taken: f64,
    pub excited: f64,
}

/// The sums over n of `values[n] exp(-2 pi i m n / N)`, by halves as long as these are whole.
fn transform(values: &[Complex<f64>]) -> Vec<Complex<f64>> {
    let count = values.len();
    let turn = |m: usize| Complex::from_polar(1.0, -TAU * m as f64 / count as f64);
    if count % 2 == 1 {
        let sum = |m: usize| values.iter().enumerate().map(|(n, value)| value * turn(m * n % count)).sum();
        return (0..count).map(sum).collect();
    }
    let half = |first: usize| transform(&values[first..].iter().step_by(2).copied().collect::<Vec<_>>());
    let (even, odd) = (half(0), half(1));
    (0..count).map(|m| even[m % (count / 2)] + turn(m) * odd[m % (count / 2)]).collect()
}

/// Amplitudes of the force's harmonics 0, 1, 2, ... over the run's last period: the force is
/// the real first one plus sum Im(F_m exp(i m phi)), phi being the drive's phase.
pub fn force_harmonics(plan: &Plan, instance: usize) -> Vec<Complex<f64>> {
    let trace = trace(plan, instance, None, plan.run.periods, 1).expect("the instance can be traced");
    let count = trace.samples.len();
    let column = |of: fn(&TraceSample) -> f64| {
        transform(&trace.samples.iter().map(|sample| of(sample).into()).collect::<Vec<_>>())
    };
    let (force, moment) = (column(|sample| sample.force), column(|sample| sample.moment));
    // JKR's jumps ring modes far above the drive: enough to reach them when it is slow.
    let most = (count / 2).min(4096);
    (0..=most)
        .map(|m| {
            // A force that acts late in its step does so with a later phase.
            let turn = Complex::new(0.0, -TAU * m as f64 / count as f64);
            let sum = force[m] + turn * moment[m];
            // Samples lie in the middles of the steps.
            let mean = sum * Complex::from_polar(1.0, -PI * m as f64 / count as f64) / count as f64;
            if m == 0 {
                return mean;
            }
            // The trace has the force's mean over each step, which is weaker by sin(x)/x.
            let half = PI * m as f64 / count as f64;
            // f = Re(2 mean exp(i m theta)) = Im(2 i mean exp(i m (phi - phase))).
            mean * (half / half.sin())
                * Complex::new(0.0, 2.0)
                * Complex::from_polar(1.0, -(m as f64) * trace.phase)
        })
        .collect()
}

pub fn balance(plan: &Plan, instance: usize) -> Balance {
    let driven = plan.driven(instance as u32);
    let (free, instrument) = (&driven.free, &driven.instrument);
    let omega = free.omega;
    let force = force_harmonics(plan, instance);
    let mut sum = Balance { drive: 0.0, modes: 0.0, taken: 0.0, excited: 0.0 };
    for (m, amplitude) in force.iter().enumerate().skip(1) {
        let drive = m as f64 * omega;
        for (k, mode) in instrument.modes.iter().enumerate() {
            let loss = mode.omega / mode.quality_factor;
            let stiffness = (mode.omega - drive) * (mode.omega + drive);
            let excited = amplitude * mode.force / Complex::new(stiffness, drive * loss);
            let whole = if m == 1 { excited + free.mode(k) } else { excited };
            let lost = |z: Complex<f64>| 0.5 * loss * drive * drive * z.norm_sqr() * TAU / omega;
            sum.modes += lost(whole);
            sum.excited += lost(excited);
            if m == 1 {
                // What is driven through the base counts by its acceleration -omega^2 level.
                let per_level = if instrument.moving_base { -omega * omega } else { 1.0 };
                sum.drive -= PI * free.level * per_level * mode.drive * whole.im;
            }
        }
    }
    if let Some(first) = force.get(1) {
        if instrument.moving_base {
            sum.drive -= PI * free.level * first.im;
        }
        // -integral of f dz_free: f = Im(F e), dz/dt = Im(i omega Z e).
        sum.taken = -PI * (first * (free.tip * Complex::new(0.0, 1.0)).conj()).re;
    }
    sum
}

/// Work of the drive in a period (J) by the tip's fundamental: it tells the force's first harmonic, since the instrument is linear.
pub fn drive_work(driven: &Driven, tip: Complex<f64>) -> f64 {
    let (free, instrument) = (&driven.free, &driven.instrument);
    let force = (tip - free.tip) / free.compliance;
    let per_level = if instrument.moving_base { -free.omega * free.omega } else { 1.0 };
    let modes = instrument.modes.iter().enumerate().map(|(k, mode)| {
        let stiffness = (mode.omega - free.omega) * (mode.omega + free.omega);
        let response = mode.force / Complex::new(stiffness, free.omega * mode.omega / mode.quality_factor);
        mode.drive * (force * response + free.mode(k)).im
    });
    let through_base = if instrument.moving_base { force.im } else { 0.0 };
    -PI * free.level * (per_level * modes.sum::<f64>() + through_base)
}

/// Work of the drive in a period without a sample, J.
pub fn free_work(driven: &Driven) -> f64 {
    drive_work(driven, driven.free.tip)
}

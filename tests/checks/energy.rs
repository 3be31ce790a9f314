//! Where the drive's work goes, from the contact force's harmonics and the instrument's exact
//! linear response to each of them: nothing of the stepping enters but the force itself.

use afmsweep::engine::trace;
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

/// Amplitudes of the force's harmonics 0, 1, 2, ... over the run's last period: the force is
/// the real first one plus sum Im(F_m exp(i m phi)), phi being the drive's phase.
pub fn force_harmonics(plan: &Plan, instance: usize) -> Vec<Complex<f64>> {
    let trace = trace(plan, instance, None, plan.run.periods, 1).expect("the instance can be traced");
    let count = trace.samples.len();
    // Cosine and sine by table: harmonic m of sample n is entry m (2n + 1) of 2N.
    let table: Vec<Complex<f64>> =
        (0..2 * count).map(|j| Complex::from_polar(1.0, -PI * j as f64 / count as f64)).collect();
    // JKR's jumps ring modes far above the drive: enough to reach them when it is slow.
    let most = (count / 2).min(4096);
    (0..=most)
        .map(|m| {
            // A force that acts late in its step does so with a later phase.
            let turn = Complex::new(0.0, -TAU * m as f64 / count as f64);
            let sum: Complex<f64> = (trace.samples.iter().enumerate())
                .map(|(n, sample)| {
                    table[m * (2 * n + 1) % (2 * count)] * (sample.force + turn * sample.moment)
                })
                .sum();
            let mean = sum / count as f64;
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
        for (mode, steady) in instrument.modes.iter().zip(&free.modes) {
            let loss = mode.omega / mode.quality_factor;
            let stiffness = (mode.omega - drive) * (mode.omega + drive);
            let excited = amplitude * mode.force / Complex::new(stiffness, drive * loss);
            let whole = if m == 1 { excited + steady } else { excited };
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

/// Work of the drive in a period without a sample, J.
pub fn free_work(driven: &Driven) -> f64 {
    let (free, instrument) = (&driven.free, &driven.instrument);
    let per_level = if instrument.moving_base { -free.omega * free.omega } else { 1.0 };
    let modes = instrument.modes.iter().zip(&free.modes);
    -PI * free.level * per_level * modes.map(|(mode, z)| mode.drive * z.im).sum::<f64>()
}

//! Natural modes: eigenproblems in coordinates of unit stiffness, their checks, and damping.
//!
//! With `K = 1` the problem is `A y = mu y`, `mu = 1/omega^2`: the slowest modes are the largest
//! eigenvalues, which a symmetric solver gives to machine precision. A mode normalised to unit
//! modal mass is `omega y`.
//!
//! Damping is modal: 1/Q of a mode is the mean of its parts' 1/Q, weighted by strain energy (the
//! rod's includes its electric part). What damping forces of different modes would exchange is left
//! out: of the order of 1/Q in the quadrature part of a forced motion, and more for two modes
//! closer to each other than their widths.

use nalgebra::{DVector, DVectorView};

use super::Mode;
use super::assemble::{Coupling, Structure};
use super::beam::change;
use super::eigen::Eigen;
use super::error::InstrumentError;
use super::lever::LeverPart;
use super::rod::Rod;
use crate::scene::DriveOn;

/// A rod and a lever that does not act back have no independent modes where frequencies coincide
/// (the motion grows like t sin t); the lever's is then moved so far away, relative, in omega^2.
/// No lever is known to a part in a million, and the shares still cancel to ten digits.
const SEPARATION: f64 = 2e-6;

/// One mode and how well it meets its equation.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Solved {
    pub mode: Mode,
    /// |K p - omega^2 M p| / |K p|
    pub residual: f64,
    /// Largest |p_i.M p_j - delta_ij| against the slower modes and itself.
    pub orthonormality: f64,
    /// By how much the frequency would be higher without the two highest degrees of each element, relative.
    pub change: f64,
}

/// All modes of the model in rising frequency, those lost in rounding left out.
pub(crate) fn solve(s: &Structure) -> Result<Vec<Solved>, InstrumentError> {
    let mut solved = match (&s.coupling, &s.rod) {
        (Coupling::Joint { kappa }, Some(rod)) => joint(s, rod, *kappa)?,
        (Coupling::Cascade, Some(rod)) => cascade(&s.lever, rod, s.on)?,
        _ => base(&s.lever, s.on),
    };
    for Solved { mode, .. } in &mut solved {
        // The sign of an eigenvector means nothing: let the tip go up.
        if mode.tip < 0.0 {
            (mode.tip, mode.force) = (-mode.tip, -mode.force);
            (mode.drive, mode.top) = (-mode.drive, -mode.top);
        }
    }
    solved.sort_by(|a, b| a.mode.omega.total_cmp(&b.mode.omega));
    Ok(solved)
}

/// Rod and lever acting on each other.
fn joint(s: &Structure, rod: &Rod, kappa: f64) -> Result<Vec<Solved>, InstrumentError> {
    let joint = s.joint(rod, kappa);
    let eigen = Eigen::of(&joint.mass)?;
    let split = rod.top.len();
    let rod_inverse_q = 1.0 / rod.quality_factor;
    let mut lost = 0.0;
    let mut solved = Vec::with_capacity(eigen.mu.len());
    for (k, (residual, orthonormality)) in eigen.quality(&joint.mass).into_iter().enumerate() {
        let y = eigen.vectors.column(k);
        if eigen.mu[k] <= eigen.floor() {
            lost += joint.tip.dot(&y) * joint.force.dot(&y);
            continue;
        }
        let omega = eigen.mu[k].powf(-0.5);
        let (on_rod, on_lever) = y.as_slice().split_at(split);
        let in_rod: f64 = on_rod.iter().map(|v| v * v).sum();
        let inverse_q = in_rod * rod_inverse_q + s.lever.weighted_inverse_q(on_lever);
        let mode = Mode {
            omega,
            quality_factor: 1.0 / inverse_q,
            tip: omega * joint.tip.dot(&y),
            force: omega * joint.force.dot(&y),
            drive: omega * joint.drive.dot(&y),
            top: omega * joint.top.dot(&y),
        };
        let change = change(rod.highest(on_rod) + s.lever.highest(on_lever));
        solved.push(Solved { mode, residual, orthonormality, change });
    }
    check_lost(lost, joint.tip.dot(&joint.force))?;
    Ok(solved)
}

/// A rod that drives the lever without feeling it: the equations are block-triangular, so the
/// right vectors (which say how things move) and the left ones (which say what pushes) differ.
/// A rod mode carries the lever's forced motion at its frequency; a mode of the lever is pushed
/// by the drive through the rod's forced motion at the lever's. Each is still one oscillator.
fn cascade(lever: &LeverPart, rod: &Rod, on: DriveOn) -> Result<Vec<Solved>, InstrumentError> {
    let of_rod = Eigen::of(&rod.mass)?;
    let of_lever = &lever.alone;
    let lever_mu = separated(&of_lever.mu, &of_rod.mu);
    let along = |row: &DVector<f64>, eigen: &Eigen| -> Vec<f64> {
        (0..eigen.mu.len()).map(|k| row.dot(&eigen.vectors.column(k))).collect()
    };
    let (tops, tips) = (along(&rod.top, &of_rod), along(&lever.tip, of_lever));
    let (pulls, drives) = (along(&lever.base, of_lever), along(&lever.drive, of_lever));
    let mut solved = Vec::with_capacity(tops.len() + tips.len());
    for (j, (residual, orthonormality)) in of_rod.quality(&rod.mass).into_iter().enumerate() {
        let mu = of_rod.mu[j];
        if mu <= of_rod.floor() {
            continue;
        }
        let omega = mu.powf(-0.5);
        let top = omega * tops[j];
        let carried: f64 = (0..tips.len()).map(|i| tips[i] * pulls[i] / (mu - lever_mu[i])).sum();
        let drive = match on {
            DriveOn::Actuator => rod.force_per_volt * top,
            DriveOn::Tip => 0.0,
        };
        let mode = Mode {
            omega,
            quality_factor: rod.quality_factor,
            tip: top * (1.0 + carried),
            force: 0.0,
            drive,
            top,
        };
        let change = change(rod.highest(of_rod.vectors.column(j).as_slice()));
        solved.push(Solved { mode, residual, orthonormality, change });
    }
    let quality = of_lever.quality(&lever.mass);
    for (i, &(residual, orthonormality)) in quality.iter().enumerate() {
        if of_lever.mu[i] <= of_lever.floor() {
            continue;
        }
        let omega = lever_mu[i].powf(-0.5);
        let drive = match on {
            DriveOn::Actuator => {
                let passed: f64 =
                    (0..tops.len()).map(|j| tops[j] * tops[j] / (lever_mu[i] - of_rod.mu[j])).sum();
                omega * pulls[i] * passed * rod.force_per_volt
            }
            DriveOn::Tip => omega * drives[i],
        };
        let mode = Mode {
            omega,
            quality_factor: 1.0 / lever.inverse_q(i),
            tip: omega * tips[i],
            force: omega * tips[i],
            drive,
            top: 0.0,
        };
        solved.push(Solved { mode, residual, orthonormality, change: lever.change(i) });
    }
    Ok(solved)
}

/// No rod: the lever alone, on a base that rests or moves as told.
fn base(lever: &LeverPart, on: DriveOn) -> Vec<Solved> {
    let eigen = &lever.alone;
    let along = |row: &DVector<f64>, y: DVectorView<f64>| row.dot(&y);
    let mut solved = Vec::with_capacity(eigen.mu.len());
    for (k, (residual, orthonormality)) in eigen.quality(&lever.mass).into_iter().enumerate() {
        if eigen.mu[k] <= eigen.floor() {
            continue;
        }
        let omega = eigen.mu[k].powf(-0.5);
        let y = eigen.vectors.column(k);
        let tip = omega * along(&lever.tip, y);
        let drive = match on {
            // Per acceleration of the base, which pulls the lever back: -Gamma_k.
            DriveOn::Actuator => -omega * along(&lever.base, y),
            DriveOn::Tip => omega * along(&lever.drive, y),
        };
        let mode = Mode { omega, quality_factor: 1.0 / lever.inverse_q(k), tip, force: tip, drive, top: 0.0 };
        solved.push(Solved { mode, residual, orthonormality, change: lever.change(k) });
    }
    solved
}

/// The lever's `mu` kept apart from the rod's by [`SEPARATION`].
fn separated(lever: &[f64], rod: &[f64]) -> Vec<f64> {
    let mut moved = lever.to_vec();
    for mu in &mut moved {
        for &other in rod {
            if (*mu - other).abs() < SEPARATION * other.abs() {
                *mu = other * (1.0 + SEPARATION.copysign(*mu - other));
            }
        }
    }
    moved
}

/// Modes too fast to be told from rounding may be left out only if the tip does not need them.
fn check_lost(lost: f64, flexibility: f64) -> Result<(), InstrumentError> {
    let residual = (lost / flexibility).abs();
    if residual > 1e-9 {
        return Err(InstrumentError::Inaccurate { residual, orthonormality: 0.0, limit: 1e-9 });
    }
    Ok(())
}

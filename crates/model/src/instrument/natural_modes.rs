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

use super::Mode;
use super::assembly::{Coupling, Structure};
use super::instrument_error::InstrumentError;
use super::lever::LeverPart;
use super::rod::Rod;
use super::secular::{SecularPair, dot, orthonormality};
use super::unit_modes::{Quality, change};
use crate::scene::DriveOn;

/// A rod and a lever that does not act back have no independent modes where frequencies coincide
/// (the motion grows like t sin t); the lever's is then moved so far away, relative, in omega^2.
/// No lever is known to a part in a million, and the shares still cancel to ten digits.
const SEPARATION: f64 = 2e-6;

/// One mode and how well it meets its equation.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EigenSolution {
    pub mode: Mode,
    pub quality: Quality,
    /// By how much the frequency would be higher without the two highest degrees of each element, relative.
    pub change: f64,
}

/// All modes of the model in rising frequency, those lost in rounding left out.
pub(crate) fn solve(s: &Structure) -> Result<Vec<EigenSolution>, InstrumentError> {
    let mut solved = match (&s.coupling, &s.rod) {
        (Coupling::Joint { kappa }, Some(rod)) => joint(s, rod, *kappa)?,
        (Coupling::Cascade, Some(rod)) => cascade(&s.lever, rod, s.on),
        _ => base(&s.lever, s.on),
    };
    for EigenSolution { mode, .. } in &mut solved {
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
fn joint(s: &Structure, rod: &Rod, kappa: f64) -> Result<Vec<EigenSolution>, InstrumentError> {
    let (lever, split) = (&s.lever, rod.mu.len());
    let pairs = s.joint(rod, kappa);
    let per_top = rod.stiffness.sqrt().recip();
    let mode = |pair: &SecularPair, omega: f64| {
        let (on_rod, on_lever) = pair.rest.split_at(split);
        let top = pair.corner * per_top;
        let bent = dot(&lever.tip, on_lever);
        let drive = match s.on {
            DriveOn::Actuator => rod.force_per_volt * top,
            DriveOn::Tip => top + dot(&lever.drive, on_lever),
        };
        let in_rod = pair.corner * pair.corner + dot(on_rod, on_rod);
        let inverse_q = in_rod / rod.quality_factor + lever.weighted_inverse_q(on_lever);
        Mode {
            omega,
            quality_factor: 1.0 / inverse_q,
            tip: omega * (kappa * top + bent),
            force: omega * (top + bent),
            drive: omega * drive,
            top: omega * top,
        }
    };
    let left_out = |pair: &SecularPair| {
        let (on_rod, on_lever) = pair.rest.split_at(split);
        rod.highest(on_rod) + lever.highest(on_lever)
    };
    let parts: Vec<[f64; 2]> = rod.misses().chain(lever.misses()).collect();
    let mut solved = checked(&pairs, mode, left_out, &parts);
    // All others lie above a mode of a part: of the fastest alone may nothing but rounding be left.
    let rounding = pairs.len() as f64 * f64::EPSILON * pairs[0].value;
    if pairs[pairs.len() - 1].value <= rounding {
        solved.pop();
        let fastest = mode(&pairs[pairs.len() - 1], 1.0);
        let flexibility = dot(&lever.tip, &lever.tip) + kappa / rod.stiffness;
        check_lost(fastest.tip * fastest.force, flexibility)?;
    }
    Ok(solved)
}

/// The most by which a frequency may change, whatever the tolerance: modes from the first beyond it on are not looked at.
const CHANGE_MAX: f64 = 0.1;

/// Pairs as modes, with how well they are met as far as their frequencies stand. `parts` is by how much what they are made of
/// misses its equations ([`Quality::absolute`]).
fn checked(
    pairs: &[SecularPair],
    mode: impl Fn(&SecularPair, f64) -> Mode,
    left_out: impl Fn(&SecularPair) -> f64,
    parts: &[[f64; 2]],
) -> Vec<EigenSolution> {
    let changes = pairs.iter().map(|pair| change(left_out(pair)));
    let changes: Vec<f64> = changes.take_while(|change| *change <= CHANGE_MAX).collect();
    let orthonormality = orthonormality(&pairs[..changes.len()]);
    let one = |(k, pair): (usize, &SecularPair)| {
        let mode = mode(pair, pair.value.powf(-0.5));
        let Some(&change) = changes.get(k) else {
            return EigenSolution { mode, quality: Quality::UNKNOWN, change: f64::INFINITY };
        };
        let own = Quality { residual: pair.residual, orthonormality: orthonormality[k] };
        let quality = Quality::of_sum(own, pair.value, &pair.rest, parts);
        EigenSolution { mode, quality, change }
    };
    pairs.iter().enumerate().map(one).collect()
}

/// A rod that drives the lever without feeling it: the equations are block-triangular, so the
/// right vectors (which say how things move) and the left ones (which say what pushes) differ.
/// A rod mode carries the lever's forced motion at its frequency; a mode of the lever is pushed
/// by the drive through the rod's forced motion at the lever's. Each is still one oscillator.
fn cascade(lever: &LeverPart, rod: &Rod, on: DriveOn) -> Vec<EigenSolution> {
    let of_rod = rod.alone();
    let rod_mu: Vec<f64> = of_rod.iter().map(|pair| pair.value).collect();
    let lever_mu = separated(&lever.mu, &rod_mu);
    let per_top = rod.stiffness.sqrt().recip();
    let tops: Vec<f64> = of_rod.iter().map(|pair| pair.corner * per_top).collect();
    let (tips, pulls) = (&lever.tip, &lever.base);
    let mode = |pair: &SecularPair, omega: f64| {
        let top = omega * pair.corner * per_top;
        let carried: f64 = (0..tips.len()).map(|i| tips[i] * pulls[i] / (pair.value - lever_mu[i])).sum();
        let drive = match on {
            DriveOn::Actuator => rod.force_per_volt * top,
            DriveOn::Tip => 0.0,
        };
        Mode { omega, quality_factor: rod.quality_factor, tip: top * (1.0 + carried), force: 0.0, drive, top }
    };
    let mut solved =
        checked(&of_rod, mode, |pair| rod.highest(&pair.rest), &rod.misses().collect::<Vec<_>>());
    for i in 0..tips.len() {
        let omega = lever_mu[i].powf(-0.5);
        let drive = match on {
            DriveOn::Actuator => {
                let passed: f64 =
                    (0..tops.len()).map(|j| tops[j] * tops[j] / (lever_mu[i] - rod_mu[j])).sum();
                omega * pulls[i] * passed * rod.force_per_volt
            }
            DriveOn::Tip => omega * lever.drive[i],
        };
        solved.push(of_lever(lever, i, omega, drive));
    }
    solved
}

/// No rod: the lever alone, on a base that rests or moves as told.
fn base(lever: &LeverPart, on: DriveOn) -> Vec<EigenSolution> {
    let one = |k: usize| {
        let omega = lever.mu[k].powf(-0.5);
        let drive = match on {
            // Per acceleration of the base, which pulls the lever back: -Gamma_k.
            DriveOn::Actuator => -omega * lever.base[k],
            DriveOn::Tip => omega * lever.drive[k],
        };
        of_lever(lever, k, omega, drive)
    };
    (0..lever.mu.len()).map(one).collect()
}

/// A mode of the lever alone at `omega`, driven like that, with the rod's top at rest.
fn of_lever(lever: &LeverPart, k: usize, omega: f64, drive: f64) -> EigenSolution {
    let tip = omega * lever.tip[k];
    let mode = Mode { omega, quality_factor: 1.0 / lever.inverse_q(k), tip, force: tip, drive, top: 0.0 };
    EigenSolution { mode, quality: lever.quality[k], change: lever.change(k) }
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

//! The Jacobian of the period map far from the sample, where the modes move freely.

use crate::kernel::increments;
use crate::periodic::{Memory, Size};
use crate::plan::Plan;
use nalgebra::{DefaultAllocator, DimName, Matrix2, OMatrix};
use std::f64::consts::TAU;

/// A mode is slow if its motion decays by at most this exponent in a period.
const SLOW_MODE_EXPONENT: f64 = 0.3;

/// The free lever's Jacobian, and its columns of slow modes (see [`SLOW_MODE_EXPONENT`]) and of a law's memory. Contact changes
/// these by more than a search can leave to its updates.
pub(super) fn free_monodromy<D: Size + DimName>(
    plan: &Plan,
    instance: u32,
) -> (OMatrix<f64, D, D>, Vec<usize>)
where
    DefaultAllocator: Memory<D>,
{
    let driven = plan.driven(instance);
    let mut slope = OMatrix::<f64, D, D>::zeros();
    let (mut columns, modes) = (Vec::new(), D::DIM / 2);
    let angle = |omega: f64| TAU * omega / driven.free.omega;
    let rate = |k: usize| driven.kept.modes[k].damping * angle(driven.kept.modes[k].omega);
    let slowest = (0..driven.kept.modes.len()).map(rate).fold(f64::INFINITY, f64::min);
    for (k, mode) in driven.kept.modes.iter().enumerate().take(modes) {
        put_block(&mut slope, k, free_motion(angle(mode.omega), mode.damping));
        if rate(k) <= slowest.max(SLOW_MODE_EXPONENT) {
            columns.extend([k, modes + k]);
        }
    }
    if let Some(recovery) = recovery(plan, instance) {
        let kept = driven.kept.modes.len();
        let left = (-TAU / driven.free.omega * recovery).exp();
        put_block(&mut slope, kept, Matrix2::from_diagonal_element(left));
        columns.extend([kept, modes + kept]);
    }
    (slope, columns)
}

/// (I - J)^-1 of the free lever's Jacobian J, mode by mode. Not finite where free motion repeats itself after a period, as a
/// mode's may that has no damping: a transfer to such a lever predicts nothing.
pub(super) fn free_resolvent<D: Size + DimName>(plan: &Plan, instance: u32) -> OMatrix<f64, D, D>
where
    DefaultAllocator: Memory<D>,
{
    let (mut slope, _) = free_monodromy::<D>(plan, instance);
    let modes = D::DIM / 2;
    for k in 0..modes {
        let (x, u) = (k, modes + k);
        let block = Matrix2::new(slope[(x, x)], slope[(x, u)], slope[(u, x)], slope[(u, u)]);
        let inverse = (Matrix2::identity() - block).try_inverse();
        put_block(&mut slope, k, inverse.unwrap_or_else(|| Matrix2::repeat(f64::NAN)));
    }
    slope
}

/// The rate at which an instance's law forgets, 1/s. `None` if it remembers nothing.
pub(super) fn recovery(plan: &Plan, instance: u32) -> Option<f64> {
    let remembers = plan.pairs(instance) > plan.driven(instance).kept.modes.len();
    remembers.then(|| plan.contact(instance).law().recovery())
}

/// Free motion of a mode over this angle, in (travel, rate over angular frequency).
pub(super) fn free_motion(angle: f64, damping: f64) -> Matrix2<f64> {
    let [m00, m01, m10, m11] = increments(angle, damping);
    Matrix2::new(1.0 + m00, m01, m10, 1.0 + m11)
}

/// Puts down what mode `k`'s travel and rate change by with each other.
fn put_block<D: Size + DimName>(slope: &mut OMatrix<f64, D, D>, k: usize, block: Matrix2<f64>)
where
    DefaultAllocator: Memory<D>,
{
    let (x, u) = (k, D::DIM / 2 + k);
    (slope[(x, x)], slope[(x, u)]) = (block[(0, 0)], block[(0, 1)]);
    (slope[(u, x)], slope[(u, u)]) = (block[(1, 0)], block[(1, 1)]);
}

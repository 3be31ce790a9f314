//! The Jacobian of the period map far from the sample, where the modes move freely.

use crate::kernel::increments;
use crate::periodic::{Memory, Size};
use crate::plan::Plan;
use nalgebra::{DefaultAllocator, DimName, OMatrix};
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
        let [xx, xu, ux, uu] = increments(angle(mode.omega), mode.damping);
        for (column, [x, u]) in [(k, [1.0 + xx, ux]), (modes + k, [xu, 1.0 + uu])] {
            [slope[(k, column)], slope[(modes + k, column)]] = [x, u];
            if rate(k) <= slowest.max(SLOW_MODE_EXPONENT) {
                columns.push(column);
            }
        }
    }
    let kept = driven.kept.modes.len();
    if plan.pairs(instance) > kept {
        let left = (-TAU / driven.free.omega * plan.contact(instance).law().recovery()).exp();
        for column in [kept, modes + kept] {
            slope[(column, column)] = left;
            columns.push(column);
        }
    }
    (slope, columns)
}

/// (I - J)^-1 of the free lever's Jacobian J, mode by mode. Not finite for a mode without damping: a transfer to it predicts
/// nothing.
pub(super) fn free_resolvent<D: Size + DimName>(plan: &Plan, instance: u32) -> OMatrix<f64, D, D>
where
    DefaultAllocator: Memory<D>,
{
    let (mut slope, _) = free_monodromy::<D>(plan, instance);
    let modes = D::DIM / 2;
    for k in 0..modes {
        let (x, u) = (k, modes + k);
        let [a, b, c, d] = [1.0 - slope[(x, x)], -slope[(x, u)], -slope[(u, x)], 1.0 - slope[(u, u)]];
        let size = a * d - b * c;
        [slope[(x, x)], slope[(x, u)]] = [d / size, -b / size];
        [slope[(u, x)], slope[(u, u)]] = [-c / size, a / size];
    }
    slope
}

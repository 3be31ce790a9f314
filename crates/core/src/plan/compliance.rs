//! The tip's compliance with few oscillators.
//!
//! The tip feels the lever through one function only, its travel per tip force: C(s) = sum c_k b_k/(omega_k^2 + s^2) over all
//! modes, where s is the rate of an event (for a contact, the inverse of its duration). C is a Stieltjes function of s^2, and
//! a rational Krylov subspace with real shifts gives oscillators that match its value and its slope at the shifts (Galerkin
//! projection, a multipoint Pade approximant: Grimme, thesis, Univ. of Illinois 1997; Antoulas, Approximation of Large-Scale
//! Dynamical Systems, 2005). They are passive: all frequencies and weights are positive. The lowest modes, which ring on
//! between contacts, are kept as they are; only the rest is reduced.

use super::oscillator::KeptMode;
use crate::instrument::Mode;
use nalgebra::{DMatrix, DVector, SymmetricEigen};

/// The compliance of oscillators is checked up to this many times the contact's rate: onset and end of a contact are faster than
/// its middle.
pub(super) const MAX_RATE_RATIO: f64 = 4.0;

/// Travel of the tip per force on it that changes at the rate `s` (rad/s), m/N. `oscillators` gives the frequency (rad/s) and
/// inverse mass (1/kg) of each.
pub fn compliance(oscillators: impl Iterator<Item = (f64, f64)>, s: f64) -> f64 {
    oscillators.map(|(omega, inverse_mass)| inverse_mass / (omega * omega + s * s)).sum()
}

/// `count` oscillators for the compliance of these modes at rates from `from` to `to` (rad/s). `None` if a mode answers
/// against the force, as it may where the rod does not feel the lever.
pub fn reduced(modes: &[&Mode], count: usize, from: f64, to: f64) -> Option<Vec<KeptMode>> {
    let count = count.min(modes.len());
    if count == 0 || modes.iter().any(|mode| mode.inverse_mass() < 0.0) {
        return None;
    }
    let push = DVector::from_iterator(modes.len(), modes.iter().map(|mode| mode.inverse_mass().sqrt()));
    let mut basis: Vec<DVector<f64>> = Vec::with_capacity(count);
    for n in 0..count {
        let place = if count == 1 { 0.5 } else { n as f64 / (count - 1) as f64 };
        let shift = (from * (to / from).powf(place)).powi(2);
        let mut answer = DVector::from_iterator(
            modes.len(),
            modes.iter().zip(push.iter()).map(|(mode, push)| push / (square(mode) + shift)),
        );
        // Twice, because rounding spoils one pass.
        for _ in 0..2 {
            for known in &basis {
                answer -= known * known.dot(&answer);
            }
            answer /= answer.norm();
        }
        if !answer.iter().all(|value| value.is_finite()) {
            return None;
        }
        basis.push(answer);
    }
    projected(modes, &push, &DMatrix::from_columns(&basis))
}

fn square(mode: &Mode) -> f64 {
    mode.omega * mode.omega
}

/// Projects the modes on a basis of their mass-weighted amplitudes (Galerkin) and returns the oscillators. `push` is the
/// effect of a tip force on each mode.
fn projected(modes: &[&Mode], push: &DVector<f64>, basis: &DMatrix<f64>) -> Option<Vec<KeptMode>> {
    let count = basis.ncols();
    let stiffness = DMatrix::<f64>::from_fn(count, count, |i, j| {
        (0..modes.len()).map(|k| basis[(k, i)] * square(modes[k]) * basis[(k, j)]).sum()
    });
    let solved = SymmetricEigen::try_new(stiffness, f64::EPSILON, 100 * count)?;
    // The same order on every processor, unlike nalgebra's product of matrices.
    let shapes = DMatrix::<f64>::from_fn(modes.len(), count, |k, j| {
        (0..count).map(|i| basis[(k, i)] * solved.eigenvectors[(i, j)]).sum()
    });
    let mut oscillators: Vec<KeptMode> = (0..count)
        .map(|j| {
            let shape = shapes.column(j);
            let tip = shape.dot(push);
            let square_of = solved.eigenvalues[j];
            // The strain energy in each mode weights the oscillator's loss.
            let loss: f64 = modes
                .iter()
                .zip(shape.iter())
                .map(|(mode, v)| v * v * square(mode) / mode.quality_factor)
                .sum();
            let top: f64 = modes
                .iter()
                .zip(shape.iter())
                .map(|(mode, v)| v * mode.top * (mode.force / mode.tip).abs().sqrt())
                .sum();
            KeptMode {
                index: None,
                omega: square_of.sqrt(),
                damping: 0.5 * loss / square_of,
                inverse_mass: tip * tip,
                top: top / tip,
            }
        })
        .collect();
    oscillators.sort_by(|a, b| a.omega.total_cmp(&b.omega));
    oscillators.iter().all(|one| one.omega.is_finite() && one.omega > 0.0).then_some(oscillators)
}

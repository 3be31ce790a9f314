//! From dimensions to modes: the mesh is chosen here, by refining until the frequencies stand.
//!
//! Which modes must stand. The drive shakes the rod at or below a few lever frequencies and the
//! sample's force excites the lever mainly in its first modes, so the band reaches to the lever's
//! third mode alone and at least to ten times its first (a drive at resonance, ten harmonics).
//! Rod modes beyond the band enter through their static share, which elements give exactly. The
//! lever alone must stand in its first eight modes, which list the damping and carry the contact.
//! The rod's count in the band is held between 8 and 24, or whatever reaches 1.5 times the
//! lever's first mode if that is more.
//!
//! How. Hierarchical elements of up to nine half-waves each converge exponentially in their
//! degree, so the number of elements is fixed by counting half-waves and the degree is raised by
//! two until no frequency that matters has moved by more than the tolerance. What a model with two
//! degrees fewer would give is read off the shapes of the finer one (`unit_modes::change`), so that one
//! model is enough for most. The change is the coarser model's error; the finer one, which is kept,
//! is far better.

use super::assembly::{Coupling, Mesh, Structure};
use super::instrument_error::InstrumentError;
use super::lever::LeverPart;
use super::natural_modes::{EigenSolution, solve};
use super::rod::Rod;
use super::unit_modes::Quality;
use super::{Instrument, check_positive};
use crate::scene::{ActuatorModel, DriveOn, InstrumentParams};

/// Tolerance on the frequencies for a sweep of ordinary accuracy, relative.
pub const DEFAULT_TOLERANCE: f64 = 1e-8;
/// Modes of the lever alone that must stand.
const LEVER_MODES: usize = 8;
/// Fewest and usual most rod modes that must stand, and the most for a rod slower than its lever.
const ROD_MODES: [usize; 3] = [8, 24, 96];
/// Half-waves per element.
const PER_ELEMENT: usize = 9;
/// Degrees tried: below the first, nine half-waves per element have not converged.
const ORDERS: [usize; 2] = [20, 40];
/// Largest residual or loss of orthonormality of a resolved mode.
const QUALITY: f64 = 1e-6;

impl Instrument {
    /// The modes of the instrument that `params` describe, driven `on` actuator or tip.
    ///
    /// `tolerance` bounds the relative change of each frequency that matters under refinement
    /// (see the module's head); [`DEFAULT_TOLERANCE`] serves ordinary sweeps.
    ///
    /// # Errors
    /// Impossible values, an unstable rod, and frequencies that cannot be had to `tolerance`.
    pub fn reduce(params: &InstrumentParams, on: DriveOn, tolerance: f64) -> Result<Self, InstrumentError> {
        if !(1e-12..=0.1).contains(&tolerance) {
            return Err(InstrumentError::BadValue {
                what: "the tolerance of the frequencies",
                value: tolerance,
                expected: "between 1e-12 and 0.1",
            });
        }
        let mut mesh = Mesh { rod_elements: 1, beam_elements: 1, order: ORDERS[0] + 2 };
        let mut lever = LeverPart::new(params, mesh.beam_elements, mesh.order)?;
        let band = band(params, &lever.mu)?;
        mesh.rod_elements = band.rod_elements;
        loop {
            let structure = Structure::with(lever, params, on, mesh)?;
            let solved = solve(&structure)?;
            let in_band = solved.iter().take_while(|one| one.mode.omega <= band.omega).count();
            let coupled = solved[..in_band].iter().map(|one| one.change);
            let listed = LEVER_MODES.min(structure.lever.mu.len());
            let alone = (0..listed).map(|j| structure.lever.change(j));
            // `f64::max` would pass over NaN.
            let worst = coupled.chain(alone).fold(0.0, |a: f64, b| if b <= a { a } else { b });
            if worst <= tolerance {
                return finish(&structure, mesh, &solved, in_band, tolerance);
            }
            if mesh.order >= ORDERS[1] {
                return Err(InstrumentError::NotConverged { change: worst, tolerance, order: mesh.order });
            }
            mesh.order += 2;
            lever = LeverPart::new(params, mesh.beam_elements, mesh.order)?;
        }
    }

    /// The modes on a given mesh, nothing chosen or refined: for studies of convergence.
    ///
    /// `resolved` counts all modes; a lever's degree is at least 3.
    ///
    /// # Errors
    /// Impossible values, an unstable rod, and a mesh without elements or degree.
    pub fn on_mesh(params: &InstrumentParams, on: DriveOn, mesh: Mesh) -> Result<Self, InstrumentError> {
        for (what, value) in [
            ("the mesh's rod_elements", mesh.rod_elements),
            ("the mesh's beam_elements", mesh.beam_elements),
            ("the mesh's order", mesh.order),
        ] {
            check_positive(what, value as f64)?;
        }
        let structure = Structure::new(params, on, mesh)?;
        let solved = solve(&structure)?;
        check_range(&solved)?;
        Ok(instrument(&structure, mesh, &solved, solved.len()))
    }
}

/// Up to where frequencies must stand.
struct Band {
    omega: f64,
    rod_elements: usize,
}

fn band(p: &InstrumentParams, lever_mu: &[f64]) -> Result<Band, InstrumentError> {
    let omega = |k: usize| lever_mu[k.min(lever_mu.len() - 1)].powf(-0.5);
    let wanted = omega(2).max(10.0 * omega(0));
    if p.actuator.model == ActuatorModel::Rigid {
        // The lever's own eight modes are the band.
        return Ok(Band { omega: wanted.max(1.001 * omega(LEVER_MODES - 1)), rod_elements: 1 });
    }
    check_positive("the rod's youngs_modulus", p.actuator.youngs_modulus)?;
    check_positive("the rod's density", p.actuator.density)?;
    check_positive("the rod's length", p.actuator.length)?;
    let below = |omega: f64| Rod::modes_below(&p.actuator, omega / std::f64::consts::TAU);
    let needed = below(1.5 * omega(0));
    let [fewest, usual, most] = ROD_MODES;
    if needed.is_nan() || needed > most as f64 {
        let rod_hz = (p.actuator.youngs_modulus / p.actuator.density).sqrt() / (4.0 * p.actuator.length);
        let lever_hz = omega(0) / std::f64::consts::TAU;
        return Err(InstrumentError::RodTooSlow { rod_hz, lever_hz, needed, most });
    }
    let count = (below(wanted) as usize).clamp(fewest, usual.max(needed as usize));
    // Elements carry so many half-waves; frequencies above the last of them need not stand.
    let reach =
        (count as f64 - 0.5) * std::f64::consts::PI * (p.actuator.youngs_modulus / p.actuator.density).sqrt()
            / p.actuator.length;
    Ok(Band { omega: wanted.min(reach), rod_elements: count.div_ceil(PER_ELEMENT) })
}

fn finish(
    structure: &Structure,
    mesh: Mesh,
    solved: &[EigenSolution],
    in_band: usize,
    tolerance: f64,
) -> Result<Instrument, InstrumentError> {
    let resolved = solved.iter().take_while(|one| one.change <= tolerance).count();
    check_range(solved)?;
    for s in &solved[..in_band.max(resolved).min(solved.len())] {
        let Quality { residual, orthonormality } = s.quality;
        if !(residual <= QUALITY && orthonormality <= QUALITY) {
            return Err(InstrumentError::Inaccurate { residual, orthonormality, limit: QUALITY });
        }
    }
    Ok(instrument(structure, mesh, solved, resolved))
}

/// Sizes at the ends of f64's range pass every check and still overflow in a product.
fn check_range(solved: &[EigenSolution]) -> Result<(), InstrumentError> {
    for EigenSolution { mode, .. } in solved {
        let numbers = [
            ("frequency of a mode", mode.omega),
            ("tip travel of a mode", mode.tip),
            ("force on a mode", mode.force),
            ("drive of a mode", mode.drive),
            ("rod travel of a mode", mode.top),
        ];
        if let Some((what, value)) = numbers.into_iter().find(|(_, value)| !value.is_finite()) {
            return Err(InstrumentError::OutOfRange { what, value });
        }
    }
    if solved.is_empty() {
        return Err(InstrumentError::OutOfRange { what: "number of modes", value: 0.0 });
    }
    Ok(())
}

fn instrument(structure: &Structure, mesh: Mesh, solved: &[EigenSolution], resolved: usize) -> Instrument {
    let has_rod = structure.rod.is_some();
    let has_beam = structure.lever.elements > 0;
    Instrument {
        modes: solved.iter().map(|s| s.mode).collect(),
        residual: solved[..resolved].iter().fold(0.0, |worst, s| worst.max(s.quality.residual)),
        rod_elements: if has_rod { mesh.rod_elements } else { 0 },
        beam_elements: if has_beam { mesh.beam_elements } else { 0 },
        order: if has_rod || has_beam { mesh.order } else { 0 },
        resolved,
        lever_frequency: structure.lever.first_omega() / std::f64::consts::TAU,
        moving_base: matches!(structure.coupling, Coupling::Base) && structure.on == DriveOn::Actuator,
        on: structure.on,
    }
}

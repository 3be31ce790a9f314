//! Rod and lever put together.
//!
//! The absolute travel of the lever is `W = kappa u(l_p) + v`. Hamilton's principle with the
//! energies of Ha, Fung & Chen 2005, (2) to (6), has kappa = 1. Their equation (13) sets
//! `v(0) = u(l_p)`, although (2) and (10) already count v from the moving base; read literally
//! the base motion counts twice: kappa = 2 in the kinetic energy and in the tip's travel, while
//! the sample's force keeps its single share. That reading is kept for replication
//! ([`ActuatorModel::AsPrinted`]); nothing else uses it. Likewise their (7) and (12b) let the
//! sample's force do no work on u(l_p) and count the lever's inertia twice; here the force works
//! on the whole travel of the tip.

use super::instrument_error::InstrumentError;
use super::lever::LeverPart;
use super::rod::Rod;
use super::secular::{Line, SecularPair, pairs};
use crate::scene::{ActuatorModel, DriveOn, InstrumentParams};

/// Elements and polynomial degree; the lever's degree is at least 3.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Mesh {
    pub rod_elements: usize,
    pub beam_elements: usize,
    pub order: usize,
}

/// How the parts act on each other.
pub(crate) enum Coupling {
    /// Both ways, with `W = kappa u + v`.
    Joint { kappa: f64 },
    /// The rod drives the lever and does not feel it.
    Cascade,
    /// No rod: a base at rest or moved as told.
    Base,
}

/// The parts and their coupling, ready for the eigenproblem.
pub(crate) struct Structure {
    pub coupling: Coupling,
    pub rod: Option<Rod>,
    pub lever: LeverPart,
    pub on: DriveOn,
}

impl Structure {
    pub fn new(p: &InstrumentParams, on: DriveOn, mesh: Mesh) -> Result<Self, InstrumentError> {
        let lever = LeverPart::new(p, mesh.beam_elements, mesh.order.max(3))?;
        Self::with(lever, p, on, mesh)
    }

    /// The same with a lever that is there already.
    pub fn with(
        lever: LeverPart,
        p: &InstrumentParams,
        on: DriveOn,
        mesh: Mesh,
    ) -> Result<Self, InstrumentError> {
        let coupling = match p.actuator.model {
            ActuatorModel::Coupled => Coupling::Joint { kappa: 1.0 },
            ActuatorModel::AsPrinted => Coupling::Joint { kappa: 2.0 },
            ActuatorModel::Prescribed => Coupling::Cascade,
            ActuatorModel::Rigid => Coupling::Base,
        };
        let rod = match coupling {
            Coupling::Base => None,
            _ => Some(Rod::new(&p.actuator, mesh.rod_elements, mesh.order)?),
        };
        Ok(Self { coupling, rod, lever, on })
    }

    /// The modes of rod and lever acting on each other, in coordinates of unit stiffness: the corner is the rod's top, then
    /// come the modes of the rod with its top held and those of the lever alone.
    ///
    /// `T = 1/2 (v' + kappa r u')^T M (v' + kappa r u')` spelled out: the top carries the rigid mass and pulls on every mode of
    /// the lever, and nothing else is coupled (Craig & Bampton, AIAA J. 6 (1968) 1313).
    pub fn joint(&self, rod: &Rod, kappa: f64) -> Vec<SecularPair> {
        let lever = &self.lever;
        let k = rod.stiffness.sqrt();
        let corner = (rod.mass + kappa * kappa * lever.rigid_mass) / rod.stiffness;
        let mu: Vec<f64> = rod.mu.iter().chain(&lever.mu).copied().collect();
        let pulls = rod.coupling.iter().map(|c| c / k).chain(lever.base.iter().map(|b| kappa * b / k));
        pairs(Line::arrowhead(corner), &mu, &pulls.collect::<Vec<_>>())
    }
}

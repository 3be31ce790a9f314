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

use nalgebra::{DMatrix, DVector};

use super::error::InstrumentError;
use super::lever::LeverPart;
use super::rod::Rod;
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

/// One symmetric eigenproblem of unit stiffness with its rows of participation.
pub(crate) struct Joint {
    pub mass: DMatrix<f64>,
    pub tip: DVector<f64>,
    pub force: DVector<f64>,
    pub drive: DVector<f64>,
    pub top: DVector<f64>,
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

    /// Rod and lever acting on each other: unknowns of the rod, then of the lever.
    pub fn joint(&self, rod: &Rod, kappa: f64) -> Joint {
        let lever = &self.lever;
        let (r, l) = (rod.top.len(), lever.tip.len());
        let mut mass = DMatrix::zeros(r + l, r + l);
        mass.view_mut((0, 0), (r, r)).copy_from(&rod.mass);
        mass.view_mut((r, r), (l, l)).copy_from(&lever.mass);
        // T = 1/2 (v' + kappa r u')^T M (v' + kappa r u') spelled out: the base carries the rigid mass and
        // pulls on every unknown of the lever.
        mass.view_mut((0, 0), (r, r)).ger(kappa * kappa * lever.rigid_mass, &rod.top, &rod.top, 1.0);
        let pull = kappa * &rod.top * lever.base.transpose();
        mass.view_mut((0, r), (r, l)).copy_from(&pull);
        mass.view_mut((r, 0), (l, r)).copy_from(&pull.transpose());
        let row = |on_top: f64, on_lever: &DVector<f64>| {
            let mut row = DVector::zeros(r + l);
            row.rows_mut(0, r).axpy(on_top, &rod.top, 1.0);
            row.rows_mut(r, l).copy_from(on_lever);
            row
        };
        let still = DVector::zeros(l);
        Joint {
            tip: row(kappa, &lever.tip),
            force: row(1.0, &lever.tip),
            drive: match self.on {
                DriveOn::Actuator => row(rod.force_per_volt, &still),
                DriveOn::Tip => row(1.0, &lever.drive),
            },
            top: row(1.0, &still),
            mass,
        }
    }
}

//! The instances of a scene: what they are, not how they run.

use super::interning::{Codes, Interned};
use crate::contact::{Compact, Contact, Law};
use crate::instrument::{FreeMotion, Instrument, Mode};
use crate::scene::{Cases, ForceBranch, Held, Viscosity};
use std::f64::consts::TAU;
use std::sync::Arc;

/// Amplitude, in gaps, of a tip that touches where its free oscillation does not.
const FREE_AMPLITUDE_MARGIN: f64 = 1.05;

/// Number of an instance in its ensemble: its position in the scene's order and in the results file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct InstanceId(pub u32);

/// All instances of a scene. It never changes, and every plan of the scene shares it.
#[derive(Clone, Debug)]
pub struct Ensemble {
    /// Distinct instruments with their drives.
    pub drives: Vec<Arc<Drive>>,
    /// By instance, in the scene's order: the number of its drive.
    pub(super) drive_of: Codes,
    pub(super) contacts: Contacts,
    pub(super) gaps: Gaps,
    /// Number of quantities in a list, each with a value per instance.
    pub columns: usize,
    /// By instance: the set-point that moving the sample holds. Empty if gaps are given.
    pub setpoints: Vec<SetPoint>,
    /// Arrangement of the instances as points of curves, if they are.
    pub curves: Option<CurveLayout>,
    /// Arrangement of the instances as all combinations of the values of some axes, if they are.
    pub grid: Option<Grid>,
}

/// All combinations of the positions along some axes; the last axis varies fastest.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Grid {
    pub axes: Vec<GridAxis>,
}

impl Grid {
    /// Number of instances.
    #[expect(clippy::len_without_is_empty, reason = "a grid has an instance at least")]
    pub fn len(&self) -> usize {
        self.axes.iter().map(|axis| axis.length as usize).product()
    }
}

/// An axis of a grid.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct GridAxis {
    /// Difference in number between instances that are adjacent along the axis.
    pub stride: u32,
    pub length: u32,
    /// Its positions by increasing value; empty if they are no values of one quantity: laws, labels, samples.
    pub order: Vec<u32>,
}

impl GridAxis {
    /// By position: its rank. Empty if the positions have no order.
    pub fn ranks(&self) -> Vec<u32> {
        let mut ranks = vec![0; self.order.len()];
        self.order.iter().enumerate().for_each(|(rank, place)| ranks[*place as usize] = rank as u32);
        ranks
    }
}

/// The axes of a grid whose positions have an order, each with the ranks.
#[derive(Clone, Debug)]
pub struct Ranks<'a>(pub Vec<(&'a GridAxis, Vec<u32>)>);

impl<'a> Ranks<'a> {
    /// The ordered axes of a grid.
    pub fn of(grid: &'a Grid) -> Self {
        let ordered = grid.axes.iter().filter(|axis| !axis.order.is_empty());
        Self(ordered.map(|axis| (axis, axis.ranks())).collect())
    }

    /// The number of an instance if all axes are sorted by increasing value. Results that depend on it do not depend on the
    /// direction of an axis.
    pub fn number(&self, instance: u32) -> u32 {
        self.0.iter().fold(instance, |number, (axis, ranks)| {
            let place = instance / axis.stride % axis.length;
            number - place * axis.stride + ranks[place as usize] * axis.stride
        })
    }

    /// The instance with this number.
    pub fn instance(&self, number: u32) -> u32 {
        self.0.iter().fold(number, |instance, (axis, _)| {
            let rank = number / axis.stride % axis.length;
            instance - rank * axis.stride + axis.order[rank as usize] * axis.stride
        })
    }
}

/// Curves of equal length, one after the other. If they are followed both ways, the points of the way back come after those of
/// the way there, in the same order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CurveLayout {
    /// On one way.
    pub points: u32,
    /// 1 or 2.
    pub ways: u32,
}

impl CurveLayout {
    /// The number of the instance's curve, and its position along it in the order of continuation.
    pub fn place(&self, id: InstanceId) -> (u32, u32) {
        let long = self.points * self.ways;
        let (curve, within) = (id.0 / long, id.0 % long);
        let back = within >= self.points;
        (curve, if back { long - 1 - (within - self.points) } else { within })
    }
}

/// One instrument at one drive.
#[derive(Clone, Debug)]
pub struct Drive {
    pub instrument: Arc<Instrument>,
    /// Motion without a sample.
    pub free: FreeMotion,
}

/// The contacts of all instances.
#[derive(Clone, Debug)]
pub(super) enum Contacts {
    /// The distinct contacts, and the number of each instance's.
    Shared { of: Codes, all: Vec<Compact> },
    /// Too many are distinct: they are made from the scene's cases on demand.
    Made(Box<Cases>),
}

/// The gaps of all instances, m. For set-points they are about where a hard sample would stand.
#[derive(Clone, Debug)]
pub(super) enum Gaps {
    /// By their bits: few are distinct.
    Coded(Interned<u64>),
    /// A column of the scene.
    Given(Arc<Vec<f64>>),
    Each(Vec<f64>),
}

/// The set-point of an instance, held by moving its sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SetPoint {
    pub held: Held,
    /// The requested branch, if both hold the set-point.
    pub branch: Option<ForceBranch>,
    /// Largest depth below the surface, m, if the scene gives it.
    pub deepest: Option<f64>,
}

impl Drive {
    /// Drive frequency, Hz.
    pub fn frequency(&self) -> f64 {
        self.free.omega / TAU
    }

    /// Amplitude of the tip without a sample, m.
    pub fn free_amplitude(&self) -> f64 {
        self.free.amplitude
    }

    /// Amplitude, m, of a tip that touches a sample beyond the reach of its free oscillation: slightly more than `gap` (m) if
    /// contact can tune the lever to the drive so far, else the free amplitude.
    pub fn swing(&self, gap: f64) -> f64 {
        let omega = self.free.omega;
        let at_resonance = |(k, mode): (usize, &Mode)| {
            let [detuning, damping] =
                [(mode.omega - omega) * (mode.omega + omega), omega * mode.omega / mode.quality_factor];
            let gain = detuning.hypot(damping) * mode.quality_factor / (mode.omega * mode.omega);
            (self.free.mode(k) * mode.tip).norm() * gain.max(1.0)
        };
        let most: f64 = self.instrument.modes.iter().enumerate().map(at_resonance).sum();
        if most > gap { FREE_AMPLITUDE_MARGIN * gap } else { self.free_amplitude() }
    }
}

impl Ensemble {
    /// Number of instances.
    pub fn len(&self) -> usize {
        self.drive_of.len()
    }

    /// Whether it has no instance.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The contact of an instance.
    pub fn contact(&self, id: InstanceId) -> Contact {
        match &self.contacts {
            Contacts::Shared { of, all } => all[of.get(id.0 as usize) as usize].contact(),
            Contacts::Made(cases) => {
                let frequency = self.drive(id).frequency();
                Compact::at_frequency(&cases.instance(id.0 as usize), frequency).contact()
            }
        }
    }

    /// The law of an instance's contact.
    pub fn law(&self, id: InstanceId) -> Law {
        match &self.contacts {
            Contacts::Shared { of, all } => all[of.get(id.0 as usize) as usize].law,
            Contacts::Made(_) => self.contact(id).law,
        }
    }

    /// Whether some sample is viscous. Contacts that are not stored count as if one were.
    pub(super) fn has_viscous(&self) -> bool {
        match &self.contacts {
            Contacts::Shared { all, .. } => all.iter().any(|one| one.law.is_viscous()),
            Contacts::Made(cases) => cases.base().sample.viscosity != Viscosity::None,
        }
    }

    /// Whether it stores its contacts.
    pub(super) fn holds_contacts(&self) -> bool {
        matches!(self.contacts, Contacts::Shared { .. })
    }

    /// The contacts of these instances, faster than one by one.
    pub(super) fn contacts_of(&self, ids: impl Iterator<Item = InstanceId>) -> Vec<Compact> {
        match &self.contacts {
            Contacts::Shared { of, all } => ids.map(|id| all[of.get(id.0 as usize) as usize]).collect(),
            Contacts::Made(cases) => {
                let mut params = cases.base();
                ids.map(|id| {
                    cases.put(&mut params, id.0 as usize);
                    Compact::at_frequency(&params, self.drive(id).frequency())
                })
                .collect()
            }
        }
    }

    /// The gap of an instance, m.
    pub fn gap(&self, id: InstanceId) -> f64 {
        let at = id.0 as usize;
        match &self.gaps {
            Gaps::Coded(gaps) => f64::from_bits(gaps.get(at)),
            Gaps::Given(gaps) => gaps[at],
            Gaps::Each(gaps) => gaps[at],
        }
    }

    /// The drive of an instance.
    pub fn drive(&self, id: InstanceId) -> &Arc<Drive> {
        &self.drives[self.drive_of.get(id.0 as usize) as usize]
    }
}

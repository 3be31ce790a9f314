//! A scene's needs as plain data that can be printed: the ensemble of its instances, which never changes, and plans, which say
//! which instances run and how finely.

mod assignment;
mod basis;
mod basis_rule;
mod classes;
mod compliance;
mod construction;
mod contact_rate;
mod curve_points;
mod derivation;
mod ensemble;
mod interning;
mod oscillator;
mod plan_error;
mod plan_summary;
mod policy;
mod precision;
mod rebasing;
mod residual_compliance;
mod resolution;
mod resonant_modes;
mod ringing;
mod shared_contacts;
mod steps;

pub(crate) use basis::RICHEST_ACCURACY_SHARE;
pub use basis::{ReducedBasis, STEPS_MAX};
pub use basis_rule::BasisRule;
pub use classes::{Class, Shape};
pub use compliance::{compliance, reduced};
pub use derivation::Resolution;
pub use ensemble::{CurveLayout, Drive, Ensemble, Grid, GridAxis, InstanceId, Ranks, SetPoint};
pub(crate) use interning::Interned;
pub use oscillator::KeptMode;
pub use plan_error::PlanError;
pub use plan_summary::PlanSummary;
pub use policy::Policy;
pub use precision::Precision;
pub use rebasing::Rebasing;
pub use resonant_modes::Resonance;
pub use steps::STEPS_MIN;

use crate::contact::{Compact, Contact, Law};
use crate::kernel::MODES_MAX;
use crate::observe::{Observable, Wants};
use crate::scene::{Run, WaveformRequest};
use resolution::{Ids, InstanceResolution, InstanceResolutions};
use std::ops::Deref;
use std::sync::Arc;

/// Some instances of an ensemble and how they run; the input of an engine. A scene's first plan has all instances;
/// refinements, samples, chunks and audits are plans of some of them, with their own steps, bases and starts. Data by instance
/// follow the plan's order: its instance `i` is the ensemble's `plan.id(i)`.
#[derive(Clone, Debug)]
pub struct Plan {
    pub ensemble: Arc<Ensemble>,
    /// Its instances.
    ids: Ids,
    /// Their resolutions.
    resolution: InstanceResolutions,
    /// Their contacts, if the ensemble does not store them.
    contacts: Option<Arc<Vec<Compact>>>,
    /// Drives with the bases that step them.
    pub drives: Vec<Driven>,
    pub observables: Vec<Observable>,
    pub wants: Wants,
    pub run: Run,
    pub precision: Precision,
    /// Whether `precision` is only a default that error control may change.
    pub precision_open: bool,
    /// The numbers that error control decides by.
    pub policy: Policy,
    /// Whether each instance's search ignores its neighbours' states.
    pub cold: bool,
    /// Requested waveforms.
    pub waveforms: Option<WaveformRequest>,
    /// Starts of the instances, instead of the scene's; their ends are then returned, too.
    pub starts: Option<Arc<Vec<StartState>>>,
}

/// Where an instance of a plan starts.
#[derive(Clone, Copy, Debug)]
pub struct StartState {
    pub section: SectionState,
    /// Lower bound on the change of a period over the distance to the periodic state; if it is unknown, the slowest mode's
    /// damping serves.
    pub least_change: Option<f64>,
}

impl From<SectionState> for StartState {
    fn from(station: SectionState) -> Self {
        Self { section: station, least_change: None }
    }
}

/// State of an instance at the section of its period: half a step after the start, before the kick. After the kept modes comes
/// the memory of a law that has one, as lengths: [`Plan::pairs`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SectionState {
    /// Tip travel by each kept mode beyond the steady free motion, m.
    pub x: [f64; MODES_MAX],
    /// Its rate over the mode's angular frequency, m.
    pub u: [f64; MODES_MAX],
    pub touching: bool,
    /// Whether all its numbers are finite.
    pub finite: bool,
}

impl SectionState {
    /// No deviation from the free motion, no contact.
    pub const FREE: Self = Self { x: [0.0; MODES_MAX], u: [0.0; MODES_MAX], touching: false, finite: true };

    /// The free oscillation of an instance as its sample appears.
    pub fn free(plan: &Plan, instance: u32) -> Self {
        let case = plan.case(instance);
        let amplitude = plan.driven(instance).free_amplitude();
        Self { touching: case.contact.next_contact(-(case.gap + amplitude), false), ..Self::FREE }
    }
}

/// A drive, and the basis that steps its instrument.
#[derive(Clone, Debug)]
pub struct Driven {
    pub drive: Arc<Drive>,
    /// The modes that carry the contact force's effect on the tip.
    pub kept: Arc<ReducedBasis>,
}

impl Deref for Driven {
    type Target = Drive;

    fn deref(&self) -> &Drive {
        &self.drive
    }
}

/// One instance of a plan.
#[derive(Clone, Copy, Debug)]
pub struct Case {
    /// Index into [`Plan::drives`].
    pub drive: u32,
    pub contact: Contact,
    /// m
    pub gap: f64,
    /// Steps per drive period; 0 if the free motion is the answer and nothing needs stepping.
    pub steps: u32,
    /// See [`StartState`].
    pub least_change: Option<f64>,
}

impl Plan {
    /// Number of instances.
    pub fn len(&self) -> usize {
        self.ids.len()
    }

    /// Whether it has no instance.
    pub fn is_empty(&self) -> bool {
        self.ids.len() == 0
    }

    /// The numbers of its instances.
    pub fn instances(&self) -> impl Iterator<Item = u32> + use<> {
        0..self.ids.len() as u32
    }

    /// The ensemble's number of an instance.
    pub fn id(&self, instance: u32) -> InstanceId {
        self.ids.get(instance)
    }

    /// All data of one instance.
    pub fn case(&self, instance: u32) -> Case {
        let contact = self.contact(instance);
        let InstanceResolution { gap, drive, steps } = self.resolution(instance);
        let least_change = self.starts.as_ref().and_then(|starts| starts[instance as usize].least_change);
        Case { drive, contact, gap, steps, least_change }
    }

    /// All instances, in order.
    pub fn cases(&self) -> impl Iterator<Item = Case> + '_ {
        self.instances().map(|instance| self.case(instance))
    }

    /// An instance's contact.
    pub fn contact(&self, instance: u32) -> Contact {
        match &self.contacts {
            Some(contacts) => contacts[instance as usize].contact(),
            None => self.ensemble.contact(self.id(instance)),
        }
    }

    /// The contacts of these instances, faster than one by one.
    ///
    /// One thread makes them: threads of a pool call this while they hold a lock that others of the pool wait for. If such a
    /// thread divided its work, it could take up work that waits for the same lock, and would wait for itself.
    pub fn contacts_of(&self, instances: &[u32]) -> Vec<Compact> {
        match &self.contacts {
            Some(contacts) => instances.iter().map(|i| contacts[*i as usize]).collect(),
            None => self.ensemble.contacts_of(instances.iter().map(|i| self.id(*i))),
        }
    }

    /// Whether its contacts are stored, so that none is made on demand.
    fn at_hand(&self) -> bool {
        self.contacts.is_some() || self.ensemble.holds_contacts()
    }

    fn resolution(&self, instance: u32) -> InstanceResolution {
        self.resolution.get(instance as usize, || self.ensemble.gap(self.id(instance)))
    }

    /// The law of an instance's contact, without the rest of it.
    pub fn law(&self, instance: u32) -> Law {
        match &self.contacts {
            Some(contacts) => contacts[instance as usize].law,
            None => self.ensemble.law(self.id(instance)),
        }
    }

    /// An instance's set-point, if its gap is not given.
    pub fn setpoint(&self, instance: u32) -> Option<SetPoint> {
        self.ensemble.setpoints.get(self.id(instance).0 as usize).copied()
    }

    /// Whether its instances have set-points: either all of a scene do, or none.
    pub fn has_setpoints(&self) -> bool {
        !self.ensemble.setpoints.is_empty()
    }

    /// Steps per drive period of an instance.
    pub fn steps(&self, instance: u32) -> u32 {
        self.resolution.steps(instance as usize)
    }

    /// An instance's instrument, drive and basis.
    pub fn driven(&self, instance: u32) -> &Driven {
        &self.drives[self.resolution.drive(instance as usize) as usize]
    }

    /// Pairs of numbers in an instance's section state: a travel and a rate of each kept mode, then its law's memory, if the
    /// law has one. No kept mode, no state.
    pub fn pairs(&self, instance: u32) -> usize {
        match self.driven(instance).kept.modes.len() {
            0 => 0,
            modes => modes + usize::from(self.law(instance).has_memory()),
        }
    }

    /// Whether an instance's free oscillation stays free of the sample.
    pub fn is_free(&self, instance: u32) -> bool {
        let Case { contact, gap, .. } = self.case(instance);
        contact.is_out_of_reach(self.driven(instance).free_amplitude(), gap)
    }

    /// Instances that need steps; the others are free of the sample.
    pub fn stepped(&self) -> Vec<u32> {
        self.instances().filter(|instance| self.steps(*instance) > 0).collect()
    }

    /// Steps of the whole run, summed over instances.
    pub fn instance_steps(&self) -> u64 {
        let per_period: u64 = self.instances().map(|instance| u64::from(self.steps(instance))).sum();
        per_period * u64::from(self.run.periods)
    }

    /// Expected largest indentation of an instance, m.
    pub fn expected_depth(&self, instance: u32) -> f64 {
        self.depth_of(&self.case(instance))
    }

    /// The same for a case of the plan.
    pub fn depth_of(&self, Case { drive, contact, gap, .. }: &Case) -> f64 {
        let driven = &self.drives[*drive as usize];
        steps::deepest(contact, driven.kept.inverse_mass(), driven.free.omega, driven.free_amplitude(), *gap)
    }
}

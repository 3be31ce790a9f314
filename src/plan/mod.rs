//! What a scene needs: modes, steps, laws and observables, as plain data that can be printed.

mod build;
mod compliance;
mod modes;
mod policy;
mod precision;
mod rate;
mod refusal;
mod ringing;
mod steps;
mod summary;
mod variants;

pub use build::PlanError;
pub use compliance::{compliance, reduced};
pub use modes::{BasisRule, KeptMode, ReducedBasis};
pub use policy::Policy;
pub use precision::Precision;
pub(crate) use rate::RICHEST;
pub use steps::{STEPS_MAX, STEPS_MIN};
pub use summary::Summary;

use crate::contact::{Contact, Law};
use crate::instrument::{FreeMotion, Instrument};
use crate::kernel::MODES_MAX;
use crate::observe::{Observable, Wants};
use crate::scene::{Run, WaveformRequest};
use std::sync::Arc;

/// Everything an engine needs to run a scene.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Distinct instruments under their drive.
    pub drives: Vec<Driven>,
    /// One per instance, in the scene's order.
    pub cases: Vec<CasePlan>,
    /// Instances that run in lockstep: one law, one number of modes, one number of steps.
    pub classes: Vec<Class>,
    pub observables: Vec<Observable>,
    pub wants: Wants,
    pub run: Run,
    pub precision: Precision,
    /// Whether `precision` is but a default, which error control may change by estimate.
    pub precision_open: bool,
    /// What error control decides by.
    pub policy: Policy,
    /// Waveforms asked for.
    pub waveforms: Option<WaveformRequest>,
    /// Where each instance starts, in place of the scene's start; where they end is then told too.
    pub stations: Option<Arc<Vec<Station>>>,
}

/// Where an instance stands at the start of a period of its drive: half a step into it, before the kick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Station {
    /// Tip travel by each kept mode beyond the steady free motion, m.
    pub x: [f64; MODES_MAX],
    /// Its rate over the mode's angular frequency, m.
    pub u: [f64; MODES_MAX],
    pub touching: bool,
    /// Whether all of it are numbers.
    pub finite: bool,
}

impl Station {
    /// No deviation from the free motion, no contact.
    pub const FREE: Self = Self { x: [0.0; MODES_MAX], u: [0.0; MODES_MAX], touching: false, finite: true };

    /// The free oscillation of an instance with its sample just there.
    pub fn free(plan: &Plan, instance: u32) -> Self {
        let case = &plan.cases[instance as usize];
        let amplitude = plan.drives[case.drive as usize].free.tip.norm();
        Self { touching: case.contact.next_contact(-(case.gap + amplitude), false), ..Self::FREE }
    }
}

/// One instrument at one drive.
#[derive(Clone, Debug)]
pub struct Driven {
    pub instrument: Arc<Instrument>,
    /// Motion without a sample.
    pub free: FreeMotion,
    /// The modes that carry the contact force's effect on the tip.
    pub kept: Arc<ReducedBasis>,
}

impl Driven {
    /// Drive frequency, Hz.
    pub fn frequency(&self) -> f64 {
        self.free.omega / std::f64::consts::TAU
    }
}

/// One instance.
#[derive(Clone, Copy, Debug)]
pub struct CasePlan {
    /// Index into [`Plan::drives`].
    pub drive: u32,
    pub contact: Contact,
    /// m
    pub gap: f64,
    /// Steps per drive period; 0 where the free motion is the answer and nothing needs stepping.
    pub steps: u32,
    /// A change from one period to the next is at least so large a share of the distance to the periodic
    /// state; where nothing is known of it, the slowest mode's damping stands for it.
    pub least_change: Option<f64>,
}

/// Instances of one shape.
#[derive(Clone, Debug, PartialEq)]
pub struct Class {
    pub law: Law,
    pub modes: usize,
    pub steps: u32,
    /// Instance numbers, ordered so that neighbours touch the sample at about the same time.
    pub instances: Vec<u32>,
}

impl Plan {
    /// Steps of the whole run, all instances together.
    pub fn instance_steps(&self) -> u64 {
        let per_period: u64 =
            self.classes.iter().map(|class| class.instances.len() as u64 * u64::from(class.steps)).sum();
        per_period * u64::from(self.run.periods)
    }

    /// An instance's instrument, drive and lever.
    pub fn driven(&self, instance: u32) -> &Driven {
        &self.drives[self.cases[instance as usize].drive as usize]
    }

    /// Deepest indentation to expect of an instance, m.
    pub fn expected_depth(&self, instance: usize) -> f64 {
        let case = &self.cases[instance];
        let driven = &self.drives[case.drive as usize];
        let mobility = driven.kept.mobility();
        steps::deepest(&case.contact, mobility, driven.free.omega, driven.free.tip.norm(), case.gap)
    }
}

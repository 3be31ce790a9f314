//! What is asked of single instances once all have their results: the answers are written down as they come, and found
//! again by all that they depend on.

use super::compact_orbit::CompactOrbit;
use crate::design::Mix;
use crate::engine::Finished;
use crate::orbit::PeriodicState;
use crate::plan::{Plan, Precision, SectionState};

/// What is asked. Codes of the journal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u8)]
pub enum FollowupKind {
    /// The periodic state that a search from a place finds.
    State = 0,
    /// The periodic state that a search from the lever at rest finds.
    FromRest = 1,
    /// What the reference engine makes of it.
    Truth = 2,
    /// Its waveforms.
    Waveforms = 3,
}

impl FollowupKind {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::State, Self::FromRest, Self::Truth, Self::Waveforms];
}

/// A question about one instance. Two are the same only if their answers are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct FollowupKey {
    pub kind: FollowupKind,
    /// By its number in the ensemble.
    pub instance: u32,
    /// Follows from where it begins, its steps, gap, basis and precision.
    pub from: u64,
}

impl FollowupKey {
    /// About an instance of a plan, which begins at a place, if that is known.
    pub fn new(what: FollowupKind, plan: &Plan, i: u32, place: Option<&SectionState>) -> Self {
        let fineness = plan.resolution_of(i);
        let mut mix = Mix::new(what as u64);
        let mut add = |number: u64| mix = mix.of(number);
        add(u64::from(fineness.steps));
        add(fineness.gap.to_bits());
        fineness.rule.key().into_iter().for_each(&mut add);
        add(u64::from(plan.precision == Precision::F64));
        add(u64::from(place.is_some()));
        if let Some(SectionState { x, u, touching, finite }) = place {
            x.iter().chain(u).for_each(|number| add(number.to_bits()));
            add(u64::from(*touching));
            add(u64::from(*finite));
        }
        Self { kind: what, instance: plan.id(i).0, from: mix.bits() }
    }
}

/// What became of it.
#[derive(Clone, Debug)]
pub struct FollowupResult {
    pub finished: Finished,
    /// The state, where one was asked for and found.
    pub orbit: Option<Box<CompactOrbit>>,
}

impl FollowupResult {
    /// Of what a search has found.
    pub(super) fn of_state(finished: Finished, found: Option<&PeriodicState>) -> Self {
        Self { finished, orbit: found.map(|state| Box::new(CompactOrbit::of(state))) }
    }

    /// As what a search of the plan's instance finds.
    pub(super) fn state(self, plan: &Plan, i: u32) -> (Finished, Option<Box<PeriodicState>>) {
        (self.finished, self.orbit.map(|place| place.state(plan, i)))
    }
}

/// The time of an audit that is ended by time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AuditBudget {
    /// What it may take, s.
    pub limit: f64,
    /// What it has taken, s.
    pub spent: f64,
}

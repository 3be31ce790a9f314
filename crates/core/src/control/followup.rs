//! Follow-up questions about single instances of a finished run. Answers are stored as they come. Their keys contain all that
//! they depend on.

use super::compact_orbit::CompactOrbit;
use crate::design::Mix;
use crate::engine::Finished;
use crate::orbit::PeriodicState;
use crate::plan::{Plan, Precision, SectionState};

/// The kind of question. The journal stores these codes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u8)]
pub enum FollowupKind {
    /// The periodic state found from a given section state.
    State = 0,
    /// The periodic state found from the lever at rest.
    FromRest = 1,
    /// The result of the reference engine.
    Truth = 2,
    /// Its waveforms.
    Waveforms = 3,
}

impl FollowupKind {
    /// All kinds.
    pub const ALL: [Self; 4] = [Self::State, Self::FromRest, Self::Truth, Self::Waveforms];
}

/// A question about one instance. Equal keys have equal answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct FollowupKey {
    pub kind: FollowupKind,
    /// Number of the instance in the ensemble.
    pub instance: u32,
    /// Hash of start, steps, gap, basis and precision.
    pub from: u64,
}

impl FollowupKey {
    /// A question about an instance of a plan that starts at `place`, if known.
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

/// The answer.
#[derive(Clone, Debug)]
pub struct FollowupResult {
    pub finished: Finished,
    /// The state, if one was requested and found.
    pub orbit: Option<Box<CompactOrbit>>,
}

impl FollowupResult {
    /// The answer of a search.
    pub(super) fn of_state(finished: Finished, found: Option<&PeriodicState>) -> Self {
        Self { finished, orbit: found.map(|state| Box::new(CompactOrbit::of(state))) }
    }

    /// The answer as the result and state of an instance of the plan.
    pub(super) fn state(self, plan: &Plan, i: u32) -> (Finished, Option<Box<PeriodicState>>) {
        (self.finished, self.orbit.map(|place| place.state(plan, i)))
    }
}

/// Time of an audit with a time limit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AuditBudget {
    /// Limit, s.
    pub limit: f64,
    /// Time spent, s.
    pub spent: f64,
}

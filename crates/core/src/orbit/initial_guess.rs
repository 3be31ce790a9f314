//! Initial guesses of searches, and the instances that searches leave without a state.

use super::PeriodicState;
use super::period_map::{rest_state, transfer_section};
use crate::plan::{Plan, SectionState};

/// Periods integrated before each search in turn, and whether a search follows. The first few periods lie past the first
/// contact and before the beats that follow it, in which no Newton step helps.
const WARM_UP_PERIODS: [(u32, bool); 3] = [(3, true), (32, true), (128, true)];
/// The same where only the settling motion is searched for.
const DEFERRED_WARM_UP_PERIODS: [(u32, bool); 1] = [(64, false)];

/// The initial guess of a search.
#[derive(Clone, Copy, Debug)]
pub(super) enum InitialGuess<'a> {
    /// The lever at rest.
    AtRest,
    /// States of the same instances with other steps or levers; the free oscillation where there is none.
    States(&'a [Option<&'a PeriodicState>]),
    /// `StatesOnce`: the same guesses (harmonic balance among them), but after one warm-up only. `Retry`: the other warm-ups,
    /// from the states where the first one ended.
    StatesOnce(&'a [Option<&'a PeriodicState>]),
    Retry(&'a [SectionState]),
    /// States with other steps or levers. An instance without one resembles others whose search failed: it is searched for
    /// from harmonic balance if it rings long, and else integrated for a while without a search.
    StatesOrDefer(&'a [Option<&'a PeriodicState>]),
    /// By instance: section states that integration has reached.
    Integrated(&'a [SectionState]),
    /// By instance: section states that are expected to be close to a periodic state.
    Points(&'a [SectionState]),
    /// The same, without a search from elsewhere when this one fails.
    PointsOnly(&'a [SectionState]),
    /// States reached along a curve. Where a search from one fails, the next starts there as from a free oscillation.
    CurveStates(&'a [Option<&'a PeriodicState>]),
    /// Predictions from a curve's last states; the search looks for states near them only.
    CurvePoints(CurvePrediction<'a>),
}

/// The predictor of a continuation step, by instance.
#[derive(Clone, Copy, Debug)]
pub(super) struct CurvePrediction<'a> {
    /// The last states.
    pub states: &'a [Option<&'a PeriodicState>],
    /// The predicted section states.
    pub places: &'a [SectionState],
    /// Evaluations, and new Jacobians at one evaluation per number of a state, that a search may take.
    pub max_evaluations: (u32, u32),
    /// Whether a converged state is accepted without a new Jacobian, so that its multiplier comes from updates of the last
    /// one. Empty if no state is.
    pub accept_unverified: &'a [bool],
}

impl InitialGuess<'_> {
    /// The instance's state with other steps or another lever, if its Jacobian is known.
    pub fn state(&self, instance: u32) -> Option<&PeriodicState> {
        match self {
            Self::States(near)
            | Self::StatesOnce(near)
            | Self::StatesOrDefer(near)
            | Self::CurveStates(near)
            | Self::CurvePoints(CurvePrediction { states: near, .. }) => {
                near.get(instance as usize).copied().flatten().filter(|place| place.jacobian.is_known())
            }
            Self::AtRest | Self::Points(_) | Self::PointsOnly(_) | Self::Integrated(_) | Self::Retry(_) => {
                None
            }
        }
    }

    /// Whether an instance without a state begins at its free oscillation.
    pub fn starts_free(&self) -> bool {
        matches!(self, Self::States(_) | Self::StatesOnce(_) | Self::StatesOrDefer(_))
    }

    /// Periods to integrate, and whether a search follows.
    pub fn warm_up(&self) -> &'static [(u32, bool)] {
        match self {
            Self::CurvePoints(..) | Self::Integrated(_) | Self::PointsOnly(_) => &[],
            Self::StatesOnce(_) => &WARM_UP_PERIODS[..1],
            Self::Retry(_) => &WARM_UP_PERIODS[1..],
            Self::StatesOrDefer(_) => &DEFERRED_WARM_UP_PERIODS,
            _ => &WARM_UP_PERIODS,
        }
    }

    /// The start of an instance without such a state.
    pub fn point(&self, plan: &Plan, instance: u32) -> SectionState {
        match self {
            Self::States(_) | Self::StatesOnce(_) | Self::StatesOrDefer(_) => {
                SectionState::free(plan, instance)
            }
            Self::AtRest => rest_state(plan, instance),
            Self::Points(places)
            | Self::PointsOnly(places)
            | Self::Integrated(places)
            | Self::Retry(places)
            | Self::CurvePoints(CurvePrediction { places, .. }) => places[instance as usize],
            Self::CurveStates(states) => match states[instance as usize] {
                Some(state) => transfer_section(plan, instance, state),
                None => SectionState::free(plan, instance),
            },
        }
    }
}

/// An instance without a state.
pub(super) struct Unconverged {
    /// Number in the plan.
    pub instance: u32,
    /// Its section state after `integrated` periods.
    pub section: SectionState,
    pub integrated: u32,
    /// Whether its motion shows no sign of settling.
    pub not_settling: bool,
}

impl Unconverged {
    /// An instance whose motion begins anew, at its free oscillation.
    pub fn anew(plan: &Plan, instance: u32) -> Self {
        Self { instance, section: SectionState::free(plan, instance), integrated: 0, not_settling: false }
    }
}

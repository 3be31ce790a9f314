//! Where searches begin, and where they leave what they do not find.

use super::PeriodicState;
use super::period_map::{rest_state, transfer_section};
use crate::plan::{Plan, SectionState};

/// Periods stepped before a search begins, and after one in vain before the next. The first few are past the beginning
/// of contact, and before the beats that follow it, in which no step is of use.
const WARM_UP_PERIODS: [(u32, bool); 3] = [(3, true), (32, true), (128, true)];
/// The same where no search follows before the motion has been looked at.
const DEFERRED_WARM_UP_PERIODS: [(u32, bool); 1] = [(64, false)];

/// Where searches begin.
#[derive(Clone, Copy, Debug)]
pub(super) enum InitialGuess<'a> {
    /// At rest.
    AtRest,
    /// At states of the same instances with other steps or levers, and where there is none at the free oscillation.
    States(&'a [Option<&'a PeriodicState>]),
    /// The same, but that the search is not repeated from later places; and these repetitions, from the places where the
    /// first search began.
    StatesOnce(&'a [Option<&'a PeriodicState>]),
    Retry(&'a [SectionState]),
    /// At states with other steps or levers alone. What has none, and is like others that were searched for in vain, is
    /// stepped on for a while.
    StatesOrDefer(&'a [Option<&'a PeriodicState>]),
    /// At these places, by instance, to which their motion has led.
    Integrated(&'a [SectionState]),
    /// At these places, by instance, which are thought to be next to a state.
    Points(&'a [SectionState]),
    /// The same, but that nothing else is looked for.
    PointsOnly(&'a [SectionState]),
    /// At states that a curve has led to. Where one leads to no other, the search begins there as at a free oscillation.
    CurveStates(&'a [Option<&'a PeriodicState>]),
    /// At places that a curve's last states lead to: what is not next to them is not looked for.
    CurvePoints(CurvePrediction<'a>),
}

/// How a curve goes on, by instance.
#[derive(Clone, Copy, Debug)]
pub(super) struct CurvePrediction<'a> {
    /// The last states.
    pub states: &'a [Option<&'a PeriodicState>],
    /// Where the next ones are expected.
    pub places: &'a [SectionState],
    /// Most evaluations, and Jacobians taken anew, of which each takes as many as a state has numbers.
    pub max_evaluations: (u32, u32),
    /// Whether a state is taken as it is met: of its spectrum it is only known what updates of the last Jacobian tell. Empty
    /// where none is.
    pub accept_unverified: &'a [bool],
}

impl InitialGuess<'_> {
    /// A state of the instance with other steps or another lever.
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

    /// Periods to be stepped, and whether a search follows.
    pub fn warm_up(&self) -> &'static [(u32, bool)] {
        match self {
            Self::CurvePoints(..) | Self::Integrated(_) | Self::PointsOnly(_) => &[],
            Self::StatesOnce(_) => &WARM_UP_PERIODS[..1],
            Self::Retry(_) => &WARM_UP_PERIODS[1..],
            Self::StatesOrDefer(_) => &DEFERRED_WARM_UP_PERIODS,
            _ => &WARM_UP_PERIODS,
        }
    }

    /// Where the instance begins without one.
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
    /// Of the plan.
    pub instance: u32,
    /// Where it was after so many periods.
    pub section: SectionState,
    pub integrated: u32,
    /// Whether it shows no sign of coming to rest.
    pub not_settling: bool,
}

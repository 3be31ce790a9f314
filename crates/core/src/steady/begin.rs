//! Where searches begin, and where they leave what they do not find.

use super::PeriodicState;
use super::map::{own, still};
use crate::plan::{Plan, Station};

/// Periods stepped before a search begins, and after one in vain before the next. The first few are past the beginning
/// of contact, and before the beats that follow it, in which no stride is of use.
const WARM: [(u32, bool); 3] = [(3, true), (32, true), (128, true)];
/// The same where no search follows before the motion has been looked at.
const ASIDE: [(u32, bool); 1] = [(64, false)];

/// Where searches begin.
#[derive(Clone, Copy, Debug)]
pub(super) enum Begin<'a> {
    /// At rest.
    Still,
    /// At states of the same instances with other steps or levers, and where there is none at the free oscillation.
    Near(&'a [Option<&'a PeriodicState>]),
    /// The same, but that the search is not repeated from later places; and these repetitions, from the places where the
    /// first search began.
    Brief(&'a [Option<&'a PeriodicState>]),
    Later(&'a [Station]),
    /// At states with other steps or levers alone. What has none, and is like others that were searched for in vain, is
    /// stepped on for a while.
    Aside(&'a [Option<&'a PeriodicState>]),
    /// At these places, by instance, to which their motion has led.
    Late(&'a [Station]),
    /// At these places, by instance, which are thought to be next to a state.
    At(&'a [Station]),
    /// The same, but that nothing else is looked for.
    NextTo(&'a [Station]),
    /// At states that a curve has led to. Where one leads to no other, the search begins there as at a free oscillation.
    Followed(&'a [Option<&'a PeriodicState>]),
    /// At places that a curve's last states lead to: what is not next to them is not looked for.
    Along(Along<'a>),
}

/// How a curve goes on, by instance.
#[derive(Clone, Copy, Debug)]
pub(super) struct Along<'a> {
    /// The last states.
    pub states: &'a [Option<&'a PeriodicState>],
    /// Where the next ones are expected.
    pub places: &'a [Station],
    /// Most evaluations, and slopes taken anew, of which each takes as many as a state has numbers.
    pub most: (u32, u32),
    /// Whether a state is taken as it is met: of its spectrum it is only known what updates of the last slope tell. Empty
    /// where none is.
    pub lightly: &'a [bool],
}

impl Begin<'_> {
    /// A state of the instance with other steps or another lever.
    pub fn known(&self, instance: u32) -> Option<&PeriodicState> {
        match self {
            Self::Near(near)
            | Self::Brief(near)
            | Self::Aside(near)
            | Self::Followed(near)
            | Self::Along(Along { states: near, .. }) => {
                near.get(instance as usize).copied().flatten().filter(|place| place.linear.is_known())
            }
            Self::Still | Self::At(_) | Self::NextTo(_) | Self::Late(_) | Self::Later(_) => None,
        }
    }

    /// Periods to be stepped, and whether a search follows.
    pub fn warm(&self) -> &'static [(u32, bool)] {
        match self {
            Self::Along(..) | Self::Late(_) | Self::NextTo(_) => &[],
            Self::Brief(_) => &WARM[..1],
            Self::Later(_) => &WARM[1..],
            Self::Aside(_) => &ASIDE,
            _ => &WARM,
        }
    }

    /// Where the instance begins without one.
    pub fn place(&self, plan: &Plan, instance: u32) -> Station {
        match self {
            Self::Near(_) | Self::Brief(_) | Self::Aside(_) => Station::free(plan, instance),
            Self::Still => still(plan, instance),
            Self::At(places)
            | Self::NextTo(places)
            | Self::Late(places)
            | Self::Later(places)
            | Self::Along(Along { places, .. }) => places[instance as usize],
            Self::Followed(states) => match states[instance as usize] {
                Some(state) => own(plan, instance, state),
                None => Station::free(plan, instance),
            },
        }
    }
}

/// An instance without a state.
pub(super) struct Left {
    /// Of the plan.
    pub instance: u32,
    /// Where it was after so many periods.
    pub place: Station,
    pub waited: u32,
    /// Whether it shows no sign of coming to rest.
    pub wanders: bool,
}

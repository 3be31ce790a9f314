//! What is known of solved instances when others begin at them.

use crate::engine::Finished;
use crate::plan::Plan;
use crate::steady::{Node, PeriodicState};

/// What others may rest on of an instance.
#[derive(Clone, Debug, Default)]
pub(super) enum Solved {
    /// Nothing.
    #[default]
    Unknown,
    /// Neither of its first two runs has found a state.
    Vain,
    /// The states of its first two runs.
    States(Box<[Node; 2]>),
}

impl Solved {
    /// The states of both.
    pub fn nodes(&self) -> Option<&[Node; 2]> {
        match self {
            Self::States(both) => Some(both),
            Self::Unknown | Self::Vain => None,
        }
    }
}

/// What an instance's guess rests on: another instance, its weight, and its weight where only the nearest count.
pub(super) type Weighted = (u32, f64, f64);

/// What later instances may rest on of one, by its first two runs: a plan, its number there, its result, and its state.
pub(super) fn solved(
    (first, i, before, rough): (&Plan, u32, &Finished, Option<&PeriodicState>),
    (second, there, after, fine): (&Plan, u32, &Finished, Option<&PeriodicState>),
) -> Solved {
    let (Some(rough), Some(fine)) = (rough, fine) else {
        let neither = rough.is_none() && fine.is_none() && second.steps(there) > 0;
        return if neither { Solved::Vain } else { Solved::Unknown };
    };
    match (Node::new(first, i, rough, before), Node::new(second, there, fine, after)) {
        (Some(rough), Some(fine)) => Solved::States(Box::new([rough, fine])),
        _ => Solved::Unknown,
    }
}

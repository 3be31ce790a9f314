//! States of solved instances from which others may start.

use crate::engine::Finished;
use crate::orbit::{PeriodicState, SolvedNeighbour};
use crate::plan::Plan;

/// What an instance offers to others.
#[derive(Clone, Debug, Default)]
pub(super) enum OrbitPair {
    /// Nothing is known.
    #[default]
    Unknown,
    /// Neither of its first two runs found a state.
    Vain,
    /// The states of its first two runs.
    States(Box<[SolvedNeighbour; 2]>),
}

impl OrbitPair {
    /// The states of both runs.
    pub fn neighbours(&self) -> Option<&[SolvedNeighbour; 2]> {
        match self {
            Self::States(both) => Some(both),
            Self::Unknown | Self::Vain => None,
        }
    }
}

/// A point of a stencil: the instance, its weight, and its weight if only the nearest count.
pub(super) type WeightedPoint = (u32, f64, f64);

/// Makes the pair from an instance's first two runs. Each is given by its plan, the number there, its result and its state.
/// The first state is consumed.
pub(super) fn orbit_pairs(
    (first, i, before, rough): (&Plan, u32, &Finished, Option<Box<PeriodicState>>),
    (second, there, after, fine): (&Plan, u32, &Finished, Option<&PeriodicState>),
) -> OrbitPair {
    let (rough, fine) = match (rough, fine) {
        (Some(rough), Some(fine)) => (rough, fine),
        (None, None) if second.steps(there) > 0 => return OrbitPair::Vain,
        _ => return OrbitPair::Unknown,
    };
    let both = || {
        let of_rough = rough.jacobian.undoes()?;
        let of_fine = fine.jacobian.undoes()?;
        let rough = SolvedNeighbour::new((first, i), &rough, of_rough, Some(before))?;
        Some([rough, SolvedNeighbour::new((second, there), fine, of_fine, Some(after))?])
    };
    both().map_or(OrbitPair::Unknown, |both| OrbitPair::States(Box::new(both)))
}

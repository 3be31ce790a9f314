//! Solved instances as neighbours in a sweep, and the stencils that predict an instance from them.

use super::PeriodicState;
use super::period_map::section_numbers;
use crate::contact::Law;
use crate::engine::Finished;
use crate::plan::{Drive, Plan, ReducedBasis};
use std::sync::Arc;

/// A periodic state, and the resolvent of the period map there.
#[derive(Clone, Debug)]
pub struct SolvedNeighbour {
    /// Travel of the kept modes, then rate over angular frequency, m.
    pub(super) state: Box<[f64]>,
    /// (I - J)^-1 of the map's Jacobian J, column by column; see [`Jacobian::Resolvent`](super::Jacobian::Resolvent).
    pub(super) resolvent: Arc<[f32]>,
    pub(super) multiplier: f64,
    pub(super) touching: bool,
    /// Whether the mean force attracts the tip, and contacts per period: states with different counts move differently.
    pub(super) attractive: bool,
    contacts: f64,
    pub(super) law: Law,
    pub(super) steps: u32,
    pub(super) kept: Arc<ReducedBasis>,
    pub(super) drive: Arc<Drive>,
}

impl SolvedNeighbour {
    /// The neighbour of an instance with this state and resolvent; `None` unless a search found it steady. An instance's own
    /// state in another run needs no result: other instances never start from it.
    pub fn new(
        (plan, instance): (&Plan, u32),
        state: &PeriodicState,
        undoes: Arc<[f32]>,
        finished: Option<&Finished>,
    ) -> Option<Self> {
        if !state.is_solved() || finished.is_some_and(|one| !one.status.is_steady()) {
            return None;
        }
        Some(Self {
            state: section_numbers(&state.section, undoes.len().isqrt() / 2),
            resolvent: undoes,
            multiplier: state.floquet.multiplier,
            touching: state.section.touching,
            attractive: finished.is_some_and(|one| one.measured.force_mean < 0.0),
            contacts: finished.map_or(f64::NAN, |one| one.measured.contacts.round()),
            law: plan.law(instance),
            steps: state.steps,
            kept: Arc::clone(&state.basis),
            drive: Arc::clone(&plan.driven(instance).drive),
        })
    }

    /// Whether both move alike: under one law, in the same contact, with equally many contacts.
    pub fn same_regime(&self, other: &Self) -> bool {
        let contacts = self.contacts == other.contacts || self.contacts.is_nan() || other.contacts.is_nan();
        let touching = self.touching == other.touching || !self.law.has_hysteresis();
        touching && self.law == other.law && contacts
    }
}

/// One of the neighbours in a prediction.
#[derive(Clone, Copy, Debug)]
pub struct StencilPoint<'a> {
    pub node: &'a SolvedNeighbour,
    /// The same instance's state with the steps and the lever of the run before, if the prediction starts from the instance's
    /// own state in that run.
    pub before: Option<&'a SolvedNeighbour>,
    /// Its weight among all neighbours, and among the nearest alone.
    pub weight: f64,
    pub nearest: f64,
}

/// How an instance starts from its neighbours.
#[derive(Clone, Debug)]
pub enum StencilStart<'a> {
    Stencil(Stencil<'a>),
    /// A search has failed; each neighbour alone may lead to the state.
    EachPoint(Vec<StencilPoint<'a>>),
    /// Its neighbours' searches have failed: no search is tried until the motion settles.
    Postponed,
    /// The neighbours are no guide.
    None,
}

impl<'a> StencilStart<'a> {
    /// A start from each of these alone.
    pub fn each(nodes: impl Iterator<Item = &'a SolvedNeighbour>) -> Self {
        Self::EachPoint(
            nodes.map(|node| StencilPoint { node, before: None, weight: 1.0, nearest: 1.0 }).collect(),
        )
    }

    pub(super) fn stencil(&self) -> Option<&Stencil<'a>> {
        match self {
            Self::Stencil(hint) => Some(hint),
            Self::EachPoint(_) | Self::Postponed | Self::None => None,
        }
    }

    /// Neighbours to try one by one after a search has failed.
    pub(super) fn alone(&self) -> Vec<StencilPoint<'a>> {
        match self {
            Self::Stencil(hint) if hint.own_state.is_none() => {
                hint.nearest_two().into_iter().flatten().collect()
            }
            Self::EachPoint(neighbours) => neighbours.clone(),
            _ => Vec::new(),
        }
    }
}

/// The neighbours that predict an instance's state.
#[derive(Clone, Debug, Default)]
pub struct Stencil<'a> {
    pub neighbours: Vec<StencilPoint<'a>>,
    /// The instance's own state in the run before; the neighbours give the difference between the two runs.
    pub own_state: Option<&'a PeriodicState>,
    /// Whether the neighbours lie around the instance, the nearest first; otherwise they lie along a line, in its order.
    pub scattered: bool,
}

impl<'a> From<Stencil<'a>> for StencilStart<'a> {
    fn from(hint: Stencil<'a>) -> Self {
        Self::Stencil(hint)
    }
}

impl<'a> Stencil<'a> {
    /// One neighbour's state as it is.
    pub(super) fn alone(neighbour: StencilPoint<'a>) -> Self {
        let neighbour = StencilPoint { weight: 1.0, nearest: 1.0, ..neighbour };
        Self { neighbours: vec![neighbour], own_state: None, scattered: false }
    }

    /// The nearest neighbour on either side along a line; `None` if the neighbours lie around the instance.
    pub(super) fn nearest_two(&self) -> Option<[StencilPoint<'a>; 2]> {
        let mut nearest = self.neighbours.iter().filter(|one| one.nearest != 0.0);
        let two = [*nearest.next()?, *nearest.next()?];
        (!self.scattered).then_some(two)
    }
}

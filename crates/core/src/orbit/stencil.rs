//! A solved instance as its neighbours in a sweep see it, and which of them may lead to one between them.

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
    /// The inverse of one minus the map's Jacobian, column by column; see [`Jacobian::Resolvent`](super::Jacobian::Resolvent).
    pub(super) resolvent: Arc<[f32]>,
    pub(super) multiplier: f64,
    pub(super) touching: bool,
    /// Whether the mean force draws the tip, and contacts in a period: where they differ, so does the motion.
    pub(super) attractive: bool,
    contacts: f64,
    pub(super) law: Law,
    pub(super) steps: u32,
    pub(super) kept: Arc<ReducedBasis>,
    pub(super) drive: Arc<Drive>,
}

impl SolvedNeighbour {
    /// Of an instance that was found steady, and the resolvent of its map; none where it was not.
    pub fn new(
        (plan, instance): (&Plan, u32),
        state: &PeriodicState,
        undoes: Arc<[f32]>,
        finished: &Finished,
    ) -> Option<Self> {
        if !state.is_solved() || !finished.status.is_steady() {
            return None;
        }
        Some(Self {
            state: section_numbers(&state.section, undoes.len().isqrt() / 2),
            resolvent: undoes,
            multiplier: state.floquet.multiplier,
            touching: state.section.touching,
            attractive: finished.measured.force_mean < 0.0,
            contacts: finished.measured.contacts.round(),
            law: plan.law(instance),
            steps: state.steps,
            kept: Arc::clone(&state.basis),
            drive: Arc::clone(&plan.driven(instance).drive),
        })
    }

    /// Of an instance's own state in another run, as others never see it; none where nothing is known of the map's Jacobian there.
    pub(super) fn of_own_state(plan: &Plan, instance: u32, state: &PeriodicState) -> Option<Self> {
        let undoes = state.jacobian.undoes().filter(|_| state.is_solved())?;
        Some(Self {
            state: section_numbers(&state.section, undoes.len().isqrt() / 2),
            resolvent: undoes,
            multiplier: state.floquet.multiplier,
            touching: state.section.touching,
            attractive: false,
            contacts: f64::NAN,
            law: plan.law(instance),
            steps: state.steps,
            kept: Arc::clone(&state.basis),
            drive: Arc::clone(&plan.driven(instance).drive),
        })
    }

    /// Whether both move alike: under one law, in the same contact, as often.
    pub fn same_regime(&self, other: &Self) -> bool {
        let contacts = self.contacts == other.contacts || self.contacts.is_nan() || other.contacts.is_nan();
        let touching = self.touching == other.touching || !self.law.has_memory();
        touching && self.law == other.law && contacts
    }
}

/// One of the neighbours that a guess is made of.
#[derive(Clone, Copy, Debug)]
pub struct StencilPoint<'a> {
    pub node: &'a SolvedNeighbour,
    /// The same instance's state with the steps and the lever of the run before, where the guess is made from the
    /// instance's own state in that run.
    pub before: Option<&'a SolvedNeighbour>,
    /// Its weight, and the one by the nearest alone.
    pub weight: f64,
    pub nearest: f64,
}

/// Where neighbours lead an instance.
#[derive(Clone, Debug)]
pub enum StencilStart<'a> {
    Stencil(Stencil<'a>),
    /// A search has found nothing: each of them alone may lead to it.
    EachPoint(Vec<StencilPoint<'a>>),
    /// No search is to be tried.
    Skip,
    /// They are no guide.
    None,
}

impl<'a> StencilStart<'a> {
    /// Each of these alone.
    pub fn each(nodes: impl Iterator<Item = &'a SolvedNeighbour>) -> Self {
        Self::EachPoint(
            nodes.map(|node| StencilPoint { node, before: None, weight: 1.0, nearest: 1.0 }).collect(),
        )
    }

    pub(super) fn stencil(&self) -> Option<&Stencil<'a>> {
        match self {
            Self::Stencil(hint) => Some(hint),
            Self::EachPoint(_) | Self::Skip | Self::None => None,
        }
    }

    /// Those of which each alone may lead to it where a search does not.
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

/// What is known of an instance before it is stepped.
#[derive(Clone, Debug, Default)]
pub struct Stencil<'a> {
    pub neighbours: Vec<StencilPoint<'a>>,
    /// The instance's own state in the run before; the neighbours tell how far the two runs are apart.
    pub own_state: Option<&'a PeriodicState>,
    /// Whether the neighbours lie around it, the nearest first; else along a line, in its order.
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

    /// The nearest on either side of an instance on a line; none where neighbours lie around it.
    pub(super) fn nearest_two(&self) -> Option<[StencilPoint<'a>; 2]> {
        let mut nearest = self.neighbours.iter().filter(|one| one.nearest != 0.0);
        let two = [*nearest.next()?, *nearest.next()?];
        (!self.scattered).then_some(two)
    }
}

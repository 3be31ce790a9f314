//! Instances whose neighbours' states are close together but give no prediction. If the neighbours move differently, with one
//! contact more or less in a period, their resolvents are no guide, but their states still are.

use super::OrbitSolution;
use super::initial_guess::InitialGuess;
use super::period_map::{distance, section};
use super::size_dispatch::{BySize, by_size, with_size};
use super::stencil::StencilStart;
use super::transfer_cache::TransferCache;
use super::verification::search_and_verify;
use crate::engine::{Engine, EngineError, Progress};
use crate::periodic::{Memory, Size};
use crate::plan::{Plan, SectionState};
use nalgebra::{DefaultAllocator, DimName};

/// Largest distance of the two nearest states from their midpoint, in free amplitudes; beyond it they may be two branches.
/// With 0.02 in place of it half as many are found so at quality factors of 1000 and 1e4.
const MAX_MIDPOINT_DISTANCE: f64 = 0.1;
/// A state lies between two if its distance from their midpoint is at most this many times theirs.
const MIDPOINT_REACH: f64 = 1.5;

/// An instance, the midpoint of its two nearest neighbours' states, and their distance from it, m.
type Midpoint = (u32, SectionState, f64);

impl OrbitSolution {
    /// Restarts instances whose stencil gave no state from the midpoint of the two nearest neighbours, with the map's own
    /// Jacobian there. Accepts a state only if it lies between the two.
    pub(super) fn restart_at_midpoints(
        &mut self,
        plan: &Plan,
        leads: &[StencilStart],
        engine: &dyn Engine,
        progress: &Progress,
    ) -> Result<(), EngineError> {
        let lost = |i: &u32| self.found[*i as usize].is_none() && leads[*i as usize].stencil().is_some();
        let instances: Vec<u32> = plan.instances().filter(|i| plan.steps(*i) > 0 && lost(i)).collect();
        let middles: Vec<Midpoint> = by_size(plan, &instances)
            .into_iter()
            .flat_map(|(size, some)| with_size(size, MidpointSearch { plan, some: &some, leads }))
            .collect();
        if middles.is_empty() || progress.stopped() {
            return Ok(());
        }
        let numbers: Vec<u32> = middles.iter().map(|middle| middle.0).collect();
        let places: Vec<SectionState> = middles.iter().map(|middle| middle.1).collect();
        let part = plan.part(&numbers);
        let all: Vec<u32> = part.instances().collect();
        let (mut own, _) =
            search_and_verify(&part, &all, InitialGuess::PointsOnly(&places), engine, progress)?;
        for (n, (_, place, far)) in middles.iter().enumerate() {
            if own.state(n).is_some_and(|state| distance(&state.section, place) > MIDPOINT_REACH * far) {
                own.drop_state(n as u32);
            }
        }
        self.take(&numbers, own);
        Ok(())
    }
}

/// Instances whose states have equally many numbers.
struct MidpointSearch<'a> {
    plan: &'a Plan,
    some: &'a [u32],
    /// By instance of the plan.
    leads: &'a [StencilStart<'a>],
}

impl BySize for MidpointSearch<'_> {
    type Output = Vec<Midpoint>;

    fn run<D: Size + DimName>(self) -> Self::Output
    where
        DefaultAllocator: Memory<D>,
    {
        let Self { plan, some, leads } = self;
        let mut turns = TransferCache::<D>::new();
        let middle = |i: &u32| {
            let (state, far, touching) = leads[*i as usize].stencil()?.midpoint(plan, *i, &mut turns)?;
            let near = far <= MAX_MIDPOINT_DISTANCE * plan.driven(*i).free_amplitude();
            near.then(|| (*i, section(state.as_slice(), touching), far))
        };
        some.iter().filter_map(middle).collect()
    }
}

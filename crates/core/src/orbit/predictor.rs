//! The predictor: an instance's state from the states of its solved neighbours.

use super::period_map::vector;
use super::stencil::{Stencil, StencilPoint};
use super::transfer_cache::{StatePrediction, TransferCache, TransferTarget};
use crate::periodic::{Memory, Size};
use crate::plan::Plan;
use nalgebra::{DefaultAllocator, DimName, OVector};

/// If two interpolations, from many neighbours and from the nearest alone, differ by more than this share of the free
/// amplitude, the neighbours are no guide.
const MAX_SPREAD: f64 = 0.02;
/// The two nearest neighbours are on different branches if they are this many times farther apart than those beyond them.
const FOLD_RATIO: f64 = 4.0;

impl Stencil<'_> {
    /// The state that the neighbours predict. `None` if they are no guide: they move differently, disagree, or one of them is
    /// not clearly stable.
    pub(super) fn predict<'t, D: Size + DimName>(
        &self,
        plan: &Plan,
        instance: u32,
        turns: &'t mut TransferCache<D>,
    ) -> Option<&'t StatePrediction<D>>
    where
        DefaultAllocator: Memory<D>,
    {
        let first = self.neighbours.first()?.node;
        let stable = super::tolerances::stable_below(plan, instance);
        let counts = |one: &StencilPoint| !self.scattered || one.nearest != 0.0;
        let sound = |one: &StencilPoint| {
            one.node.same_regime(first) && (!counts(one) || one.node.multiplier < stable)
        };
        if !self.neighbours.iter().all(sound) || first.law != plan.law(instance) {
            return None;
        }
        let meets = TransferTarget::new(plan, instance);
        turns.prepare(meets, &self.neighbours);
        let mut states = std::mem::take(&mut turns.states);
        states.resize_with(self.neighbours.len(), OVector::<f64, D>::zeros);
        let met = self.neighbours.iter().zip(&turns.transfers);
        met.zip(&mut states).for_each(|((one, [met, _]), state)| turns.state(meets, one.node, *met, state));
        let scale = meets.driven.free_amplitude().max(1e-15);
        let jumps = self.own_state.is_none() && !self.scattered && self.crosses_fold(&states, scale);
        let apart = if jumps { f64::NAN } else { self.interpolate(meets, &mut states, turns) / scale };
        turns.states = states;
        if let Some(own) = self.own_state {
            if own.section.touching != first.touching && first.law.has_hysteresis() {
                return None;
            }
            let met = turns.transfer_of(meets, (&own.basis, own.steps));
            let mut moved = OVector::<f64, D>::zeros();
            turns.transfer_state(vector::<D>(&own.section).as_slice(), met, &mut moved);
            turns.prediction.state_for += moved;
        }
        if jumps || !(self.own_state.is_some() || self.scattered || apart <= MAX_SPREAD) {
            return None;
        }
        turns.sum_resolvents(meets, &self.neighbours);
        turns.prediction.touching = first.touching;
        Some(&turns.prediction)
    }

    /// Interpolates the neighbours' states, or their change since the run before, into the prediction. Returns the distance,
    /// m, from the interpolation between the nearest alone.
    fn interpolate<D: Size + DimName>(
        &self,
        meets: TransferTarget,
        states: &mut [OVector<f64, D>],
        turns: &mut TransferCache<D>,
    ) -> f64
    where
        DefaultAllocator: Memory<D>,
    {
        let (mut all, mut nearest) = (OVector::<f64, D>::zeros(), OVector::<f64, D>::zeros());
        let (mut theirs, mut multiplier) = (OVector::<f64, D>::zeros(), 0.0);
        for ((one, state), [_, met]) in self.neighbours.iter().zip(states).zip(&turns.transfers) {
            if let Some(before) = one.before {
                turns.state(meets, before, *met, &mut theirs);
                *state -= &theirs;
            }
            all.axpy(one.weight, state, 1.0);
            nearest.axpy(one.nearest, state, 1.0);
            multiplier += one.nearest * one.node.multiplier;
        }
        let apart = (&all - nearest).norm();
        (turns.prediction.state_for, turns.prediction.multiplier) = (all, multiplier);
        apart
    }

    /// The point between the two nearest neighbours on a line, their distance from it, m, and whether the tip touches there.
    /// `None` if only one of the two touches, or if the instance's own state is known.
    pub(super) fn midpoint<D: Size + DimName>(
        &self,
        plan: &Plan,
        instance: u32,
        turns: &mut TransferCache<D>,
    ) -> Option<(OVector<f64, D>, f64, bool)>
    where
        DefaultAllocator: Memory<D>,
    {
        let two = self.nearest_two().filter(|_| self.own_state.is_none())?;
        let [a, b] = two.map(|one| one.node);
        let one_contact = a.touching == b.touching || !a.law.has_hysteresis();
        if !one_contact || [a, b].iter().any(|node| node.law != plan.law(instance)) {
            return None;
        }
        let meets = TransferTarget::new(plan, instance);
        turns.prepare(meets, &two);
        let mut states = [OVector::<f64, D>::zeros(), OVector::<f64, D>::zeros()];
        let met = [a, b].into_iter().zip(&turns.transfers);
        met.zip(&mut states).for_each(|((node, [met, _]), state)| turns.state(meets, node, *met, state));
        let middle = &states[0] * two[0].nearest + &states[1] * two[1].nearest;
        let far = states.iter().map(|state| (state - &middle).norm()).fold(0.0, f64::max);
        Some((middle, far, a.touching))
    }

    /// Whether the two nearest are on different branches: far apart compared with those beyond them. Of two alone, one is
    /// attracted by the sample and the other is not.
    fn crosses_fold<D: Size>(&self, states: &[OVector<f64, D>], scale: f64) -> bool
    where
        DefaultAllocator: Memory<D>,
    {
        let all = &self.neighbours;
        let inner = |n: usize| all[n].nearest != 0.0 && all[n + 1].nearest != 0.0;
        let (mut between, mut beyond) = (0.0f64, None::<f64>);
        for n in 0..all.len().saturating_sub(1) {
            let apart = (&states[n + 1] - &states[n]).norm();
            match inner(n) {
                true => between = between.max(apart),
                false => beyond = Some(beyond.unwrap_or(0.0).max(apart)),
            }
        }
        match beyond {
            Some(beyond) => between > MAX_SPREAD * scale && between > FOLD_RATIO * beyond,
            None => all.iter().any(|one| one.node.attractive != all[0].node.attractive),
        }
    }
}

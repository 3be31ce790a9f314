//! Transfers of solved instances' states to an instance with other steps, another lever or another drive.

use super::free_jacobian::{free_resolvent, recovery};
use super::period_map::BasisTransfer;
use super::stencil::{SolvedNeighbour, StencilPoint};
use crate::periodic::{Memory, Size};
use crate::plan::{Driven, Plan, ReducedBasis};
use nalgebra::{DefaultAllocator, DimName, OMatrix, OVector};
use std::sync::Arc;

/// The predicted state of an instance, the resolvent there, and the largest multiplier.
pub(super) struct StatePrediction<D: Size>
where
    DefaultAllocator: Memory<D>,
{
    pub state_for: OVector<f64, D>,
    /// (I - J)^-1 of the map's Jacobian J.
    pub resolvent: OMatrix<f64, D, D>,
    pub multiplier: f64,
    pub touching: bool,
}

/// Transfers between steps, levers and drives, each pair computed once because there are few, and buffers for the prediction
/// of one instance after the other.
pub(super) struct TransferCache<D: Size>
where
    DefaultAllocator: Memory<D>,
{
    cached: Vec<CachedTransfer>,
    /// The resolvent of the free lever to which one was transferred last.
    free: Option<FreeResolvent<D>>,
    /// Results by the address of the levers, which serve most look-ups.
    lookups: Vec<TransferLookup>,
    /// For each neighbour of an instance, and for its state in the run before: the transfer.
    pub transfers: Vec<[Option<usize>; 2]>,
    pub states: Vec<OVector<f64, D>>,
    /// Neighbours with the same transfer, and the sums of their resolvents, one after the other.
    transfer_sums: Vec<TransferSum>,
    sums: Vec<f64>,
    /// Their transferred resolvents.
    transferred_resolvent: OMatrix<f64, D, D>,
    pub prediction: StatePrediction<D>,
}

/// Pairs, and look-ups by address, beyond which the cache is cleared: each instance may have its own lever.
const MAX_TRANSFERS: usize = 64;
const MAX_LOOKUPS: usize = 16;

struct CachedTransfer {
    source: (Arc<ReducedBasis>, u32),
    target: (Arc<ReducedBasis>, u32),
    /// Angular frequency of the drive, rad/s.
    omega: f64,
    transfer: BasisTransfer,
}

/// The resolvent of a free lever under a drive of angular frequency `omega` (rad/s), with a law that forgets at the rate
/// `recovery` (1/s), if it remembers anything.
struct FreeResolvent<D: Size>
where
    DefaultAllocator: Memory<D>,
{
    lever: Arc<ReducedBasis>,
    omega: f64,
    recovery: Option<f64>,
    resolvent: OMatrix<f64, D, D>,
}

/// A pair by the address of its levers; `None` if the state needs no transfer.
struct TransferLookup {
    source: (Arc<ReducedBasis>, u32),
    target: (Arc<ReducedBasis>, u32),
    omega: f64,
    transfer: Option<usize>,
}

/// Neighbours with the same transfer and equally many numbers: the sum of their weights, and the first index of their sum.
struct TransferSum {
    transfer: usize,
    share: f64,
    from: usize,
    count: usize,
}

/// An instance to which states are transferred.
#[derive(Clone, Copy)]
pub(super) struct TransferTarget<'a> {
    plan: &'a Plan,
    instance: u32,
    steps: u32,
    pub driven: &'a Driven,
}

impl<'a> TransferTarget<'a> {
    pub fn new(plan: &'a Plan, instance: u32) -> Self {
        Self { plan, instance, steps: plan.steps(instance), driven: plan.driven(instance) }
    }
}

impl<D: Size + DimName> TransferCache<D>
where
    DefaultAllocator: Memory<D>,
{
    pub fn new() -> Self {
        let zeros = OMatrix::<f64, D, D>::zeros;
        Self {
            cached: Vec::new(),
            free: None,
            lookups: Vec::new(),
            transfers: Vec::new(),
            states: Vec::new(),
            transfer_sums: Vec::new(),
            sums: Vec::new(),
            transferred_resolvent: zeros(),
            prediction: StatePrediction {
                state_for: OVector::<f64, D>::zeros(),
                resolvent: zeros(),
                multiplier: 0.0,
                touching: false,
            },
        }
    }

    /// The transfer to an instance of a state with these steps and this lever; `None` if it needs none.
    pub fn transfer_of(
        &mut self,
        meets: TransferTarget,
        (kept, steps): (&Arc<ReducedBasis>, u32),
    ) -> Option<usize> {
        let driven = meets.driven;
        let same = |one: &TransferLookup| {
            (one.source.1, one.target.1) == (steps, meets.steps)
                && Arc::ptr_eq(&one.source.0, kept)
                && Arc::ptr_eq(&one.target.0, &driven.kept)
                && one.omega == driven.free.omega
        };
        if let Some(known) = self.lookups.iter().rev().find(|one| same(one)) {
            return known.transfer;
        }
        let as_it_is = steps == meets.steps && same_modes(&driven.kept, kept);
        let pair = (!as_it_is).then(|| self.pair(meets, (kept, steps)));
        self.lookups.push(TransferLookup {
            source: (Arc::clone(kept), steps),
            target: (Arc::clone(&driven.kept), meets.steps),
            omega: driven.free.omega,
            transfer: pair,
        });
        pair
    }

    /// The index of the pair of levers, which is computed if it is new.
    fn pair(
        &mut self,
        TransferTarget { plan, instance, steps, driven }: TransferTarget,
        theirs: (&Arc<ReducedBasis>, u32),
    ) -> usize {
        let fits = |turn: &CachedTransfer| {
            turn.omega == driven.free.omega
                && (turn.source.1, turn.target.1) == (theirs.1, steps)
                && (Arc::ptr_eq(&turn.target.0, &driven.kept) || turn.target.0.modes == driven.kept.modes)
                && same_modes(&turn.source.0, theirs.0)
        };
        self.cached.iter().rposition(fits).unwrap_or_else(|| {
            self.cached.push(CachedTransfer {
                source: (Arc::clone(theirs.0), theirs.1),
                target: (Arc::clone(&driven.kept), steps),
                omega: driven.free.omega,
                transfer: BasisTransfer::new(plan, instance, (theirs.0, theirs.1), D::DIM / 2),
            });
            self.cached.len() - 1
        })
    }

    /// Begins with an instance: finds the transfer of each neighbour.
    pub fn prepare(&mut self, meets: TransferTarget, neighbours: &[StencilPoint]) {
        if self.cached.len() >= MAX_TRANSFERS {
            self.cached.clear();
            self.lookups.clear();
        }
        if self.lookups.len() >= MAX_LOOKUPS {
            self.lookups.clear();
        }
        self.transfers.clear();
        for StencilPoint { node, before, .. } in neighbours {
            let met = self.transfer_of(meets, (&node.kept, node.steps));
            let met_before = before.and_then(|node| self.transfer_of(meets, (&node.kept, node.steps)));
            self.transfers.push([met, met_before]);
        }
    }

    /// Writes a node's state, transferred to the instance's steps and lever and scaled to its free amplitude.
    pub fn state(
        &self,
        meets: TransferTarget,
        node: &SolvedNeighbour,
        met: Option<usize>,
        state: &mut OVector<f64, D>,
    ) {
        self.transfer_state(&node.state, met, state);
        let drive = &meets.driven.drive;
        if !Arc::ptr_eq(drive, &node.drive) {
            let scale = drive.free_amplitude() / node.drive.free_amplitude();
            *state *= if scale.is_finite() { scale } else { 1.0 };
        }
    }

    /// Writes a transferred state without scaling it to the free amplitude.
    pub fn transfer_state(&self, theirs: &[f64], met: Option<usize>, state: &mut OVector<f64, D>) {
        match met {
            None => state.copy_from_slice(theirs),
            Some(pair) => self.cached[pair].transfer.transfer(theirs, state),
        }
    }

    /// The weighted sum of the neighbours' resolvents. Those with the same transfer are added first and transferred once.
    pub fn sum_resolvents(&mut self, meets: TransferTarget, neighbours: &[StencilPoint]) {
        let all = &mut self.prediction.resolvent;
        all.fill(0.0);
        self.transfer_sums.clear();
        self.sums.clear();
        for (StencilPoint { node, weight, .. }, [met, _]) in neighbours.iter().zip(&self.transfers) {
            let sums = match met {
                None => all.as_mut_slice(),
                Some(pair) => {
                    let count = node.resolvent.len();
                    let same = |one: &TransferSum| (one.transfer, one.count) == (*pair, count);
                    let place = self.transfer_sums.iter().position(same).unwrap_or_else(|| {
                        self.transfer_sums.push(TransferSum {
                            transfer: *pair,
                            share: 0.0,
                            from: self.sums.len(),
                            count,
                        });
                        self.sums.resize(self.sums.len() + count, 0.0);
                        self.transfer_sums.len() - 1
                    });
                    let alike = &mut self.transfer_sums[place];
                    alike.share += weight;
                    &mut self.sums[alike.from..][..count]
                }
            };
            sums.iter_mut().zip(&*node.resolvent).for_each(|(sum, value)| *sum += weight * f64::from(*value));
        }
        if self.transfer_sums.is_empty() {
            return;
        }
        let free = FreeResolvent::kept_or_new(&mut self.free, meets);
        for TransferSum { transfer: pair, share, from, count } in &self.transfer_sums {
            self.transferred_resolvent.copy_from(free);
            self.transferred_resolvent *= *share;
            self.cached[*pair]
                .transfer
                .transfer_jacobian::<D>(&self.sums[*from..][..*count], &mut self.transferred_resolvent);
            *all += &self.transferred_resolvent;
        }
    }
}

impl<D: Size + DimName> FreeResolvent<D>
where
    DefaultAllocator: Memory<D>,
{
    /// The resolvent of an instance's free lever: the kept one if it is the same lever's.
    fn kept_or_new<'a>(kept: &'a mut Option<Self>, meets: TransferTarget) -> &'a OMatrix<f64, D, D> {
        let (lever, omega) = (&meets.driven.kept, meets.driven.free.omega);
        let recovery = recovery(meets.plan, meets.instance);
        let same = |one: &Self| {
            (one.omega, one.recovery) == (omega, recovery)
                && (Arc::ptr_eq(&one.lever, lever) || one.lever.modes == lever.modes)
        };
        let known = kept.take().filter(same);
        let one = known.unwrap_or_else(|| {
            let resolvent = free_resolvent(meets.plan, meets.instance);
            Self { lever: Arc::clone(lever), omega, recovery, resolvent }
        });
        &kept.insert(one).resolvent
    }
}

/// Whether two bases have the same modes. Levers that are scaled copies have the same section phase.
fn same_modes(a: &Arc<ReducedBasis>, b: &Arc<ReducedBasis>) -> bool {
    Arc::ptr_eq(a, b) || a.copies(b)
}

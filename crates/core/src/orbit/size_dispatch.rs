//! Sizes of states: code is compiled for some numbers of modes, and any other number uses the next larger one.

use crate::kernel::broyden::STATE_MODES;
use crate::periodic::{Memory, Size};
use crate::plan::Plan;
use nalgebra::{Const, DefaultAllocator, DimName};

/// Work on states of one size.
pub(super) trait BySize {
    type Output;

    fn run<D: Size + DimName>(self) -> Self::Output
    where
        DefaultAllocator: Memory<D>;
}

/// Runs `work` for one of the numbers of modes that [`by_size`] returns.
pub(super) fn with_size<W: BySize>(modes: usize, work: W) -> W::Output {
    match modes {
        1 => work.run::<Const<2>>(),
        2 => work.run::<Const<4>>(),
        3 => work.run::<Const<6>>(),
        4 => work.run::<Const<8>>(),
        6 => work.run::<Const<12>>(),
        8 => work.run::<Const<16>>(),
        12 => work.run::<Const<24>>(),
        16 => work.run::<Const<32>>(),
        _ => work.run::<Const<48>>(),
    }
}

/// Groups these instances by the number of modes of their padded states, in order. Modes that a lever lacks are at rest.
pub(super) fn by_size(plan: &Plan, instances: &[u32]) -> Vec<(usize, Vec<u32>)> {
    let mut groups = STATE_MODES.map(|size| (size, Vec::new()));
    for i in instances {
        let modes = plan.pairs(*i);
        let place = STATE_MODES.iter().position(|size| modes <= *size).unwrap_or(STATE_MODES.len() - 1);
        groups[place].1.push(*i);
    }
    groups.into_iter().filter(|(_, group)| !group.is_empty()).collect()
}

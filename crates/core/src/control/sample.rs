//! A sample of the instances, from the softest to the stiffest contact of each kind.

use crate::plan::Plan;
use rayon::prelude::*;
use std::iter::successors;

/// A sample of `stepped`, from the softest to the stiffest contact of each kind.
pub(super) fn sample(plan: &Plan, stepped: &[u32]) -> Vec<u32> {
    spread(plan, &by_stiffness(plan, stepped))
}

/// Evenly spread over instances in their order, and ever closer towards the stiffest of each kind: those are what a basis
/// fails, and all that stand beyond the last member that it serves pay for a richer one.
pub(super) fn spread(plan: &Plan, order: &[u32]) -> Vec<u32> {
    let every = order.len().div_ceil(plan.policy.sample).max(1);
    let mut places: Vec<usize> = (0..order.len()).step_by(every).collect();
    let mut end = 0;
    for members in kinds(plan, order) {
        end += members.len();
        let from_end = successors(Some(1), |distance| Some(2 * distance));
        let closer = from_end.take_while(|distance| *distance < every && *distance <= members.len());
        places.extend(closer.map(|distance| end - distance));
    }
    places.sort_unstable();
    places.dedup();
    places.into_iter().map(|place| order[place]).collect()
}

/// What instances have in common that stand side by side in a sample: their law, and whether contact ends with a strong jump of
/// its force, which moves modes that a contact as stiff without one leaves at rest.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct Kind {
    law: u8,
    jumps: bool,
}

/// Where an instance stands: its kind, and its contact's stiffness at the deepest indentation to expect, over the lever's; under
/// DMT at least the slope of the attraction just outside, which a tip feels that never touches.
pub(super) fn standing(plan: &Plan, instance: u32) -> (Kind, f64) {
    let case = plan.case(instance);
    let (contact, depth, law) = (&case.contact, plan.depth_of(&case), plan.law(instance));
    let strong = || -contact.law().pull_off() >= plan.policy.strong_jump * contact.force(depth, true);
    let kind = Kind { law: law.code(), jumps: law.has_memory() && strong() };
    let pressed = contact.stiffness(depth, true).abs();
    (kind, pressed.max(contact.law().attraction_slope()) * plan.driven(instance).kept.flexibility)
}

pub(super) fn kind(plan: &Plan, instance: u32) -> Kind {
    standing(plan, instance).0
}

/// By kind, then stiffness.
pub(super) fn by_stiffness(plan: &Plan, stepped: &[u32]) -> Vec<u32> {
    // Kind, stiffness and number in one number that is ordered as they are.
    let key = |part: &Plan, n: u32, i: u32| -> u128 {
        let (kind, stiffness) = standing(part, n);
        let bits = stiffness.to_bits();
        let ordered = if bits >> 63 == 1 { !bits } else { bits | 1 << 63 };
        (u128::from(kind.law) << 1 | u128::from(kind.jumps)) << 96 | u128::from(ordered) << 32 | u128::from(i)
    };
    let mut keyed = plan.of_each(stepped, key);
    keyed.par_sort_unstable();
    keyed.into_iter().map(|key| key as u32).collect()
}

/// The instances of each kind, which stand together.
fn kinds<'a>(plan: &'a Plan, order: &'a [u32]) -> impl Iterator<Item = &'a [u32]> {
    let mut rest = order;
    std::iter::from_fn(move || {
        let first = kind(plan, *rest.first()?);
        let (group, others) = rest.split_at(rest.partition_point(|i| kind(plan, *i) == first));
        rest = others;
        Some(group)
    })
}

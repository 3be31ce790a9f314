//! A sample of the instances, from the softest to the stiffest contact of each kind.

use crate::plan::{Plan, Ranks};
use rayon::prelude::*;
use std::iter::successors;

/// A sample of `stepped`, from the softest to the stiffest contact of each kind.
pub(super) fn sample(plan: &Plan, stepped: &[u32]) -> Vec<u32> {
    spread(plan, &by_stiffness(plan, stepped))
}

/// Spreads the sample evenly over the instances in their order, and ever closer towards the stiffest of each kind. A basis
/// fails the stiffest first, and all instances beyond the last member that it serves need a richer one.
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

/// Instances of one kind are adjacent in a sample. They share their law, and whether contact ends with a strong jump of the
/// force, which excites modes that an equally stiff contact without a jump does not.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct ContactKind {
    law: u8,
    jumps: bool,
}

/// Kind of an instance, and its contact's stiffness at the deepest expected indentation relative to the lever's: that of a
/// viscous sample at the rate of the contact. Under DMT it is at least the slope of the attraction just outside, which even a
/// tip that never touches feels.
pub(super) fn kind_and_stiffness(plan: &Plan, instance: u32) -> (ContactKind, f64) {
    let case = plan.case(instance);
    let (contact, depth, law) = (&case.contact, plan.depth_of(&case), plan.law(instance));
    let strong = || -contact.law().pull_off() >= plan.policy.strong_jump * contact.force(depth, true);
    let kind = ContactKind { law: law.code(), jumps: law.jumps() && strong() };
    let driven = plan.driven(instance);
    let rate = if contact.viscous_time() > 0.0 { driven.contact_rate(contact, case.gap) } else { 0.0 };
    let pressed = contact.stiffness_at(depth, rate);
    (kind, pressed.max(contact.law().attraction_slope()) * driven.kept.flexibility)
}

pub(super) fn kind(plan: &Plan, instance: u32) -> ContactKind {
    kind_and_stiffness(plan, instance).0
}

/// Sorts by kind, then stiffness. The order of equal ones does not depend on the direction of an axis.
pub(super) fn by_stiffness(plan: &Plan, stepped: &[u32]) -> Vec<u32> {
    let ranks = plan.ensemble.grid.as_ref().filter(|grid| grid.len() == plan.len()).map(Ranks::of);
    // One integer that sorts by kind, then stiffness, then number.
    let key = |part: &Plan, n: u32, i: u32| -> u128 {
        let (kind, stiffness) = kind_and_stiffness(part, n);
        let bits = stiffness.to_bits();
        let ordered = if bits >> 63 == 1 { !bits } else { bits | 1 << 63 };
        let number = ranks.as_ref().map_or(i, |ranks| ranks.number(i));
        (u128::from(kind.law) << 1 | u128::from(kind.jumps)) << 96
            | u128::from(ordered) << 32
            | u128::from(number)
    };
    let mut keyed = plan.of_each(stepped, key);
    keyed.par_sort_unstable();
    let instance = |key: u128| ranks.as_ref().map_or(key as u32, |ranks| ranks.instance(key as u32));
    keyed.into_iter().map(instance).collect()
}

/// The instances of each kind, which are adjacent.
fn kinds<'a>(plan: &'a Plan, order: &'a [u32]) -> impl Iterator<Item = &'a [u32]> {
    let mut rest = order;
    std::iter::from_fn(move || {
        let first = kind(plan, *rest.first()?);
        let (group, others) = rest.split_at(rest.partition_point(|i| kind(plan, *i) == first));
        rest = others;
        Some(group)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_plans::plan_of;

    /// Truth: the same sweep with reversed axes. Under DMT the stiffness of a contact does not depend on the work of
    /// adhesion.
    #[test]
    fn a_sample_has_the_same_members_in_either_direction_of_an_axis() {
        let sweep = |energies: &str, moduli: &str| {
            let text = format!(
                r#"
                [instrument.cantilever]
                modes = [{{ stiffness = "40 N/m", frequency = "300 kHz", quality_factor = 100 }}]
                [contact]
                law = "dmt"
                [drive]
                on = "tip"
                frequency = "300 kHz"
                free_amplitude = "20 nm"
                [approach]
                gap = "17 nm"
                [sweep]
                "sample.surface_energy" = {{ values = [{energies}] }}
                "sample.youngs_modulus" = {{ values = [{moduli}] }}
                "#
            );
            let plan = plan_of(&text);
            let order = by_stiffness(&plan, &plan.stepped());
            let one = |i: u32| {
                let contact = plan.contact(i);
                [contact.work, contact.modulus].map(f64::to_bits)
            };
            order.into_iter().map(one).collect::<Vec<_>>()
        };
        let there = sweep(r#""1 mJ/m^2", "2 mJ/m^2", "5 mJ/m^2""#, r#""1 GPa", "2 GPa""#);
        let back = sweep(r#""5 mJ/m^2", "2 mJ/m^2", "1 mJ/m^2""#, r#""2 GPa", "1 GPa""#);
        assert_eq!(there.len(), 6);
        assert_eq!(there, back);
    }
}

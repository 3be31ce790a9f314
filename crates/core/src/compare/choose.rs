//! Which instances to look at more closely.

use crate::plan::Plan;

/// Instance numbers, at most `count` of those that are stepped (of a plan that steps none, of all), in order: for each half of them, from
/// opposite ends, the softest and stiffest, stickiest and most remote contacts, and others at random.
///
/// The choice hangs on the plan and `seed` alone.
pub fn choose(plan: &Plan, count: usize, seed: u64) -> Vec<u32> {
    let stepped = plan.stepped();
    let among = if stepped.is_empty() { plan.instances().collect() } else { stepped };
    let mut chosen = ranked(plan, among, count, seed);
    chosen.sort_unstable();
    chosen
}

/// The same of the instances `among`, those at random and the extreme ones by turns: what is left undone at the end is of
/// both.
pub fn ranked(plan: &Plan, among: Vec<u32>, count: usize, seed: u64) -> Vec<u32> {
    if among.len() <= count {
        return among;
    }
    let keys: [fn(&Plan, u32) -> f64; 4] = [
        |plan, i| plan.expected_depth(i),
        |plan, i| plan.contact(i).modulus,
        |plan, i| plan.contact(i).work * plan.contact(i).radius,
        |plan, i| plan.case(i).gap,
    ];
    let mut chosen: Vec<u32> = Vec::new();
    for key in keys {
        let value = |i: &&u32| key(plan, **i);
        let by = |a: &&u32, b: &&u32| value(a).total_cmp(&value(b));
        for extreme in [among.iter().min_by(by), among.iter().max_by(by)].into_iter().flatten() {
            if chosen.len() < count.div_ceil(2) && !chosen.contains(extreme) {
                chosen.push(*extreme);
            }
        }
    }
    let extreme = chosen.len();
    let mut state = seed;
    while chosen.len() < count {
        // SplitMix64 (Steele, Lea & Flood 2014): enough to pick by.
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut mixed = state;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        let place = (mixed ^ (mixed >> 31)) % among.len() as u64;
        let one = among[place as usize];
        if !chosen.contains(&one) {
            chosen.push(one);
        }
    }
    let (extreme, random) = chosen.split_at(extreme);
    (0..count).flat_map(|n| [random.get(n), extreme.get(n)]).flatten().copied().collect()
}

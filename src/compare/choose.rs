//! Which instances to look at more closely.

use crate::plan::Plan;

/// Instance numbers, at most `count` of those that are stepped (of a plan that steps none, of all), in order: for each half of them, from
/// opposite ends, the softest and stiffest, stickiest and most remote contacts, and others at random.
///
/// The choice hangs on the plan and `seed` alone.
pub fn choose(plan: &Plan, count: usize, seed: u64) -> Vec<u32> {
    let mut chosen = ranked(plan, count, seed);
    chosen.sort_unstable();
    chosen
}

/// The same, those at random and the extreme ones by turns: what is left undone at the end is of both.
pub fn ranked(plan: &Plan, count: usize, seed: u64) -> Vec<u32> {
    let all = |free: bool| plan.classes.iter().filter(move |class| (class.steps == 0) == free);
    let some = if all(false).next().is_some() { all(false) } else { all(true) };
    let mut stepped: Vec<u32> = some.flat_map(|class| class.instances.clone()).collect();
    stepped.sort_unstable();
    if stepped.len() <= count {
        return stepped;
    }
    let keys: [fn(&Plan, usize) -> f64; 4] = [
        |plan, i| plan.expected_depth(i),
        |plan, i| plan.cases[i].contact.modulus,
        |plan, i| plan.cases[i].contact.work * plan.cases[i].contact.radius,
        |plan, i| plan.cases[i].gap,
    ];
    let mut chosen: Vec<u32> = Vec::new();
    for key in keys {
        let value = |i: &&u32| key(plan, **i as usize);
        let by = |a: &&u32, b: &&u32| value(a).total_cmp(&value(b));
        for extreme in [stepped.iter().min_by(by), stepped.iter().max_by(by)].into_iter().flatten() {
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
        let place = (mixed ^ (mixed >> 31)) % stepped.len() as u64;
        let one = stepped[place as usize];
        if !chosen.contains(&one) {
            chosen.push(one);
        }
    }
    let (extreme, random) = chosen.split_at(extreme);
    (0..count).flat_map(|n| [random.get(n), extreme.get(n)]).flatten().copied().collect()
}

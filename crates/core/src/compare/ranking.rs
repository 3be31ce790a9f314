//! The choice of instances for a closer look.

use crate::plan::Plan;

/// At most `count` instances, in order, of those that are stepped, or of all if none is. Half of them are extreme: the
/// softest and stiffest, stickiest and most remote contacts. The others are random.
///
/// The choice depends on the plan and `seed` alone.
pub fn choose(plan: &Plan, count: usize, seed: u64) -> Vec<u32> {
    let stepped = plan.stepped();
    let among = if stepped.is_empty() { plan.instances().collect() } else { stepped };
    let mut chosen = ranked(plan, &among, count, seed);
    chosen.sort_unstable();
    chosen
}

/// Chooses like [`choose`], from `among`. Random and extreme instances alternate, so a stopped audit has some of both.
pub fn ranked(plan: &Plan, among: &[u32], count: usize, seed: u64) -> Vec<u32> {
    let mut ranking = Ranking::default();
    if among.len() > count {
        among.iter().for_each(|i| ranking.offer(*i, plan, *i));
    }
    ranking.chosen((among.len(), &|place| among[place]), count, seed)
}

/// Quantities whose extremes are chosen.
const KEYS: [fn(&Plan, u32) -> f64; 4] = [
    |plan, i| plan.expected_depth(i),
    |plan, i| plan.contact(i).modulus,
    |plan, i| plan.contact(i).work * plan.contact(i).radius,
    |plan, i| plan.case(i).gap,
];

/// The most extreme of the instances that were offered, in any order.
#[derive(Clone, Debug, Default)]
pub struct Ranking {
    /// For each key the least and the greatest instance. Of equal ones, these are the first and the last.
    extremes: [Option<[(f64, u32); 2]>; KEYS.len()],
}

impl Ranking {
    /// Considers an instance, which is number `n` of the plan.
    pub fn offer(&mut self, instance: u32, plan: &Plan, n: u32) {
        for (extremes, key) in self.extremes.iter_mut().zip(KEYS) {
            let one = (key(plan, n), instance);
            let before = |a: &(f64, u32), b: &(f64, u32)| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)).is_lt();
            let [least, greatest] = extremes.get_or_insert([one; 2]);
            if before(&one, least) {
                *least = one;
            }
            if before(greatest, &one) {
                *greatest = one;
            }
        }
    }

    /// Chooses `count` of `all` instances, which `at` gives by their place; all if there are no more.
    pub fn chosen(&self, (all, at): (usize, &dyn Fn(usize) -> u32), count: usize, seed: u64) -> Vec<u32> {
        if all <= count {
            return (0..all).map(at).collect();
        }
        let mut chosen: Vec<u32> = Vec::new();
        for (_, extreme) in self.extremes.iter().flatten().flatten() {
            if chosen.len() < count.div_ceil(2) && !chosen.contains(extreme) {
                chosen.push(*extreme);
            }
        }
        let extreme = chosen.len();
        let mut state = seed;
        while chosen.len() < count {
            // SplitMix64 (Steele, Lea & Flood 2014), good enough for this choice.
            state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
            let mut mixed = state;
            mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
            let one = at(((mixed ^ (mixed >> 31)) % all as u64) as usize);
            if !chosen.contains(&one) {
                chosen.push(one);
            }
        }
        let (extreme, random) = chosen.split_at(extreme);
        (0..count).flat_map(|n| [random.get(n), extreme.get(n)]).flatten().copied().collect()
    }
}

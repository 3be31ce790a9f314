// Instances under way: those that a search has neither found nor lost.

// How many are under way in each round and after the last; then which these are, in two lists that take turns.
@group(0) @binding(7) var<storage, read> going: array<u32>;

fn under_way() -> u32 {
    return going[job.round];
}

fn instance_of(number: u32) -> u32 {
    return going[listed(job.round, number)];
}

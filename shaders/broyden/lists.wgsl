// Where a round's list of the instances under way has its `number`.
fn listed(round: u32, number: u32) -> u32 {
    return ROUNDS + 1u + (round & 1u) * job.instances + number;
}

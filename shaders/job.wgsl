// The job, which thread of it one is, and where fields are.
// Names in capitals come from the generated head (crates/kernel/src/shader.rs).

// What one dispatch does.
struct Job {
    // Instances, and rows of the table of drives.
    instances: u32,
    drives: u32,
    // Steps per period; the first step of this dispatch within its period; steps of this dispatch, or the
    // numbers of a state.
    steps: u32,
    first: u32,
    count: u32,
    // Workgroups side by side in x.
    width: u32,
    // The round of a search, from 0; a run is one.
    round: u32,
}

@group(0) @binding(0) var<uniform> job: Job;

fn thread(group: vec3<u32>, local: u32) -> u32 {
    return (group.y * job.width + group.x) * WORKGROUP + local;
}

// Where a round's list of the instances under way has its `number`.
fn listed(round: u32, number: u32) -> u32 {
    return ROUNDS + 1u + (round & 1u) * job.instances + number;
}

// Where a field of an instance is in a table.
fn at(field: u32, i: u32) -> u32 {
    return field * job.instances + i;
}

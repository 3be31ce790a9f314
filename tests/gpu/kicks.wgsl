// One kick per thread: behind a shader's head and its law.

struct Job {
    instances: u32,
}

@group(0) @binding(0) var<uniform> job: Job;
// Constants of the law: [field][instance], the first one not used here.
@group(0) @binding(1) var<storage, read> cases: array<real>;
// Indentation, speed, acceleration and touching before: [4][instance].
@group(0) @binding(2) var<storage, read> approaches: array<real>;
// Impulse, share in contact, touching after and shift: [4][instance].
@group(0) @binding(3) var<storage, read_write> kicks: array<real>;

fn at(field: u32, i: u32) -> u32 {
    return field * job.instances + i;
}

@compute @workgroup_size(WORKGROUP)
fn kick(@builtin(global_invocation_id) id: vec3<u32>) {
    let i = id.x;
    if i >= job.instances {
        return;
    }
    // Of a law with a memory, one that remembers nothing.
    var approach: Approach;
    approach.indentation = approaches[at(0u, i)];
    approach.speed = approaches[at(1u, i)];
    approach.acceleration = approaches[at(2u, i)];
    let kick = law_kick(law_of(i), approach, approaches[at(3u, i)]);
    kicks[at(0u, i)] = kick.impulse;
    kicks[at(1u, i)] = kick.contact;
    kicks[at(2u, i)] = kick.touching;
    kicks[at(3u, i)] = kick.shift;
}

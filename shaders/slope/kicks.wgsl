// A period's slope, first part: one thread takes one instance through a dispatch's steps and writes down those of its kicks
// that may have a slope. Twin: crates/kernel/src/tangent.rs
// Whether a step's kick is one of them, the steps before and after it tell: each is decided on when the next is done.

// Cosine and sine of the drive's phase: [step][2].
@group(0) @binding(1) var<storage, read> waves: array<real>;
// Constants of each driven instrument: [field][drive].
@group(0) @binding(2) var<storage, read> drives: array<real>;
// Constants of each instance: [field][instance].
@group(0) @binding(3) var<storage, read> cases: array<real>;
// Which drive each instance has.
@group(0) @binding(4) var<storage, read> drive_of: array<u32>;
// Where each instance is, and what the last two steps saw: [field][instance].
@group(0) @binding(5) var<storage, read_write> states: array<real>;
// Steps done, steps since the last kick written down, kicks of this dispatch, and steps before each of these without one:
// [3 + kick][instance].
@group(0) @binding(6) var<storage, read_write> marks: array<u32>;
// What they change by with each number of their approach: [kick][the impulse's three, the shift's three][instance]. Where the law
// has a memory, more follow, as crates/kernel/src/tangent.rs says.
@group(0) @binding(7) var<storage, read_write> partials: array<real>;
// How many instances are under way in each round and after the last; then which these are, in lists that take turns.
@group(0) @binding(8) var<storage, read> going: array<u32>;

// What a step's kick was given, and what it did: the size of its impulse and the share of the step in contact.
struct Seen {
    at: Approach,
    touching: real,
    size: real,
    contact: real,
}

fn see(lever: Case, law: Law, state: ptr<function, State>, cosine: real, sine: real) -> Seen {
    var decay: Decay;
    let touching = (*state).touching;
    let met = meet(lever, *state, cosine, sine, decay);
    let kick = law_kick(law, met.at, touching);
    *state = fly(lever, *state, kick);
    return Seen(met.at, touching, abs(kick.impulse), kick.contact);
}

// Whether a kick's size changes by less than `little` of the way from one step to the other.
fn flat(a: Seen, b: Seen, little: real) -> bool {
    return abs(a.size - b.size) < little * abs(a.at.indentation - b.at.indentation);
}

fn acts(here: Seen, before: Seen, after: Seen, little: real) -> bool {
    let steep = !(flat(here, before, little) && flat(here, after, little));
    return ZERO < here.contact || (ZERO < here.size && steep);
}

// Something that is not zero.
fn some(by: vec3<real>) -> bool {
    return by.x != ZERO || by.y != ZERO || by.z != ZERO;
}

// Whether a kick has a slope at all.
fn slopes(by: KickSlope, by_memory: KickSlope) -> bool {
    var some_slope = some(by.impulse) || some(by.shift);
    //% each memory
    some_slope = some_slope || some(by.memory_x) || some(by.memory_u);
    some_slope = some_slope || some(by_memory.impulse) || some(by_memory.shift);
    some_slope = some_slope || some(by_memory.memory_x) || some(by_memory.memory_u);
    //% end
    return some_slope;
}

fn write_down(i: u32, kick: u32, by: KickSlope, by_memory: KickSlope) {
    let first = kick * PARTIALS;
    partials[at(first, i)] = by.impulse.x;
    partials[at(first + 1u, i)] = by.impulse.y;
    partials[at(first + 2u, i)] = by.impulse.z;
    //% if shifts
    partials[at(first + 3u, i)] = by.shift.x;
    partials[at(first + 4u, i)] = by.shift.y;
    partials[at(first + 5u, i)] = by.shift.z;
    //% end
    //% each memory
    partials[at(first + 6u, i)] = by_memory.impulse.x;
    partials[at(first + 7u, i)] = by_memory.impulse.y;
    partials[at(first + 8u, i)] = by_memory.shift.x;
    partials[at(first + 9u, i)] = by_memory.shift.y;
    partials[at(first + 10u, i)] = by.memory_x.x;
    partials[at(first + 11u, i)] = by.memory_x.y;
    partials[at(first + 12u, i)] = by.memory_x.z;
    partials[at(first + 13u, i)] = by_memory.memory_x.x;
    partials[at(first + 14u, i)] = by_memory.memory_x.y;
    partials[at(first + 15u, i)] = by.memory_u.x;
    partials[at(first + 16u, i)] = by.memory_u.y;
    partials[at(first + 17u, i)] = by.memory_u.z;
    partials[at(first + 18u, i)] = by_memory.memory_u.x;
    partials[at(first + 19u, i)] = by_memory.memory_u.y;
    //% end
}

// The last step seen, and of the one before it what its neighbour asks.
fn here_of(i: u32) -> Seen {
    var at_sample: Approach;
    at_sample.indentation = states[at(HERE_INDENTATION, i)];
    at_sample.speed = states[at(HERE_SPEED, i)];
    at_sample.acceleration = states[at(HERE_ACCELERATION, i)];
    //% each memory
    at_sample.memory_x = states[at(HERE_MEMORY_X, i)];
    at_sample.memory_u = states[at(HERE_MEMORY_U, i)];
    //% end
    return Seen(
        at_sample,
        states[at(HERE_TOUCHING, i)],
        states[at(HERE_SIZE, i)],
        states[at(HERE_CONTACT, i)],
    );
}

fn before_of(i: u32) -> Seen {
    var before: Seen;
    before.at.indentation = states[at(BEFORE_INDENTATION, i)];
    before.size = states[at(BEFORE_SIZE, i)];
    return before;
}

fn store_seen(i: u32, here: Seen, before: Seen) {
    states[at(HERE_INDENTATION, i)] = here.at.indentation;
    states[at(HERE_SPEED, i)] = here.at.speed;
    states[at(HERE_ACCELERATION, i)] = here.at.acceleration;
    states[at(HERE_TOUCHING, i)] = here.touching;
    states[at(HERE_SIZE, i)] = here.size;
    states[at(HERE_CONTACT, i)] = here.contact;
    //% each memory
    states[at(HERE_MEMORY_X, i)] = here.at.memory_x;
    states[at(HERE_MEMORY_U, i)] = here.at.memory_u;
    //% end
    states[at(BEFORE_INDENTATION, i)] = before.at.indentation;
    states[at(BEFORE_SIZE, i)] = before.size;
}

@compute @workgroup_size(WORKGROUP)
fn kicks(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let number = thread(group, local);
    if number >= going[job.round] {
        return;
    }
    let i = going[listed(job.round, number)];
    let lever = case_of(i);
    let law = law_of(i);
    let little = cases[at(CASE_LITTLE, i)];
    var state = state_of(i);
    var here = here_of(i);
    var before = before_of(i);
    var since = marks[at(1u, i)];
    var kicks = 0u;
    let end = job.first + job.count;
    // The period's last step has no next one, and is decided on when all are done.
    let last = select(end, end + 1u, end == job.steps);
    var index = job.first;
    loop {
        if index >= last {
            break;
        }
        var after = here;
        if index < end {
            after = see(lever, law, &state, waves[2u * index], waves[2u * index + 1u]);
        }
        if index == 0u {
            // Nothing was before the first step.
            here = after;
        } else {
            var by: KickSlope;
            var by_memory: KickSlope;
            if acts(here, before, after, little) {
                by = law_slope(law, here.at, here.touching);
                //% each memory
                by_memory = law_slope_by_memory(law, here.at, here.touching);
                //% end
            }
            if slopes(by, by_memory) {
                write_down(i, kicks, by, by_memory);
                marks[at(3u + kicks, i)] = since;
                kicks += 1u;
                since = 0u;
            } else {
                since += 1u;
            }
        }
        before = here;
        here = after;
        index += 1u;
    }
    store_state(i, state);
    store_seen(i, here, before);
    marks[i] = marks[i] + job.count;
    marks[at(1u, i)] = since;
    marks[at(2u, i)] = kicks;
}

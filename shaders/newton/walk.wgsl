// After a period with its slope of the instances under way: one thread takes in where one of them was led to, and puts it down
// where its next period begins, if there is one. Twin: crates/kernel/src/newton.rs

// The slope's columns: [number][column][instance].
@group(0) @binding(5) var<storage, read> columns: array<real>;
// The place taken last, travels and then rates, and likewise the stride to where the period began: [number][instance]. Then the
// change at that place, the time of a stride, and how often it was shortened.
@group(0) @binding(6) var<storage, read_write> walks: array<real>;
// Room for a matrix: [column][row][instance].
@group(0) @binding(7) var<storage, read_write> factors: array<real>;

// Where the numbers of a walk are.
const STRIDE: u32 = NUMBERS;
const CHANGE: u32 = 2u * NUMBERS;
const TIME: u32 = CHANGE + 1u;
const TRIES: u32 = CHANGE + 2u;

// How far a period has led, number by number.
fn change_of(i: u32) -> Numbers {
    var change: Numbers;
    //% each mode
    change[$u] = states[at(STATE_X_$, i)] - (walks[at($u, i)] + walks[at(STRIDE + $u, i)]);
    change[MODES + $u] = states[at(STATE_U_$, i)]
        - (walks[at(MODES + $u, i)] + walks[at(STRIDE + MODES + $u, i)]);
    //% end
    return change;
}

// Whether all numbers of a period's end are numbers, in the contact that the state is to have.
fn sound(i: u32) -> bool {
    var numbers = true;
    //% each mode
    numbers = numbers && finite(states[at(STATE_X_$, i)]) && finite(states[at(STATE_U_$, i)]);
    //% end
    let memory = ZERO < cases[at(CASE_MEMORY, i)];
    let other = (ZERO < states[at(STATE_TOUCHING, i)]) != (ZERO < cases[at(CASE_TOUCHING, i)]);
    return numbers && !(memory && other);
}

// Goes by so much.
fn move_by(i: u32, step: ptr<function, Numbers>) {
    var k = 0u;
    loop {
        if k >= job.count {
            break;
        }
        walks[at(k, i)] = walks[at(k, i)] + (*step)[k];
        k += 1u;
    }
}

fn put_stride(i: u32, step: ptr<function, Numbers>, times: real) {
    var k = 0u;
    loop {
        if k >= job.count {
            break;
        }
        walks[at(STRIDE + k, i)] = (*step)[k] * times;
        k += 1u;
    }
}

fn stride_of(i: u32) -> Numbers {
    var stride: Numbers;
    var k = 0u;
    loop {
        if k >= job.count {
            break;
        }
        stride[k] = walks[at(STRIDE + k, i)];
        k += 1u;
    }
    return stride;
}

// A stride has led nowhere: it is shortened, or the place that it began at is looked at once more.
fn refused(i: u32) -> u32 {
    if job.round == 0u {
        return LOST;
    }
    var stride = stride_of(i);
    let tries = walks[at(TRIES, i)];
    if tries < FOUR {
        walks[at(TRIES, i)] = tries + ONE;
        walks[at(TIME, i)] = min(QUARTER * walks[at(TIME, i)], NEWTON);
        put_stride(i, &stride, QUARTER);
    } else {
        walks[at(TRIES, i)] = FIVE;
        var none: Numbers;
        put_stride(i, &none, ONE);
    }
    return ON;
}

// Whether the place that no stride leads on from is as near as a rough map lets it be.
fn looked(i: u32, good: bool, change: ptr<function, Numbers>) -> u32 {
    if !good {
        return LOST;
    }
    if !solve(i, ONE, change) {
        return LOST;
    }
    let long = sqrt(product(change, change));
    let enough = cases[at(CASE_ENOUGH, i)] * cases[at(CASE_SCALE, i)];
    if finite(long) && !(enough < long) {
        return FOUND;
    }
    return LOST;
}

// The next stride from a place that was taken; or the end where Newton's step is short enough.
fn strode(i: u32, steep: real, change: ptr<function, Numbers>) -> u32 {
    let size = cases[at(CASE_SCALE, i)];
    let near = cases[at(CASE_NEAR, i)] * size;
    let time = walks[at(TIME, i)];
    // Newton's step is no shorter than the change that it undoes over the norm of 1 - slope.
    let far = near * (ONE + steep) < walks[at(CHANGE, i)];
    let flows = time < NEWTON;
    let shift = ONE / time + ONE;
    var step = *change;
    if !far {
        if !solve(i, ONE, &step) {
            return LOST;
        }
        let long = sqrt(product(&step, &step));
        if finite(long) && !(near < long) {
            move_by(i, &step);
            return FOUND;
        }
    }
    if far || flows {
        step = *change;
        if !solve(i, select(ONE, shift, flows), &step) {
            return LOST;
        }
    }
    let long = sqrt(product(&step, &step));
    if !finite(long) {
        return LOST;
    }
    let longest = FARTHEST * size;
    if longest < long {
        put_stride(i, &step, longest / long);
    } else {
        put_stride(i, &step, ONE);
    }
    return ON;
}

// Takes in where a period has led to.
fn arrive(i: u32) -> u32 {
    var change = change_of(i);
    let steep = steepness(i);
    let good = sound(i) && finite(steep);
    if FOUR < walks[at(TRIES, i)] {
        return looked(i, good, &change);
    }
    let length = sqrt(product(&change, &change));
    let gain = walks[at(CHANGE, i)] / max(length, LEAST);
    // Early strides may climb a little, as the flow does.
    let least = select(GAINS, HALF, walks[at(TIME, i)] < NEWTON);
    let strided = job.round > 0u;
    if !good || (strided && gain < least) {
        return refused(i);
    }
    if strided {
        let longer = min(LONGER * gain, LONGEST);
        walks[at(TIME, i)] = min(walks[at(TIME, i)] * longer, FAR);
    }
    walks[at(CHANGE, i)] = length;
    walks[at(TRIES, i)] = ZERO;
    var stride = stride_of(i);
    move_by(i, &stride);
    return strode(i, steep, &change);
}

// Puts an instance down a stride from its place.
fn begin(i: u32) {
    //% each mode
    states[at(STATE_X_$, i)] = walks[at($u, i)] + walks[at(STRIDE + $u, i)];
    states[at(STATE_U_$, i)] = walks[at(MODES + $u, i)] + walks[at(STRIDE + MODES + $u, i)];
    //% end
    states[at(STATE_TOUCHING, i)] = cases[at(CASE_TOUCHING, i)];
    marks[at(1u, i)] = 0u;
}

@compute @workgroup_size(WORKGROUP)
fn walk(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let number = thread(group, local);
    if number >= atomicLoad(&going[job.round]) {
        return;
    }
    let i = atomicLoad(&going[listed(job.round, number)]);
    let phase = arrive(i);
    marks[at(2u, i)] = phase;
    if phase == ON {
        goes_on(i);
        begin(i);
    }
}

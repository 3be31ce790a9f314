// After a period of the instances under way: one thread takes in where one of them was led to, and puts it down where its next
// period begins, if there is one. Twin: crates/kernel/src/broyden.rs

// Where each period began, travels and then rates; then likewise the stride that led there: [number][instance].
@group(0) @binding(5) var<storage, read_write> places: array<real>;
// What undoes a change: [column][number][instance].
@group(0) @binding(6) var<storage, read_write> undoes: array<real>;

// The sum of the squares of the whole matrix.
fn squares(i: u32) -> real {
    var even = ZERO;
    var odd = ZERO;
    var k = 0u;
    loop {
        if k >= job.count * job.count {
            break;
        }
        let first = undoes[at(k, i)];
        let second = undoes[at(k + 1u, i)];
        even = first * first + even;
        odd = second * second + odd;
        k += 2u;
    }
    return even + odd;
}

// How far a period has led, number by number; what is filled up is at rest.
fn change_of(i: u32) -> Numbers {
    var change: Numbers;
    //% each mode
    change[$u] = states[at(STATE_X_$, i)] - places[at($u, i)];
    change[HALF_NUMBERS + $u] = states[at(STATE_U_$, i)] - places[at(HALF_NUMBERS + $u, i)];
    //% end
    return change;
}

// The stride that led to where the period began.
fn taken_of(i: u32) -> Numbers {
    var taken: Numbers;
    var k = 0u;
    loop {
        if k >= job.count {
            break;
        }
        taken[k] = places[at(NUMBERS + k, i)];
        k += 1u;
    }
    return taken;
}

// What the matrix makes of the change, and of the stride from the left.
fn multiply(
    i: u32,
    change: ptr<function, Numbers>,
    taken: ptr<function, Numbers>,
    undone: ptr<function, Numbers>,
    along: ptr<function, Numbers>,
) {
    var j = 0u;
    loop {
        if j >= job.count {
            break;
        }
        let by = (*change)[j];
        var even = ZERO;
        var odd = ZERO;
        var k = 0u;
        loop {
            if k >= job.count {
                break;
            }
            let first = undoes[entry(j, k, i)];
            let second = undoes[entry(j, k + 1u, i)];
            (*undone)[k] = first * by + (*undone)[k];
            (*undone)[k + 1u] = second * by + (*undone)[k + 1u];
            even = first * (*taken)[k] + even;
            odd = second * (*taken)[k + 1u] + odd;
            k += 2u;
        }
        (*along)[j] = even + odd;
        j += 1u;
    }
}

// Corrects the matrix by what the map has shown of itself.
fn correct(i: u32, undone: ptr<function, Numbers>, along: ptr<function, Numbers>) {
    var j = 0u;
    loop {
        if j >= job.count {
            break;
        }
        let times = (*along)[j];
        var k = 0u;
        loop {
            if k >= job.count {
                break;
            }
            undoes[entry(j, k, i)] = (*undone)[k] * times + undoes[entry(j, k, i)];
            k += 1u;
        }
        j += 1u;
    }
}

fn scale(list: ptr<function, Numbers>, times: real) {
    var k = 0u;
    loop {
        if k >= job.count {
            break;
        }
        (*list)[k] = (*list)[k] * times;
        k += 1u;
    }
}

// Takes in where a period has led to.
fn led(i: u32) -> u32 {
    var change = change_of(i);
    var taken = taken_of(i);
    var undone: Numbers;
    var along: Numbers;
    multiply(i, &change, &taken, &undone, &along);
    var next = undone;
    let strode = job.round > 0u;
    if strode {
        let square = product(&taken, &taken);
        let share = ONE / (square - product(&along, &change));
        scale(&along, share);
        scale(&next, square * share);
    }
    let size = cases[at(CASE_SCALE, i)];
    let left = sqrt(product(&next, &next)) / size;
    if !finite(left) || FARTHEST < left {
        return LOST;
    }
    if strode {
        correct(i, &undone, &along);
    }
    if !(cases[at(CASE_NEAR, i)] < left) {
        let bound = sqrt(product(&change, &change)) * sqrt(squares(i)) / size;
        if finite(bound) && !(cases[at(CASE_SURE, i)] < bound) {
            return FOUND;
        }
    }
    var k = 0u;
    loop {
        if k >= job.count {
            break;
        }
        places[at(k, i)] = places[at(k, i)] + next[k];
        places[at(NUMBERS + k, i)] = next[k];
        k += 1u;
    }
    return ON;
}

// Whether all numbers of a period's end are numbers, in the contact that the state is to have.
fn sound(i: u32) -> bool {
    let memory = ZERO < cases[at(CASE_MEMORY, i)];
    let other = (ZERO < states[at(STATE_TOUCHING, i)]) != (ZERO < cases[at(CASE_TOUCHING, i)]);
    return marks[at(1u, i)] == 0u && !(memory && other);
}

// Puts an instance down at its place, with nothing measured.
fn begin(i: u32) {
    var beyond = ZERO;
    //% each swinging mode
    beyond = beyond + places[at($u, i)];
    //% end
    //% each mode
    states[at(STATE_X_$, i)] = places[at($u, i)];
    states[at(STATE_U_$, i)] = places[at(HALF_NUMBERS + $u, i)];
    //% end
    let touching = cases[at(CASE_TOUCHING, i)];
    states[at(STATE_TOUCHING, i)] = touching;
    //% if looks back
    let last = -(cases[at(CASE_STILL, i)] + beyond);
    states[at(TALLY_LAST_0, i)] = last;
    states[at(TALLY_LAST_1, i)] = last;
    states[at(TALLY_TOUCHED, i)] = touching;
    //% end
    store_run_sums(i, begin_run());
}

@compute @workgroup_size(WORKGROUP)
fn stride(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let number = thread(group, local);
    if number >= atomicLoad(&going[job.round]) {
        return;
    }
    let i = atomicLoad(&going[listed(job.round, number)]);
    var phase = LOST;
    if sound(i) {
        phase = led(i);
    }
    marks[at(2u, i)] = phase;
    if phase == ON {
        goes_on(i);
        begin(i);
    }
}

// A period's slope, second part: one thread takes one column of it through the kicks that a dispatch has written down.
// Twin: crates/kernel/src/tangent.rs

// Constants of each driven instrument: [field][drive].
@group(0) @binding(1) var<storage, read> drives: array<real>;
// Which drive each instance has.
@group(0) @binding(2) var<storage, read> drive_of: array<u32>;
// Increments over 1, 2, 4, ... steps: [power][m00, m01, m11][mode][drive].
@group(0) @binding(3) var<storage, read> flows: array<real>;
// As the first part left them.
@group(0) @binding(4) var<storage, read> marks: array<u32>;
@group(0) @binding(5) var<storage, read> partials: array<real>;
// Travels, then rates, of each column: [number][column][instance].
@group(0) @binding(6) var<storage, read_write> columns: array<real>;
// How many instances are under way in each round and after the last; then which these are, in lists that take turns.
@group(0) @binding(7) var<storage, read> going: array<u32>;

struct Column {
    //% each mode
    x_$: real,
    u_$: real,
    //% end
}

fn flow(power: u32, field: u32, mode: u32, row: u32) -> real {
    return flows[((3u * power + field) * MODES + mode) * job.drives + row];
}

fn drive(field: u32, row: u32) -> real {
    return drives[field * job.drives + row];
}

// 1 in the column of this number, and 0 in the others.
fn unit(number: u32, column: u32) -> real {
    return select(ZERO, ONE, number == column);
}

fn first_column(column: u32) -> Column {
    var first: Column;
    //% each mode
    first.x_$ = unit($u, column);
    first.u_$ = unit(MODES + $u, column);
    //% end
    return first;
}

// So many steps without a kick.
fn fly(column: ptr<function, Column>, row: u32, steps: u32) {
    var left = steps;
    var power = 0u;
    loop {
        if left == 0u {
            break;
        }
        if (left & 1u) == 1u {
            //% each mode
            let m01_$ = flow(power, 1u, $u, row);
            let x_$ = (*column).x_$;
            let u_$ = (*column).u_$;
            (*column).x_$ = m01_$ * u_$ + (flow(power, 0u, $u, row) * x_$ + x_$);
            (*column).u_$ = flow(power, 2u, $u, row) * u_$ + (-m01_$ * x_$ + u_$);
            //% end
        }
        left = left >> 1u;
        power += 1u;
    }
}

// A kick and the flow to the next sample.
fn kick(column: ptr<function, Column>, row: u32, first: u32, i: u32) {
    // How the approach changes: indentation and speed into the sample are the opposites of the tip's motion.
    var travel = ZERO;
    var speed = ZERO;
    var pulled = ZERO;
    var dragged = ZERO;
    //% each swinging mode
    travel = travel - (*column).x_$;
    speed = -drive(DRIVE_RATE_$, row) * (*column).u_$ + speed;
    pulled = -drive(DRIVE_PULL_$, row) * (*column).x_$ + pulled;
    dragged = -drive(DRIVE_DRAG_$, row) * (*column).u_$ + dragged;
    //% end
    let acceleration = pulled + dragged;
    let by_0 = partials[at(first, i)];
    let by_1 = partials[at(first + 1u, i)];
    let by_2 = partials[at(first + 2u, i)];
    var impulse = by_0 * travel + (by_1 * speed + by_2 * acceleration);
    //% each memory
    let by_8 = partials[at(first + 8u, i)];
    let by_9 = partials[at(first + 9u, i)];
    impulse = partials[at(first + 6u, i)] * (*column).x_$ + (partials[at(first + 7u, i)] * (*column).u_$ + impulse);
    let of_memory = by_8 * (*column).x_$ + by_9 * (*column).u_$;
    let held_x = partials[at(first + 13u, i)] * (*column).x_$ + partials[at(first + 14u, i)] * (*column).u_$;
    let held_u = partials[at(first + 18u, i)] * (*column).x_$ + partials[at(first + 19u, i)] * (*column).u_$;
    let bent_x = partials[at(first + 12u, i)] * acceleration + held_x;
    let bent_u = partials[at(first + 17u, i)] * acceleration + held_u;
    let remembered_x = partials[at(first + 10u, i)] * travel + (partials[at(first + 11u, i)] * speed + bent_x);
    let remembered_u = partials[at(first + 15u, i)] * travel + (partials[at(first + 16u, i)] * speed + bent_u);
    //% end
    //% each mode
    let m01_$ = drive(DRIVE_M01_$, row);
    let x_$ = (*column).x_$;
    let u_$ = (*column).u_$;
    let flown_x_$ = m01_$ * u_$ + (drive(DRIVE_M00_$, row) * x_$ + x_$);
    let flown_u_$ = drive(DRIVE_M11_$, row) * u_$ + (-m01_$ * x_$ + u_$);
    (*column).x_$ = drive(DRIVE_LAND_X_$, row) * impulse + flown_x_$;
    (*column).u_$ = drive(DRIVE_LAND_U_$, row) * impulse + flown_u_$;
    //% end
    //% if shifts
    let by_3 = partials[at(first + 3u, i)];
    let by_4 = partials[at(first + 4u, i)];
    let by_5 = partials[at(first + 5u, i)];
    if ZERO < abs(by_3) + abs(by_4) + abs(by_5)
        //% each memory
        + (abs(by_8) + abs(by_9))
        //% end
    {
        var shift = by_3 * travel + (by_4 * speed + by_5 * acceleration);
        //% each memory
        shift = shift + of_memory;
        //% end
        //% each mode
        (*column).x_$ = drive(DRIVE_SHIFT_X_$, row) * shift + (*column).x_$;
        (*column).u_$ = drive(DRIVE_SHIFT_U_$, row) * shift + (*column).u_$;
        //% end
    }
    //% end
    //% each memory
    (*column).x_$ = (*column).x_$ + remembered_x;
    (*column).u_$ = (*column).u_$ + remembered_u;
    //% end
}

@compute @workgroup_size(WORKGROUP)
fn carry(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let turn = thread(group, local);
    let nth = turn % job.instances;
    let all = 2u * MODES * job.instances;
    if turn >= all || nth >= going[job.round] {
        return;
    }
    let i = going[listed(job.round, nth)];
    let place = turn - nth + i;
    //% if one drive
    let row = 0u;
    //% end
    //% if several drives
    let row = drive_of[i];
    //% end
    var column = first_column(turn / job.instances);
    // A dispatch may begin within the period.
    if job.first > 0u {
        //% each mode
        column.x_$ = columns[$u * all + place];
        column.u_$ = columns[(MODES + $u) * all + place];
        //% end
    }
    let kicks = marks[at(2u, i)];
    var number = 0u;
    loop {
        if number >= kicks {
            break;
        }
        fly(&column, row, marks[at(3u + number, i)]);
        kick(&column, row, number * PARTIALS, i);
        number += 1u;
    }
    if job.first + job.count == job.steps {
        fly(&column, row, marks[at(1u, i)]);
    }
    //% each mode
    columns[$u * all + place] = column.x_$;
    columns[(MODES + $u) * all + place] = column.u_$;
    //% end
}

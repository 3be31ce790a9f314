// What a thread reads when a dispatch begins and writes when it ends.

fn at(field: u32, i: u32) -> u32 {
    return field * job.instances + i;
}

fn case_of(i: u32) -> Case {
    let row = drive_of[i];
    var lever: Case;
    //% each mode
    lever.m00_$ = drives[DRIVE_M00_$ * job.drives + row];
    lever.m01_$ = drives[DRIVE_M01_$ * job.drives + row];
    lever.m11_$ = drives[DRIVE_M11_$ * job.drives + row];
    lever.rate_$ = drives[DRIVE_RATE_$ * job.drives + row];
    lever.pull_$ = drives[DRIVE_PULL_$ * job.drives + row];
    lever.drag_$ = drives[DRIVE_DRAG_$ * job.drives + row];
    lever.land_x_$ = drives[DRIVE_LAND_X_$ * job.drives + row];
    lever.land_u_$ = drives[DRIVE_LAND_U_$ * job.drives + row];
    //% if shifts
    lever.shift_x_$ = drives[DRIVE_SHIFT_X_$ * job.drives + row];
    lever.shift_u_$ = drives[DRIVE_SHIFT_U_$ * job.drives + row];
    //% end
    //% end
    //% if energy
    //% each mode
    lever.work_x_$ = drives[DRIVE_WORK_X_$ * job.drives + row];
    lever.work_u_$ = drives[DRIVE_WORK_U_$ * job.drives + row];
    //% end
    lever.kick_paid = drives[DRIVE_KICK_PAID * job.drives + row];
    //% end
    lever.free_cosine = drives[DRIVE_FREE_COSINE * job.drives + row];
    lever.free_sine = drives[DRIVE_FREE_SINE * job.drives + row];
    lever.free_rate = drives[DRIVE_FREE_RATE * job.drives + row];
    lever.gap = cases[at(CASE_GAP, i)];
    return lever;
}

fn state_of(i: u32) -> State {
    var state: State;
    //% each mode
    state.x_$ = states[at(STATE_X_$, i)];
    state.u_$ = states[at(STATE_U_$, i)];
    //% end
    state.touching = states[at(STATE_TOUCHING, i)];
    return state;
}

fn tally_of(i: u32) -> Tally {
    var tally: Tally;
    tally_next_period(&tally);
    // A dispatch may begin within a period.
    if job.first > 0u {
        //% each harmonic
        tally.cosine_$ = states[at(TALLY_COSINE_$, i)];
        tally.sine_$ = states[at(TALLY_SINE_$, i)];
        //% end
        //% each sum
        tally.$ = states[at(TALLY_$$, i)];
        //% end
    }
    //% if looks back
    tally.last_0 = states[at(TALLY_LAST_0, i)];
    tally.last_1 = states[at(TALLY_LAST_1, i)];
    tally.touched = states[at(TALLY_TOUCHED, i)];
    //% end
    return tally;
}

fn store(i: u32, state: State, tally: Tally) {
    //% each mode
    states[at(STATE_X_$, i)] = state.x_$;
    states[at(STATE_U_$, i)] = state.u_$;
    //% end
    states[at(STATE_TOUCHING, i)] = state.touching;
    //% each harmonic
    states[at(TALLY_COSINE_$, i)] = tally.cosine_$;
    states[at(TALLY_SINE_$, i)] = tally.sine_$;
    //% end
    //% each sum
    states[at(TALLY_$$, i)] = tally.$;
    //% end
    //% if looks back
    states[at(TALLY_LAST_0, i)] = tally.last_0;
    states[at(TALLY_LAST_1, i)] = tally.last_1;
    states[at(TALLY_TOUCHED, i)] = tally.touched;
    //% end
}

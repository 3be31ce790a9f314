// What a thread reads of its instance when a dispatch begins, and where that is when it ends.

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

fn store_state(i: u32, state: State) {
    //% each mode
    states[at(STATE_X_$, i)] = state.x_$;
    states[at(STATE_U_$, i)] = state.u_$;
    //% end
    states[at(STATE_TOUCHING, i)] = state.touching;
}

// `step` as the program writes it for a shader from crates/kernel/src/step.rs; do not change it by hand.

struct Case {
    m00_0: real,
    m00_1: real,
    m01_0: real,
    m01_1: real,
    m11_0: real,
    m11_1: real,
    rate_0: real,
    rate_1: real,
    pull_0: real,
    pull_1: real,
    drag_0: real,
    drag_1: real,
    land_x_0: real,
    land_x_1: real,
    land_u_0: real,
    land_u_1: real,
    shift_x_0: real,
    shift_x_1: real,
    shift_u_0: real,
    shift_u_1: real,
    corner: real,
    work_x_0: real,
    work_x_1: real,
    work_u_0: real,
    work_u_1: real,
    kick_paid: real,
    mean_corner: real,
    free_cosine: real,
    free_sine: real,
    free_rate: real,
    gap: real,
}

fn case_of(i: u32) -> Case {
    let row = drive_of[i];
    return Case(
        drives[DRIVE_M00_0 * job.drives + row],
        drives[DRIVE_M00_1 * job.drives + row],
        drives[DRIVE_M01_0 * job.drives + row],
        drives[DRIVE_M01_1 * job.drives + row],
        drives[DRIVE_M11_0 * job.drives + row],
        drives[DRIVE_M11_1 * job.drives + row],
        drives[DRIVE_RATE_0 * job.drives + row],
        drives[DRIVE_RATE_1 * job.drives + row],
        drives[DRIVE_PULL_0 * job.drives + row],
        drives[DRIVE_PULL_1 * job.drives + row],
        drives[DRIVE_DRAG_0 * job.drives + row],
        drives[DRIVE_DRAG_1 * job.drives + row],
        drives[DRIVE_LAND_X_0 * job.drives + row],
        drives[DRIVE_LAND_X_1 * job.drives + row],
        drives[DRIVE_LAND_U_0 * job.drives + row],
        drives[DRIVE_LAND_U_1 * job.drives + row],
        drives[DRIVE_SHIFT_X_0 * job.drives + row],
        drives[DRIVE_SHIFT_X_1 * job.drives + row],
        drives[DRIVE_SHIFT_U_0 * job.drives + row],
        drives[DRIVE_SHIFT_U_1 * job.drives + row],
        drives[DRIVE_CORNER * job.drives + row],
        drives[DRIVE_WORK_X_0 * job.drives + row],
        drives[DRIVE_WORK_X_1 * job.drives + row],
        drives[DRIVE_WORK_U_0 * job.drives + row],
        drives[DRIVE_WORK_U_1 * job.drives + row],
        drives[DRIVE_KICK_PAID * job.drives + row],
        drives[DRIVE_MEAN_CORNER * job.drives + row],
        drives[DRIVE_FREE_COSINE * job.drives + row],
        drives[DRIVE_FREE_SINE * job.drives + row],
        drives[DRIVE_FREE_RATE * job.drives + row],
        cases[at(CASE_GAP, i)],
    );
}

struct State {
    x_0: real,
    u_0: real,
    x_1: real,
    u_1: real,
    touching: real,
}

fn state_of(i: u32) -> State {
    return State(
        states[at(STATE_X_0, i)],
        states[at(STATE_U_0, i)],
        states[at(STATE_X_1, i)],
        states[at(STATE_U_1, i)],
        states[at(STATE_TOUCHING, i)],
    );
}

fn store_state(i: u32, state: State) {
    states[at(STATE_X_0, i)] = state.x_0;
    states[at(STATE_U_0, i)] = state.u_0;
    states[at(STATE_X_1, i)] = state.x_1;
    states[at(STATE_U_1, i)] = state.u_1;
    states[at(STATE_TOUCHING, i)] = state.touching;
}

fn meet(lever: Case, state: State, cosine: real, sine: real, decay: Decay) -> Met {
    let t1 = lever.free_cosine * cosine + lever.free_sine * sine;
    let t2 = lever.free_rate * (lever.free_sine * cosine + -(lever.free_cosine * sine));
    let t3 = lever.work_x_0 * state.x_0 + -(lever.free_rate * lever.free_rate * t2 * TWENTY_FOURTH);
    let t4 = lever.work_x_1 * state.x_1 + (lever.work_u_0 * state.u_0 + t3);
    let t5 = -(lever.free_rate * lever.free_rate * t1) + decay.acceleration;
    let t6 = decay.travel + state.x_0 + state.x_1;
    let t7 = lever.rate_1 * state.u_1 + (lever.rate_0 * state.u_0 + (t2 + decay.speed));
    let t8 = lever.pull_1 * state.x_1 + (lever.drag_0 * state.u_0 + (lever.pull_0 * state.x_0 + t5));
    return Met(t1, t6, lever.work_u_1 * state.u_1 + t4, Approach(-(lever.gap + t1 + t6), -t7, -(lever.drag_1 * state.u_1 + t8)));
}

fn fly(lever: Case, state: State, kick: Kick) -> State {
    let t1 = lever.m01_0 * state.u_0 + (lever.m00_0 * state.x_0 + state.x_0);
    let t2 = lever.m11_0 * state.u_0 + (-lever.m01_0 * state.x_0 + state.u_0);
    let t3 = lever.m01_1 * state.u_1 + (lever.m00_1 * state.x_1 + state.x_1);
    let t4 = lever.m11_1 * state.u_1 + (-lever.m01_1 * state.x_1 + state.u_1);
    let t5 = lever.shift_x_0 * kick.shift + (lever.land_x_0 * kick.impulse + t1);
    let t6 = lever.shift_u_0 * kick.shift + (lever.land_u_0 * kick.impulse + t2);
    let t7 = lever.shift_x_1 * kick.shift + (lever.land_x_1 * kick.impulse + t3);
    let t8 = lever.shift_u_1 * kick.shift + (lever.land_u_1 * kick.impulse + t4);
    return State(
        t5,
        t6,
        t7,
        t8,
        kick.touching,
    );
}

fn sampled(lever: Case, met: Met, kick: Kick) -> Sample {
    let t1 = -met.at.speed;
    let t2 = -met.at.acceleration;
    let t3 = kick.impulse * (lever.kick_paid * kick.impulse + t1 - met.excess);
    let t4 = -t2 * TWENTY_FOURTH + (lever.mean_corner * kick.impulse + (met.steady + met.beyond));
    return Sample(lever.corner * kick.impulse + met.beyond, -lever.corner * kick.impulse + met.at.indentation, -t2 * kick.shift + t3, -kick.shift * (HALF * kick.impulse + t1) + kick.impulse * t4, ZERO, ZERO, kick);
}

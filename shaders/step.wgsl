// One step: kick at the sample, then exact flow to the next one. Twin: crates/kernel/src/step.rs
// Lines between `//% each mode` and `//% end` are written once for each mode, $ its number.

// Lever, free motion and gap of one instance, kernel units.
struct Case {
    //% each mode
    m00_$: real,
    m01_$: real,
    m11_$: real,
    rate_$: real,
    pull_$: real,
    drag_$: real,
    land_x_$: real,
    land_u_$: real,
    //% if shifts
    shift_x_$: real,
    shift_u_$: real,
    //% end
    //% end
    //% if energy
    //% each mode
    work_x_$: real,
    work_u_$: real,
    //% end
    kick_paid: real,
    //% end
    free_cosine: real,
    free_sine: real,
    free_rate: real,
    gap: real,
}

// Deviation of each mode at a sample before its kick, and the memory of contact.
struct State {
    //% each mode
    x_$: real,
    u_$: real,
    //% end
    touching: real,
}

// Free travel beyond the steady one (a start from rest), its speed per step and acceleration.
struct Decay {
    travel: real,
    speed: real,
    acceleration: real,
}

// The tip at a sample before its kick.
struct Met {
    // Steady free travel of the tip, and travel beyond it.
    steady: real,
    beyond: real,
    //% if energy
    // What the speed is too large by when the kick counts as work.
    excess: real,
    //% end
    at: Approach,
}

// What a step saw.
struct Sample {
    beyond: real,
    indentation: real,
    //% if energy
    work: real,
    virial: real,
    //% end
    kick: Kick,
}

fn meet(lever: Case, state: State, cosine: real, sine: real, decay: Decay) -> Met {
    let steady = lever.free_cosine * cosine + lever.free_sine * sine;
    var speed = lever.free_rate * (lever.free_sine * cosine + -(lever.free_cosine * sine));
    //% if energy
    var excess = -(lever.free_rate * lever.free_rate * speed * TWENTY_FOURTH);
    //% end
    var acceleration = -(lever.free_rate * lever.free_rate * steady);
    var beyond = ZERO;
    //% if decay
    beyond = decay.travel;
    speed = speed + decay.speed;
    acceleration = acceleration + decay.acceleration;
    //% end
    //% each mode
    beyond = beyond + state.x_$;
    speed = lever.rate_$ * state.u_$ + speed;
    acceleration = lever.pull_$ * state.x_$ + acceleration;
    acceleration = lever.drag_$ * state.u_$ + acceleration;
    //% if energy
    excess = lever.work_x_$ * state.x_$ + excess;
    excess = lever.work_u_$ * state.u_$ + excess;
    //% end
    //% end
    let indentation = -(lever.gap + steady + beyond);
    return Met(
        steady,
        beyond,
        //% if energy
        excess,
        //% end
        Approach(indentation, -speed, -acceleration),
    );
}

fn fly(lever: Case, state: ptr<function, State>, kick: Kick) {
    //% each mode
    let x_$ = (*state).x_$;
    let u_$ = (*state).u_$;
    let flown_x_$ = lever.m01_$ * u_$ + (lever.m00_$ * x_$ + x_$);
    let flown_u_$ = lever.m11_$ * u_$ + (-lever.m01_$ * x_$ + u_$);
    (*state).x_$ = lever.land_x_$ * kick.impulse + flown_x_$;
    (*state).u_$ = lever.land_u_$ * kick.impulse + flown_u_$;
    //% end
    //% if shifts
    if ZERO < abs(kick.shift) {
        //% each mode
        (*state).x_$ = lever.shift_x_$ * kick.shift + (*state).x_$;
        (*state).u_$ = lever.shift_u_$ * kick.shift + (*state).u_$;
        //% end
    }
    //% end
}

fn step(lever: Case, law: Law, state: ptr<function, State>, cosine: real, sine: real, decay: Decay) -> Sample {
    let met = meet(lever, *state, cosine, sine, decay);
    let kick = law_kick(law, met.at, (*state).touching);
    let impulse = kick.impulse;
    (*state).touching = kick.touching;
    fly(lever, state, kick);
    let corner = TWENTY_FOURTH;
    //% if energy
    let speed = -met.at.speed;
    let acceleration = -met.at.acceleration;
    var work = impulse * (lever.kick_paid * impulse + speed - met.excess);
    var virial = impulse * (-acceleration * corner + (met.steady + met.beyond));
    //% if shifts
    work = -acceleration * kick.shift + work;
    virial = -kick.shift * (HALF * impulse + speed) + virial;
    //% end
    //% end
    return Sample(
        corner * impulse + met.beyond,
        -corner * impulse + met.at.indentation,
        //% if energy
        work,
        virial,
        //% end
        kick,
    );
}

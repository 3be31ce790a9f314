// One step: kick at the sample, then exact flow to the next one. `meet`, `fly` and `sampled` are recorded from
// crates/kernel/src/step.rs (shaders/recorded/ shows them).

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
    //% if forces
    // Forces within the step.
    least: real,
    most: real,
    //% end
    kick: Kick,
}

fn step(lever: Case, law: Law, state: ptr<function, State>, cosine: real, sine: real, decay: Decay) -> Sample {
    let met = meet(lever, *state, cosine, sine, decay);
    let kick = law_kick(law, met.at, (*state).touching);
    *state = fly(lever, *state, kick);
    var sample = sampled(lever, met, kick);
    //% if forces
    let forces = law_forces(law, met.at, kick);
    sample.least = forces.x;
    sample.most = forces.y;
    //% end
    return sample;
}

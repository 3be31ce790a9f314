// What a law is given and what it gives: `law_kick` and `law_slope`, which the laws write themselves (shaders/recorded/).
// Twin: crates/kernel/src/contact/mod.rs

// The tip at one sample, before the kick.
struct Approach {
    indentation: real,
    speed: real,
    acceleration: real,
}

// What the sample does to the tip during one step.
struct Kick {
    impulse: real,
    shift: real,
    contact: real,
    touching: real,
}

// How impulse and shift change with the three numbers of an approach.
struct KickSlope {
    impulse: vec3<real>,
    shift: vec3<real>,
}

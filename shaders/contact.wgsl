// What a law is given and what it gives: `law_kick` and `law_slope`, which the laws write themselves (shaders/recorded/).
// Twin: crates/kernel/src/contact/mod.rs

// The tip at one sample, before the kick.
struct Approach {
    indentation: real,
    speed: real,
    acceleration: real,
    //% each memory
    memory_x: real,
    memory_u: real,
    //% end
}

// What the sample does to the tip during one step.
struct Kick {
    impulse: real,
    shift: real,
    contact: real,
    touching: real,
    //% each memory
    memory_x: real,
    memory_u: real,
    //% end
}

// How all that changes with the three numbers of an approach, or with the law's memory.
struct KickSlope {
    impulse: vec3<real>,
    shift: vec3<real>,
    //% each memory
    memory_x: vec3<real>,
    memory_u: vec3<real>,
    //% end
}

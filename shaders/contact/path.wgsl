// A straight piece of the tip's path, from half a step before a sample to half a step after it, for the laws without
// memory; JKR follows the bent one.
// Twin: crates/kernel/src/contact/path.rs, mod.rs

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

struct Path {
    start: real,
    end: real,
}

fn no_kick() -> Kick {
    return Kick(ZERO, ZERO, ZERO, ZERO);
}

fn may_touch(at: Approach) -> bool {
    return -(abs(at.speed) + abs(at.acceleration)) < at.indentation;
}

fn path_around(at: Approach, impulse: real) -> Path {
    let reach = -QUARTER * impulse + HALF * at.speed;
    let centre = at.acceleration * TWENTY_FOURTH + at.indentation;
    return Path(centre - reach, centre + reach);
}

// The mean force with the commutator of kick and flow, of second order.
fn corrected(force: real, slope: real) -> real {
    return -(force * slope) * TWELFTH + force;
}

fn share_inside(path: Path) -> real {
    let low = min(path.start, path.end);
    let high = max(path.start, path.end);
    let crossing = high / (high - low);
    let outside = select(crossing, ZERO, high < ZERO);
    return select(ONE, outside, low < ZERO);
}

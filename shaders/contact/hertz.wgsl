// Hertz's mean force along a piece of path. Twin: crates/kernel/src/contact/hertz.rs

struct Mean {
    force: real,
    slope: real,
    share: real,
}

fn hertz_sample(law: Law, indentation: real) -> real {
    let inside = max(indentation, ZERO);
    return law.stiffness * inside * sqrt(inside);
}

fn hertz_mean(law: Law, path: Path) -> Mean {
    let aa = max(path.start, ZERO);
    let bb = max(path.end, ZERO);
    let a = sqrt(aa);
    let b = sqrt(bb);
    let share = share_inside(path);
    let ab = a * b;
    let sum = aa + bb;
    let scale = law.stiffness * share / max(a + b, LEAST);
    let quartic = sum * (sum + ab) + -(ab * ab);
    return Mean(quartic * scale * HERTZ_ENERGY, (sum + ab) * scale, share);
}

fn hertz_touching(indentation: real) -> real {
    return select(ZERO, ONE, ZERO < indentation);
}

fn hertz_kick(law: Law, at: Approach, touching: real) -> Kick {
    if !may_touch(at) {
        return no_kick();
    }
    let path = path_around(at, hertz_sample(law, at.indentation));
    let mean = hertz_mean(law, path);
    return Kick(corrected(mean.force, mean.slope), ZERO, mean.share, hertz_touching(path.end));
}

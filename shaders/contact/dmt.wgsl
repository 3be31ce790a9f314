// DMT: Hertz's force less adhesion, and its decay outside contact. Twin: src/kernel/contact/dmt.rs

fn dmt_distance(law: Law, indentation: real) -> real {
    return max(-indentation, ZERO) * law.inverse_decay;
}

fn dmt_attraction(law: Law, path: Path, inside: real) -> real {
    let product = (ONE + dmt_distance(law, path.start)) * (ONE + dmt_distance(law, path.end));
    let outside = ONE / product;
    return law.adhesion * (inside * (ONE - outside) + outside);
}

fn dmt_kick(law: Law, at: Approach, touching: real) -> Kick {
    let y = ONE / (ONE + dmt_distance(law, at.indentation));
    let sample = hertz_sample(law, at.indentation) - law.adhesion * y * y;
    let path = path_around(at, sample);
    if !(ZERO < path.start || ZERO < path.end) {
        let pull = dmt_attraction(law, path, ZERO);
        let slope = -(TWO * pull * law.inverse_decay * y);
        return Kick(-pull + pull * slope * TWELFTH, ZERO, ZERO);
    }
    let mean = hertz_mean(law, path);
    let pull = dmt_attraction(law, path, mean.share);
    let force = mean.force - pull;
    let slope = mean.slope - TWO * pull * law.inverse_decay * y * (ONE - mean.share);
    let impulse = force - force * slope * TWELFTH;
    return Kick(impulse, mean.share, hertz_touching(path.end));
}

// DMT: Hertz's force less adhesion, and its decay outside contact. Twin: src/kernel/contact/dmt.rs

fn dmt_stretch(law: Law, indentation: real) -> real {
    return max(-indentation, ZERO) * law.inverse_decay + ONE;
}

fn dmt_kick(law: Law, at: Approach, touching: real) -> Kick {
    let y = ONE / dmt_stretch(law, at.indentation);
    let sample = -(law.adhesion * y) * y + hertz_sample(law, at.indentation);
    let path = path_around(at, sample);
    let outside = ONE / (dmt_stretch(law, path.start) * dmt_stretch(law, path.end));
    let fall = TWO * law.inverse_decay * y;
    if !(ZERO < path.start || ZERO < path.end) {
        let pull = law.adhesion * outside;
        return Kick(corrected(-pull, -(pull * fall)), ZERO, ZERO);
    }
    let mean = hertz_mean(law, path);
    let pull = law.adhesion * (mean.share * (ONE - outside) + outside);
    let slope = mean.slope - pull * fall * (ONE - mean.share);
    return Kick(corrected(mean.force - pull, slope), mean.share, hertz_touching(path.end));
}

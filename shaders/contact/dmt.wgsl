// DMT: Hertz's force less adhesion, and its decay outside contact. Twin: crates/kernel/src/contact/dmt.rs

fn dmt_stretch(law: Law, indentation: real) -> real {
    return max(-indentation, ZERO) * law.inverse_decay + ONE;
}

// How far the attraction is from a force that changes evenly: minus the first moment over z, z, 1/(a + b).
struct Bend {
    moment: real,
    lean: real,
    inverse_sum: real,
}

// The attraction is 1/s^2 while s runs from a to b, outside, mean 1/(ab), and 1 in the rest of the step, inside.
fn tail_bend(sum: real, span: real, mean: real, outside: real, inside: real) -> Bend {
    let square = sum * sum;
    let pole = TAIL_POLE * span * span + square;
    let both = ONE / (pole * sum);
    let inverse_sum = pole * both;
    let lean = span * inverse_sum;
    let x = lean * lean;
    let above = (TAIL_2 * x + TAIL_1) * x + THIRD;
    let p = above * (square * sum * both);
    let middle = HALF * sum;
    let moment = outside * (outside * p + inside * middle);
    let even = middle * middle * mean * THIRD;
    return Bend(mean * (moment - even), lean, inverse_sum);
}

fn dmt_kick(law: Law, at: Approach, touching: real) -> Kick {
    let y = ONE / dmt_stretch(law, at.indentation);
    let sample = -(law.adhesion * y) * y + hertz_sample(law, at.indentation);
    let path = path_around(at, sample);
    let a = dmt_stretch(law, path.start);
    let b = dmt_stretch(law, path.end);
    let outside = ONE / (a * b);
    let sum = a + b;
    let span = b - a;
    let hertz = hertz_mean(law, path);
    let away = ONE - hertz.share;
    let force = hertz.force - law.adhesion * (hertz.share * (ONE - outside) + outside);
    let steep = law.adhesion * law.inverse_decay * away;
    var impulse = corrected(force, hertz.slope - steep * (sum * outside * outside));
    var shift = ZERO;
    if sum < EIGHT * abs(span) || ZERO < hertz.share {
        let bend = tail_bend(sum, span, outside, away, hertz.share);
        impulse = (at.acceleration - force) * (steep * bend.moment * bend.inverse_sum) + impulse;
        shift = -(law.adhesion * bend.lean * bend.moment);
    }
    return Kick(impulse, shift, hertz.share, hertz_touching(path.end));
}

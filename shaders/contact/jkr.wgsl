// JKR with its memory, in units of the fold. Twin: src/kernel/contact/jkr.rs

fn jkr_newton(e: real, s: real) -> real {
    let p = (e + FOUR) * e + SIX;
    let r = sqrt(p);
    let slope = (TWO * e + SIX) * e + SIX;
    return e - (e * r - s) * r / slope;
}

fn jkr_root(t: real) -> real {
    let s = sqrt(max(t, LEAST));
    let q = sqrt(s);
    var e = s / (JKR_ROOT_SIX + JKR_ROOT_A * q + s / (JKR_ROOT_B + q));
    e = jkr_newton(e, s);
    e = jkr_newton(e, s);
    e = jkr_newton(e, s);
    return jkr_newton(e, s);
}

// Mean of the force over the indentation between two points of the curve, and its mean slope.
struct JkrMean {
    force: real,
    slope: real,
}

fn jkr_mean(e1: real, e2: real) -> JkrMean {
    var power = e2;
    var h = e1 + e2;
    var work = JKR_WORK_0 * h;
    var slope = h * JKR_FORCE_1 + JKR_FORCE_0;
    var distance = SIX * h;
    power = power * e2;
    h = e1 * h + power;
    work = h * JKR_WORK_1 + work;
    slope = h * JKR_FORCE_2 + slope;
    distance = h * FOUR + distance;
    power = power * e2;
    h = e1 * h + power;
    work = h * JKR_WORK_2 + work;
    slope = h * JKR_FORCE_3 + slope;
    distance = distance + h;
    power = power * e2;
    h = e1 * h + power;
    work = h * JKR_WORK_3 + work;
    slope = h * JKR_FORCE_4 + slope;
    power = power * e2;
    h = e1 * h + power;
    work = h * JKR_WORK_4 + work;
    slope = h * JKR_FORCE_5 + slope;
    power = power * e2;
    h = e1 * h + power;
    work = h * JKR_WORK_5 + work;
    power = power * e2;
    h = e1 * h + power;
    work = h * JKR_WORK_6 + work;
    power = power * e2;
    h = e1 * h + power;
    work = h * JKR_WORK_7 + work;
    power = power * e2;
    h = e1 * h + power;
    work = h * JKR_WORK_8 + work;
    let inverse = ONE / (distance + SIX * JKR_TINY);
    return JkrMean((work - FIVE * JKR_TINY) * inverse, slope * inverse);
}

fn jkr_evaluate(law: Law, at: Approach, touching: real, impulse: real) -> Kick {
    let path = path_around(at, impulse);
    let t1 = path.start * law.inverse_unit + THREE;
    let end = path.end * law.inverse_unit;
    let t2 = end + THREE;
    let was = ZERO < touching;
    let begins = was || ZERO < path.start;
    let touches = !begins && ZERO < path.end;
    let holds = begins && ZERO < t1;
    let lets_go = holds && t2 < ZERO;
    let stays = holds && !lets_go;
    let acting = holds || touches;
    if !acting {
        return no_kick();
    }
    let e1 = select(jkr_root(t1), JKR_TOUCH, touches);
    let e2 = select(jkr_root(t2), ZERO, lets_go);
    let after_touch = end / (t2 - t1);
    let before_fold = t1 / (t1 - t2);
    let share = select(select(ONE, before_fold, lets_go), after_touch, touches);
    let mean = jkr_mean(e1, e2);
    let force = mean.force * law.unit_force * share;
    let slope = max(mean.slope * law.unit_force * law.inverse_unit, JKR_STEEPEST);
    return Kick(select(force, corrected(force, slope), stays), share, select(ZERO, ONE, stays || touches));
}

fn jkr_kick(law: Law, at: Approach, touching: real) -> Kick {
    if !(ZERO < touching || may_touch(at)) {
        return no_kick();
    }
    let guess = jkr_evaluate(law, at, touching, ZERO);
    return jkr_evaluate(law, at, touching, guess.impulse);
}

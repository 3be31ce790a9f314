// JKR's curve, in units of the fold. Twin: crates/kernel/src/contact/jkr.rs

fn jkr_halley(e: real, t: real) -> real {
    let p = (e + FOUR) * e + SIX;
    let miss = e * e * p + -t;
    let slope = FOUR * e * ((e + THREE) * e + THREE);
    let y = e + ONE;
    let bend = SIX * y * y;
    return e - miss * slope / (slope * slope + -(miss * bend));
}

fn jkr_about(s: real) -> real {
    let q = sqrt(s);
    let above = JKR_ROOT_A * q + ONE;
    let below = JKR_ROOT_B * q + JKR_ROOT_SIX;
    return s * above / (JKR_ROOT_A * s + below);
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

// A point of the curve: the root of t, e, and F.
struct JkrPoint {
    root_t: real,
    e: real,
    force: real,
}

fn jkr_point_of(root_t: real, e: real) -> JkrPoint {
    let y = e + ONE;
    let cube = y * y * y;
    return JkrPoint(root_t, e, cube * (cube * SIXTH) + -cube);
}

fn jkr_roughly(any_t: real) -> JkrPoint {
    let t = max(any_t, LEAST);
    let s = sqrt(t);
    return jkr_point_of(s, jkr_halley(jkr_about(s), t));
}

fn jkr_at(any_t: real) -> JkrPoint {
    let t = max(any_t, LEAST);
    let s = sqrt(t);
    return jkr_point_of(s, jkr_halley(jkr_halley(jkr_about(s), t), t));
}

// What the curve does between two points of it that are passed evenly.
struct JkrPart {
    mean: real,
    moment: real,
    slope: real,
    bow: real,
    roots: real,
}

fn jkr_between(start: JkrPoint, end: JkrPoint) -> JkrPart {
    let mean = jkr_mean(start.e, end.e);
    let bow = -HALF * (start.force + end.force) + mean.force;
    let roots = max(start.root_t + end.root_t, LEAST);
    let lean = (end.root_t - start.root_t) / roots;
    let even = TWELFTH * (end.force - start.force);
    return JkrPart(mean.force, -TENTH * (bow * lean) + even, mean.slope, bow, roots);
}

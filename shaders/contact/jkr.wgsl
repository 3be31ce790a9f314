// JKR with its memory, in units of the fold. Twin: src/kernel/contact/jkr.rs

fn jkr_newton(e: real, s: real) -> real {
    let p = (e + FOUR) * e + SIX;
    let r = sqrt(p);
    let slope = (TWO * e + SIX) * e + SIX;
    return e - (e * r - s) * r / slope;
}

fn jkr_root(s: real) -> real {
    let q = sqrt(s);
    let e = s / (JKR_ROOT_SIX + JKR_ROOT_A * q + s / (JKR_ROOT_B + q));
    return jkr_newton(jkr_newton(jkr_newton(e, s), s), s);
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

fn jkr_roughly(t: real) -> JkrPoint {
    let s = sqrt(max(t, LEAST));
    return jkr_point_of(s, jkr_root(s));
}

fn jkr_next(near: JkrPoint, t: real) -> JkrPoint {
    let s = sqrt(max(t, LEAST));
    return jkr_point_of(s, jkr_newton(jkr_newton(near.e, s), s));
}

fn jkr_either(no: JkrPoint, yes: JkrPoint, mask: bool) -> JkrPoint {
    return JkrPoint(
        select(no.root_t, yes.root_t, mask),
        select(no.e, yes.e, mask),
        select(no.force, yes.force, mask),
    );
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

fn jkr_ahead(t1: real, pace: real, left: real, free: real, held: real) -> real {
    return left * left * (HALF * free + -held) + (left * pace + t1);
}

fn jkr_kick(law: Law, at: Approach, touching: real) -> Kick {
    let was = ZERO < touching;
    if !(was || may_touch(at)) {
        return no_kick();
    }
    let free = at.acceleration * law.inverse_unit;
    let speed = -HALF * free + at.speed * law.inverse_unit;
    let along = at.indentation * law.inverse_unit;
    let begin = -HALF * (at.speed * law.inverse_unit) + (EIGHTH * free + along);
    let end = HALF * free + (begin + speed);
    let begins = was || ZERO < begin;
    let touches = !begins && ZERO < end;
    if !(begins || touches) {
        return no_kick();
    }
    let pull = law.unit_force * law.inverse_unit;
    let outset = jkr_roughly(begin + THREE);
    let t1 = select(pull * TWELFTH * outset.force + begin + THREE, THREE, touches);
    let touch = jkr_point_of(JKR_TOUCH_ROOT, JKR_TOUCH);
    let here = jkr_either(jkr_next(outset, t1), touch, touches);
    let fast = sqrt(max(-TWO * free * begin + speed * speed, ZERO));
    let late = min(select(ZERO, -TWO * begin / max(speed + fast, LEAST), touches), ONE);
    let left = ONE - late;
    let pace = select(speed, fast, touches);
    let near = jkr_roughly(jkr_ahead(t1, pace, left, free, HALF * pull * here.force));
    let guess = jkr_between(here, near);
    let held = pull * (HALF * guess.mean + -guess.moment);
    let t2 = jkr_ahead(t1, pace, left, free, held);
    let lets_go = begins && (t2 < ZERO || t1 < ZERO);
    let there = jkr_either(jkr_next(near, t2), jkr_point_of(ZERO, ZERO), lets_go);
    let part = jkr_between(here, there);
    let height = max(t1, ZERO);
    let bent = -TWO * held + free;
    let falling = sqrt(max(-TWO * bent * height + speed * speed, ZERO));
    let gone = min(TWO * height / max(falling - speed, LEAST), ONE);
    let share = select(left, gone, lets_go);
    let force = law.unit_force * part.mean;
    let bend = at.acceleration - force;
    let slope = max(part.slope * pull, JKR_STEEPEST) * TWELFTH;
    let roots = max(part.roots * part.roots, abs(bend * law.inverse_unit));
    let lean = slope - TENTH * pull * part.bow / roots;
    let impulse = share * (-(bend * lean) * share * share + force);
    let middle = select(HALF, -HALF, lets_go) * (ONE - share);
    let moment = impulse * middle + share * share * (law.unit_force * part.moment);
    let before = select(here.force, ZERO, touches);
    let after = select(there.force, ZERO, lets_go);
    let shift = law.unit_force * TWELFTH * (after - before) + -moment;
    return Kick(impulse, shift, share, select(ONE, ZERO, lets_go));
}

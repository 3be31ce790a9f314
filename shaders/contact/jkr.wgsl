// JKR with its memory, in units of the fold. Twin: crates/kernel/src/contact/jkr.rs

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
    // In parentheses: a product and a sum, not one operation (crates/kernel/src/derived.rs).
    let t1 = select((pull * TWELFTH * outset.force) + begin + THREE, THREE, touches);
    var here = jkr_at(t1);
    var late = ZERO;
    var pace = speed;
    if touches {
        here = jkr_point_of(JKR_TOUCH_ROOT, JKR_TOUCH);
        let fast = sqrt(max(-TWO * free * begin + speed * speed, ZERO));
        late = min(-TWO * begin / max(speed + fast, LEAST), ONE);
        pace = fast;
    }
    let left = ONE - late;
    let near = jkr_roughly(jkr_ahead(t1, pace, left, free, HALF * pull * here.force));
    let guess = jkr_between(here, near);
    let held = pull * (HALF * guess.mean + -guess.moment);
    let t2 = jkr_ahead(t1, pace, left, free, held);
    let lets_go = begins && (t2 < ZERO || t1 < ZERO);
    var there = jkr_at(t2);
    var share = left;
    if lets_go {
        there = jkr_point_of(ZERO, ZERO);
        let height = max(t1, ZERO);
        let bent = -TWO * held + free;
        let falling = sqrt(max(-TWO * bent * height + speed * speed, ZERO));
        share = min(TWO * height / max(falling - speed, LEAST), ONE);
    }
    let part = jkr_between(here, there);
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

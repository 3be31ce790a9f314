// `hertz` as the program writes it for a shader from crates/kernel/src/contact/; do not change it by hand.

fn law_kick(law: Law, at: Approach, touching: real) -> Kick {
    var t1 = ZERO;
    var t2 = ZERO;
    var t3 = ZERO;
    var t4 = ZERO;
    if -(abs(at.speed) + abs(at.acceleration)) < at.indentation {
        let t5 = max(at.indentation, ZERO);
        let t6 = -QUARTER * (law.stiffness * t5 * sqrt(t5)) + HALF * at.speed;
        let t7 = at.acceleration * TWENTY_FOURTH + at.indentation;
        let t8 = t7 - t6;
        let t9 = t7 + t6;
        let t10 = max(t8, ZERO);
        let t11 = max(t9, ZERO);
        let t12 = sqrt(t10);
        let t13 = sqrt(t11);
        let t14 = min(t8, t9);
        let t15 = max(t8, t9);
        let t16 = select(ONE, select(t15 / (t15 - t14), ZERO, t15 < ZERO), t14 < ZERO);
        let t17 = t12 * t13;
        let t18 = t10 + t11;
        let t19 = law.stiffness * t16 / max(t12 + t13, LEAST);
        let t20 = (t18 * (t18 + t17) + -(t17 * t17)) * t19 * HERTZ_ENERGY;
        t1 = -(t20 * ((t18 + t17) * t19)) * TWELFTH + t20;
        t2 = ZERO;
        t3 = t16;
        t4 = select(ZERO, ONE, ZERO < t9);
    }
    return Kick(t1, t2, t3, t4);
}

// `dmt` as the program writes it for a shader from crates/kernel/src/contact/; do not change it by hand.

fn law_kick(law: Law, at: Approach, touching: real) -> Kick {
    let t1 = ONE / (max(-at.indentation, ZERO) * law.inverse_decay + ONE);
    var t2 = -(law.adhesion * t1 * t1);
    if ZERO < at.indentation {
        let t3 = max(at.indentation, ZERO);
        t2 = -(law.adhesion * t1) * t1 + law.stiffness * t3 * sqrt(t3);
    }
    let t4 = -QUARTER * t2 + HALF * at.speed;
    let t5 = at.acceleration * TWENTY_FOURTH + at.indentation;
    let t6 = t5 - t4;
    let t7 = t5 + t4;
    let t8 = max(-t6, ZERO) * law.inverse_decay + ONE;
    let t9 = max(-t7, ZERO) * law.inverse_decay + ONE;
    let t10 = ONE / (t8 * t9);
    let t11 = t8 + t9;
    let t12 = t9 - t8;
    var t13 = ZERO;
    var t14 = ZERO;
    var t15 = ZERO;
    if ZERO < t6 || ZERO < t7 {
        let t16 = max(t6, ZERO);
        let t17 = max(t7, ZERO);
        let t18 = sqrt(t16);
        let t19 = sqrt(t17);
        let t20 = min(t6, t7);
        let t21 = max(t6, t7);
        let t22 = select(ONE, select(t21 / (t21 - t20), ZERO, t21 < ZERO), t20 < ZERO);
        let t23 = t18 * t19;
        let t24 = t16 + t17;
        let t25 = law.stiffness * t22 / max(t18 + t19, LEAST);
        t13 = (t24 * (t24 + t23) + -(t23 * t23)) * t25 * HERTZ_ENERGY;
        t14 = (t24 + t23) * t25;
        t15 = t22;
    }
    let t26 = ONE - t15;
    let t27 = law.adhesion * law.inverse_decay * t26;
    let t28 = t13 - law.adhesion * (t15 * (ONE - t10) + t10);
    let t29 = -(t28 * (t14 - t27 * (t11 * t10 * t10))) * TWELFTH + t28;
    let t30 = t11 < EIGHT * abs(t12) || ZERO < t15;
    var t31 = t29;
    var t32 = ZERO;
    if t30 {
        let t33 = t11 * t11;
        let t34 = TAIL_POLE * t12 * t12 + t33;
        let t35 = ONE / (t34 * t11);
        let t36 = t34 * t35;
        let t37 = t12 * t36;
        let t38 = t37 * t37;
        let t39 = HALF * t11;
        let t40 = t26 * (((TAIL_2 * t38 + TAIL_1) * t38 + THIRD) * (t33 * t11 * t35)) + t15 * t39;
        let t41 = t10 * (t26 * t40 - t39 * t39 * t10 * THIRD);
        let t42 = select(t29, (at.acceleration - t28) * (t27 * t41 * t36) + t29, t30);
        t31 = t42;
        t32 = select(ZERO, -(law.adhesion * t37 * t41), t30);
    }
    return Kick(t31, t32, t15, select(ZERO, ONE, ZERO < t7));
}

// `hertz-shaped` as the program writes it for a shader from crates/kernel/src/contact/; do not change it by hand.

fn law_kick(law: Law, at: Approach, touching: real) -> Kick {
    var t1 = ZERO;
    var t2 = ZERO;
    var t3 = ZERO;
    var t4 = ZERO;
    if -(abs(at.speed) + abs(at.acceleration)) < at.indentation {
        let t5 = max(at.indentation, ZERO);
        let t6 = sqrt(t5);
        let t7 = ((law.force_11 * t6 + law.force_10) * t6 + law.force_9) * t6 + law.force_8;
        let t8 = ((t7 * t6 + law.force_7) * t6 + law.force_6) * t6 + law.force_5;
        let t9 = ((t8 * t6 + law.force_4) * t6 + law.force_3) * t6 + law.force_2;
        let t10 = -QUARTER * (t5 * t9) + HALF * at.speed;
        let t11 = at.acceleration * TWENTY_FOURTH + at.indentation;
        let t12 = t11 - t10;
        let t13 = t11 + t10;
        let t14 = sqrt(max(t12, ZERO));
        let t15 = sqrt(max(t13, ZERO));
        let t16 = min(t12, t13);
        let t17 = max(t12, t13);
        let t18 = select(ONE, select(t17 / (t17 - t16), ZERO, t17 < ZERO), t16 < ZERO);
        let t19 = t14 + t15;
        let t20 = t15 * t15;
        let t21 = t14 * t19 + t20;
        let t22 = t20 * t15;
        let t23 = t14 * t21 + t22;
        let t24 = t22 * t15;
        let t25 = t14 * t23 + t24;
        let t26 = law.force_3 * HERTZ_ENERGY * t25 + (law.force_2 * HALF * t23 + ZERO);
        let t27 = law.force_4 * t23 + (law.force_3 * t21 + (law.force_2 * t19 + ZERO));
        let t28 = t24 * t15;
        let t29 = t14 * t25 + t28;
        let t30 = t28 * t15;
        let t31 = t14 * t29 + t30;
        let t32 = law.force_5 * POWER_MEAN_5 * t31 + (law.force_4 * THIRD * t29 + t26);
        let t33 = t30 * t15;
        let t34 = t14 * t31 + t33;
        let t35 = law.force_7 * t31 + (law.force_6 * t29 + (law.force_5 * t25 + t27));
        let t36 = t33 * t15;
        let t37 = t14 * t34 + t36;
        let t38 = law.force_7 * POWER_MEAN_7 * t37 + (law.force_6 * QUARTER * t34 + t32);
        let t39 = t36 * t15;
        let t40 = t14 * t37 + t39;
        let t41 = t39 * t15;
        let t42 = t14 * t40 + t41;
        let t43 = law.force_9 * POWER_MEAN_9 * t42 + (law.force_8 * POWER_MEAN_8 * t40 + t38);
        let t44 = law.force_10 * t40 + (law.force_9 * t37 + (law.force_8 * t34 + t35));
        let t45 = t41 * t15;
        let t46 = t14 * t42 + t45;
        let t47 = law.force_11 * POWER_MEAN_11 * (t14 * t46 + t45 * t15) + (law.force_10 * SIXTH * t46 + t43);
        let t48 = t18 / max(t19, LEAST);
        let t49 = t47 * t48;
        t1 = -(t49 * ((law.force_11 * t42 + t44) * t48)) * TWELFTH + t49;
        t2 = ZERO;
        t3 = t18;
        t4 = select(ZERO, ONE, ZERO < t13);
    }
    return Kick(t1, t2, t3, t4);
}

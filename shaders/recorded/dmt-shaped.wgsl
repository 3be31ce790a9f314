// `dmt-shaped` as the program writes it for a shader from crates/kernel/src/contact/; do not change it by hand.

fn law_kick(law: Law, at: Approach, touching: real) -> Kick {
    let t1 = ONE / (max(-at.indentation, ZERO) * law.inverse_decay + ONE);
    var t2 = -(law.adhesion * t1 * t1);
    if ZERO < at.indentation {
        let t3 = max(at.indentation, ZERO);
        let t4 = sqrt(t3);
        let t5 = ((law.force_11 * t4 + law.force_10) * t4 + law.force_9) * t4 + law.force_8;
        let t6 = ((t5 * t4 + law.force_7) * t4 + law.force_6) * t4 + law.force_5;
        let t7 = ((t6 * t4 + law.force_4) * t4 + law.force_3) * t4 + law.force_2;
        t2 = -(law.adhesion * t1) * t1 + t3 * t7;
    }
    let t8 = -QUARTER * t2 + HALF * at.speed;
    let t9 = at.acceleration * TWENTY_FOURTH + at.indentation;
    let t10 = t9 - t8;
    let t11 = t9 + t8;
    let t12 = max(-t10, ZERO) * law.inverse_decay + ONE;
    let t13 = max(-t11, ZERO) * law.inverse_decay + ONE;
    let t14 = ONE / (t12 * t13);
    let t15 = t12 + t13;
    let t16 = t13 - t12;
    var t17 = ZERO;
    var t18 = ZERO;
    var t19 = ZERO;
    if ZERO < t10 || ZERO < t11 {
        let t20 = sqrt(max(t10, ZERO));
        let t21 = sqrt(max(t11, ZERO));
        let t22 = min(t10, t11);
        let t23 = max(t10, t11);
        let t24 = select(ONE, select(t23 / (t23 - t22), ZERO, t23 < ZERO), t22 < ZERO);
        let t25 = t20 + t21;
        let t26 = t21 * t21;
        let t27 = t20 * t25 + t26;
        let t28 = t26 * t21;
        let t29 = t20 * t27 + t28;
        let t30 = t28 * t21;
        let t31 = t20 * t29 + t30;
        let t32 = law.force_3 * HERTZ_ENERGY * t31 + (law.force_2 * HALF * t29 + ZERO);
        let t33 = law.force_4 * t29 + (law.force_3 * t27 + (law.force_2 * t25 + ZERO));
        let t34 = t30 * t21;
        let t35 = t20 * t31 + t34;
        let t36 = t34 * t21;
        let t37 = t20 * t35 + t36;
        let t38 = law.force_5 * POWER_MEAN_5 * t37 + (law.force_4 * THIRD * t35 + t32);
        let t39 = t36 * t21;
        let t40 = t20 * t37 + t39;
        let t41 = law.force_7 * t37 + (law.force_6 * t35 + (law.force_5 * t31 + t33));
        let t42 = t39 * t21;
        let t43 = t20 * t40 + t42;
        let t44 = law.force_7 * POWER_MEAN_7 * t43 + (law.force_6 * QUARTER * t40 + t38);
        let t45 = t42 * t21;
        let t46 = t20 * t43 + t45;
        let t47 = t45 * t21;
        let t48 = t20 * t46 + t47;
        let t49 = law.force_9 * POWER_MEAN_9 * t48 + (law.force_8 * POWER_MEAN_8 * t46 + t44);
        let t50 = law.force_10 * t46 + (law.force_9 * t43 + (law.force_8 * t40 + t41));
        let t51 = t47 * t21;
        let t52 = t20 * t48 + t51;
        let t53 = law.force_11 * POWER_MEAN_11 * (t20 * t52 + t51 * t21) + (law.force_10 * SIXTH * t52 + t49);
        let t54 = t24 / max(t25, LEAST);
        t17 = t53 * t54;
        t18 = (law.force_11 * t48 + t50) * t54;
        t19 = t24;
    }
    let t55 = ONE - t19;
    let t56 = law.adhesion * law.inverse_decay * t55;
    let t57 = t17 - law.adhesion * (t19 * (ONE - t14) + t14);
    let t58 = -(t57 * (t18 - t56 * (t15 * t14 * t14))) * TWELFTH + t57;
    let t59 = t15 < EIGHT * abs(t16) || ZERO < t19;
    var t60 = t58;
    var t61 = ZERO;
    if t59 {
        let t62 = t15 * t15;
        let t63 = TAIL_POLE * t16 * t16 + t62;
        let t64 = ONE / (t63 * t15);
        let t65 = t63 * t64;
        let t66 = t16 * t65;
        let t67 = t66 * t66;
        let t68 = HALF * t15;
        let t69 = t55 * (((TAIL_2 * t67 + TAIL_1) * t67 + THIRD) * (t62 * t15 * t64)) + t19 * t68;
        let t70 = t14 * (t55 * t69 - t68 * t68 * t14 * THIRD);
        let t71 = select(t58, (at.acceleration - t57) * (t56 * t70 * t65) + t58, t59);
        t60 = t71;
        t61 = select(ZERO, -(law.adhesion * t66 * t70), t59);
    }
    return Kick(t60, t61, t19, select(ZERO, ONE, ZERO < t11));
}

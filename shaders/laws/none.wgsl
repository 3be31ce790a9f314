// The kick of the law `none` as the program writes it for a shader (crates/kernel/src/contact/); not to be changed by hand.

fn law_kick(law: Law, at: Approach, touching: real) -> Kick {
    return Kick(ZERO, ZERO, ZERO, ZERO);
}

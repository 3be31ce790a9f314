// `none` as the program writes it for a shader from crates/kernel/src/contact/; do not change it by hand.

fn law_kick(law: Law, at: Approach, touching: real) -> Kick {
    return Kick(ZERO, ZERO, ZERO, ZERO);
}

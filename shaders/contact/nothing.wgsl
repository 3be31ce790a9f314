// No sample at all. Twin: crates/kernel/src/contact/mod.rs

fn nothing_kick(law: Law, at: Approach, touching: real) -> Kick {
    return no_kick();
}

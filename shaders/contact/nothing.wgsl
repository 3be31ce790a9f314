// No sample at all. Twin: src/kernel/contact/mod.rs

fn nothing_kick(law: Law, at: Approach, touching: real) -> Kick {
    return no_kick();
}

// Time in contact, contacts begun and ended. Twin: crates/kernel/src/tally.rs

fn tally_contact(tally: ptr<function, Tally>, sample: Sample) {
    let before = ZERO < (*tally).touched;
    let now = ZERO < sample.kick.touching;
    (*tally).time = (*tally).time + sample.kick.contact;
    (*tally).begun = (*tally).begun + select(ZERO, ONE, now && !before);
    (*tally).ended = (*tally).ended + select(ZERO, ONE, before && !now);
    (*tally).apart = select(ONE, (*tally).apart, now);
}

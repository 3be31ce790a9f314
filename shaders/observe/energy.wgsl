// Impulse, its work and its virial. Twin: crates/kernel/src/tally.rs

fn tally_energy(tally: ptr<function, Tally>, sample: Sample) {
    (*tally).impulse = (*tally).impulse + sample.kick.impulse;
    (*tally).work = (*tally).work + sample.work;
    (*tally).virial = (*tally).virial + sample.virial;
}

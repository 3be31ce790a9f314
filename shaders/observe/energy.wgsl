// Impulse, its work and its virial. Twin: src/kernel/tally.rs

fn tally_energy(tally: ptr<function, Tally>, sample: Sample) {
    let impulse = sample.kick.impulse;
    (*tally).impulse = (*tally).impulse + impulse;
    (*tally).work = impulse * sample.speed + (*tally).work;
    (*tally).virial = impulse * sample.centred + (*tally).virial;
}

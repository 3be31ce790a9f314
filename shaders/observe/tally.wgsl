// Sums and extremes over the steps of a period. Twin: src/kernel/tally.rs

struct Tally {
    //% each harmonic
    cosine_$: real,
    sine_$: real,
    //% end
    //% if extremes
    deepest: real,
    highest: real,
    held: real,
    //% end
    //% if contact
    time: real,
    begun: real,
    ended: real,
    apart: real,
    //% end
    //% if energy
    impulse: real,
    work: real,
    virial: real,
    //% end
    //% if carried
    last_0: real,
    last_1: real,
    touched: real,
    //% end
}

fn tally_next_period(tally: ptr<function, Tally>) {
    //% each harmonic
    (*tally).cosine_$ = ZERO;
    (*tally).sine_$ = ZERO;
    //% end
    //% if extremes
    (*tally).deepest = -FAR;
    (*tally).highest = FAR;
    (*tally).held = FAR;
    //% end
    //% if contact
    (*tally).time = ZERO;
    (*tally).begun = ZERO;
    (*tally).ended = ZERO;
    (*tally).apart = ZERO;
    //% end
    //% if energy
    (*tally).impulse = ZERO;
    (*tally).work = ZERO;
    (*tally).virial = ZERO;
    //% end
}

fn tally_add(tally: ptr<function, Tally>, sample: Sample, index: u32) {
    tally_fourier(tally, sample, index);
    //% if extremes
    tally_extremes(tally, sample);
    //% end
    //% if contact
    tally_contact(tally, sample);
    //% end
    //% if energy
    tally_energy(tally, sample);
    //% end
    //% if carried
    // Kept up before the measured part too: its first sample needs its predecessors.
    (*tally).last_0 = (*tally).last_1;
    (*tally).last_1 = sample.indentation;
    (*tally).touched = sample.kick.touching;
    //% end
}

// Sums and extremes over the steps of a period, by the list in crates/kernel/src/sums.rs. Twin: crates/kernel/src/tally.rs

struct Tally {
    //% each harmonic
    cosine_$: real,
    sine_$: real,
    //% end
    //% each sum
    $: real,
    //% end
    //% if looks back
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
    //% each total
    (*tally).$ = ZERO;
    //% end
    //% each largest
    (*tally).$ = -FAR;
    //% end
    //% each smallest
    (*tally).$ = FAR;
    //% end
    //% each ever
    (*tally).$ = ZERO;
    //% end
}

fn tally_add(tally: ptr<function, Tally>, sample: Sample, index: u32) {
    tally_fourier(tally, sample, index);
    //% each group
    tally_$(tally, sample);
    //% end
    //% if looks back
    // Kept up before the measured part too: its first sample needs its predecessors.
    (*tally).last_0 = (*tally).last_1;
    (*tally).last_1 = sample.indentation;
    (*tally).touched = sample.kick.touching;
    //% end
}

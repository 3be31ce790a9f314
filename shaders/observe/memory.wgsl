// The tally of a period that a dispatch ends in the middle of.

fn tally_of(i: u32) -> Tally {
    var tally: Tally;
    tally_next_period(&tally);
    // A dispatch may begin within a period.
    if job.first > 0u {
        //% each harmonic
        tally.cosine_$ = states[at(TALLY_COSINE_$, i)];
        tally.sine_$ = states[at(TALLY_SINE_$, i)];
        //% end
        //% each sum
        tally.$ = states[at(TALLY_$$, i)];
        //% end
    }
    //% if looks back
    tally.last_0 = states[at(TALLY_LAST_0, i)];
    tally.last_1 = states[at(TALLY_LAST_1, i)];
    tally.touched = states[at(TALLY_TOUCHED, i)];
    //% end
    return tally;
}

fn store_tally(i: u32, tally: Tally) {
    //% each harmonic
    states[at(TALLY_COSINE_$, i)] = tally.cosine_$;
    states[at(TALLY_SINE_$, i)] = tally.sine_$;
    //% end
    //% each sum
    states[at(TALLY_$$, i)] = tally.$;
    //% end
    //% if looks back
    states[at(TALLY_LAST_0, i)] = tally.last_0;
    states[at(TALLY_LAST_1, i)] = tally.last_1;
    states[at(TALLY_TOUCHED, i)] = tally.touched;
    //% end
}

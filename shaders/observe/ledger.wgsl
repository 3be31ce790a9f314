// Takes a period into the run's ledger, which stays in its buffer. Twin: crates/kernel/src/ledger.rs

fn close_period(i: u32, tally: Tally) {
    let cosine = tally.cosine_0 - states[at(LEDGER_LAST_COSINE, i)];
    let sine = tally.sine_0 - states[at(LEDGER_LAST_SINE, i)];
    let change = TWO / real(job.steps) * sqrt(cosine * cosine + sine * sine);
    states[at(LEDGER_LAST_COSINE, i)] = tally.cosine_0;
    states[at(LEDGER_LAST_SINE, i)] = tally.sine_0;
    states[at(LEDGER_CHANGE_3, i)] = states[at(LEDGER_CHANGE_2, i)];
    states[at(LEDGER_CHANGE_2, i)] = states[at(LEDGER_CHANGE_1, i)];
    states[at(LEDGER_CHANGE_1, i)] = states[at(LEDGER_CHANGE_0, i)];
    states[at(LEDGER_CHANGE_0, i)] = change;
    //% if measured
    states[at(LEDGER_LARGEST, i)] = max(states[at(LEDGER_LARGEST, i)], change);
    //% each harmonic
    states[at(LEDGER_COSINE_$, i)] = states[at(LEDGER_COSINE_$, i)] + tally.cosine_$;
    states[at(LEDGER_SINE_$, i)] = states[at(LEDGER_SINE_$, i)] + tally.sine_$;
    //% end
    //% end
    //% each total
    states[at(LEDGER_$$, i)] = states[at(LEDGER_$$, i)] + tally.$;
    //% end
    //% each largest
    states[at(LEDGER_$$, i)] = max(states[at(LEDGER_$$, i)], tally.$);
    //% end
    //% each smallest
    states[at(LEDGER_$$, i)] = min(states[at(LEDGER_$$, i)], tally.$);
    //% end
    //% each ever
    states[at(LEDGER_$$, i)] = max(states[at(LEDGER_$$, i)], tally.$);
    //% end
}

// Takes a period into the run's ledger, which stays in its buffer. Twin: src/kernel/ledger.rs

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
    //% if extremes
    states[at(LEDGER_DEEPEST, i)] = max(states[at(LEDGER_DEEPEST, i)], tally.deepest);
    states[at(LEDGER_HIGHEST, i)] = min(states[at(LEDGER_HIGHEST, i)], tally.highest);
    states[at(LEDGER_HELD, i)] = min(states[at(LEDGER_HELD, i)], tally.held);
    //% end
    //% if contact
    states[at(LEDGER_TIME, i)] = states[at(LEDGER_TIME, i)] + tally.time;
    states[at(LEDGER_BEGUN, i)] = states[at(LEDGER_BEGUN, i)] + tally.begun;
    states[at(LEDGER_ENDED, i)] = states[at(LEDGER_ENDED, i)] + tally.ended;
    states[at(LEDGER_APART, i)] = max(states[at(LEDGER_APART, i)], tally.apart);
    //% end
    //% if energy
    states[at(LEDGER_IMPULSE, i)] = states[at(LEDGER_IMPULSE, i)] + tally.impulse;
    states[at(LEDGER_WORK, i)] = states[at(LEDGER_WORK, i)] + tally.work;
    states[at(LEDGER_VIRIAL, i)] = states[at(LEDGER_VIRIAL, i)] + tally.virial;
    //% end
}

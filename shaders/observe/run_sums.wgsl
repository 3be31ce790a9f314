// Takes a period into the run's sums, which stays in its buffer. Twin: crates/kernel/src/run_sums.rs

fn close_period(i: u32, tally: Tally) {
    let cosine = tally.cosine_0 - states[at(RUN_SUMS_LAST_COSINE, i)];
    let sine = tally.sine_0 - states[at(RUN_SUMS_LAST_SINE, i)];
    let change = TWO / real(job.steps) * sqrt(cosine * cosine + sine * sine);
    states[at(RUN_SUMS_LAST_COSINE, i)] = tally.cosine_0;
    states[at(RUN_SUMS_LAST_SINE, i)] = tally.sine_0;
    states[at(RUN_SUMS_CHANGE_3, i)] = states[at(RUN_SUMS_CHANGE_2, i)];
    states[at(RUN_SUMS_CHANGE_2, i)] = states[at(RUN_SUMS_CHANGE_1, i)];
    states[at(RUN_SUMS_CHANGE_1, i)] = states[at(RUN_SUMS_CHANGE_0, i)];
    states[at(RUN_SUMS_CHANGE_0, i)] = change;
    //% if measured
    states[at(RUN_SUMS_LARGEST, i)] = max(states[at(RUN_SUMS_LARGEST, i)], change);
    //% each harmonic
    states[at(RUN_SUMS_COSINE_$, i)] = states[at(RUN_SUMS_COSINE_$, i)] + tally.cosine_$;
    states[at(RUN_SUMS_SINE_$, i)] = states[at(RUN_SUMS_SINE_$, i)] + tally.sine_$;
    //% end
    //% end
    //% each total
    states[at(RUN_SUMS_$$, i)] = states[at(RUN_SUMS_$$, i)] + tally.$;
    //% end
    //% each largest
    states[at(RUN_SUMS_$$, i)] = max(states[at(RUN_SUMS_$$, i)], tally.$);
    //% end
    //% each smallest
    states[at(RUN_SUMS_$$, i)] = min(states[at(RUN_SUMS_$$, i)], tally.$);
    //% end
    //% each ever
    states[at(RUN_SUMS_$$, i)] = max(states[at(RUN_SUMS_$$, i)], tally.$);
    //% end
}

// The run's sums before the first period: there was free flight. Twin: crates/kernel/src/run_sums.rs

fn begin_run(i: u32) {
    states[at(RUN_SUMS_LAST_COSINE, i)] = ZERO;
    states[at(RUN_SUMS_LAST_SINE, i)] = ZERO;
    states[at(RUN_SUMS_CHANGE_0, i)] = ZERO;
    states[at(RUN_SUMS_CHANGE_1, i)] = ZERO;
    states[at(RUN_SUMS_CHANGE_2, i)] = ZERO;
    states[at(RUN_SUMS_CHANGE_3, i)] = ZERO;
    states[at(RUN_SUMS_LARGEST, i)] = ZERO;
    //% each harmonic
    states[at(RUN_SUMS_COSINE_$, i)] = ZERO;
    states[at(RUN_SUMS_SINE_$, i)] = ZERO;
    //% end
    //% each total
    states[at(RUN_SUMS_$$, i)] = ZERO;
    //% end
    //% each largest
    states[at(RUN_SUMS_$$, i)] = -FAR;
    //% end
    //% each smallest
    states[at(RUN_SUMS_$$, i)] = FAR;
    //% end
    //% each ever
    states[at(RUN_SUMS_$$, i)] = ZERO;
    //% end
}

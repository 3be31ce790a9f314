// `sums` as the program writes it for a shader from crates/kernel/src/tally.rs and run_sums.rs; do not change it by hand.

struct Tally {
    cosine_0: real,
    sine_0: real,
    cosine_1: real,
    sine_1: real,
    deepest: real,
    highest: real,
    held: real,
    strongest: real,
    weakest: real,
    time: real,
    begun: real,
    ended: real,
    apart: real,
    impulse: real,
    work: real,
    virial: real,
    last_0: real,
    last_1: real,
    touched: real,
}

fn tally_of(i: u32) -> Tally {
    return Tally(
        states[at(TALLY_COSINE_0, i)],
        states[at(TALLY_SINE_0, i)],
        states[at(TALLY_COSINE_1, i)],
        states[at(TALLY_SINE_1, i)],
        states[at(TALLY_DEEPEST, i)],
        states[at(TALLY_HIGHEST, i)],
        states[at(TALLY_HELD, i)],
        states[at(TALLY_STRONGEST, i)],
        states[at(TALLY_WEAKEST, i)],
        states[at(TALLY_TIME, i)],
        states[at(TALLY_BEGUN, i)],
        states[at(TALLY_ENDED, i)],
        states[at(TALLY_APART, i)],
        states[at(TALLY_IMPULSE, i)],
        states[at(TALLY_WORK, i)],
        states[at(TALLY_VIRIAL, i)],
        states[at(TALLY_LAST_0, i)],
        states[at(TALLY_LAST_1, i)],
        states[at(TALLY_TOUCHED, i)],
    );
}

fn store_tally(i: u32, tally: Tally) {
    states[at(TALLY_COSINE_0, i)] = tally.cosine_0;
    states[at(TALLY_SINE_0, i)] = tally.sine_0;
    states[at(TALLY_COSINE_1, i)] = tally.cosine_1;
    states[at(TALLY_SINE_1, i)] = tally.sine_1;
    states[at(TALLY_DEEPEST, i)] = tally.deepest;
    states[at(TALLY_HIGHEST, i)] = tally.highest;
    states[at(TALLY_HELD, i)] = tally.held;
    states[at(TALLY_STRONGEST, i)] = tally.strongest;
    states[at(TALLY_WEAKEST, i)] = tally.weakest;
    states[at(TALLY_TIME, i)] = tally.time;
    states[at(TALLY_BEGUN, i)] = tally.begun;
    states[at(TALLY_ENDED, i)] = tally.ended;
    states[at(TALLY_APART, i)] = tally.apart;
    states[at(TALLY_IMPULSE, i)] = tally.impulse;
    states[at(TALLY_WORK, i)] = tally.work;
    states[at(TALLY_VIRIAL, i)] = tally.virial;
    states[at(TALLY_LAST_0, i)] = tally.last_0;
    states[at(TALLY_LAST_1, i)] = tally.last_1;
    states[at(TALLY_TOUCHED, i)] = tally.touched;
}

fn tally_add(tally: Tally, sample: Sample, index: u32) -> Tally {
    let t1 = sample.beyond * waves[2u * (0u * job.steps + index)] + tally.cosine_0;
    let t2 = sample.beyond * waves[2u * (0u * job.steps + index) + 1u] + tally.sine_0;
    let t3 = sample.beyond * waves[2u * (1u * job.steps + index)] + tally.cosine_1;
    let t4 = sample.beyond * waves[2u * (1u * job.steps + index) + 1u] + tally.sine_1;
    let t5 = (tally.last_1 - tally.last_0) * (sample.indentation - tally.last_1);
    let t6 = sample.indentation - tally.last_0;
    let t7 = sample.indentation - tally.last_1 - (tally.last_1 - tally.last_0);
    let t8 = select(tally.last_1, tally.last_1 - t6 * t6 / (EIGHT * t7), t5 < ZERO);
    let t9 = min(tally.held, select(tally.held, t8, ZERO < tally.touched));
    let t10 = ZERO < tally.touched;
    let t11 = ZERO < sample.kick.touching;
    return Tally(
        t1,
        t2,
        t3,
        t4,
        max(tally.deepest, t8),
        min(tally.highest, t8),
        t9,
        max(tally.strongest, sample.most),
        min(tally.weakest, sample.least),
        tally.time + sample.kick.contact,
        tally.begun + select(ZERO, ONE, t11 && !t10),
        tally.ended + select(ZERO, ONE, t10 && !t11),
        select(ONE, tally.apart, t11),
        tally.impulse + sample.kick.impulse,
        tally.work + sample.work,
        tally.virial + sample.virial,
        tally.last_1,
        sample.indentation,
        sample.kick.touching,
    );
}

fn tally_next_period(tally: Tally) -> Tally {
    return Tally(
        ZERO,
        ZERO,
        ZERO,
        ZERO,
        -FAR,
        FAR,
        FAR,
        -FAR,
        FAR,
        ZERO,
        ZERO,
        ZERO,
        ZERO,
        ZERO,
        ZERO,
        ZERO,
        tally.last_0,
        tally.last_1,
        tally.touched,
    );
}

struct RunSums {
    last_cosine: real,
    last_sine: real,
    change_0: real,
    change_1: real,
    change_2: real,
    change_3: real,
    largest: real,
    cosine_0: real,
    sine_0: real,
    cosine_1: real,
    sine_1: real,
    deepest: real,
    highest: real,
    held: real,
    strongest: real,
    weakest: real,
    time: real,
    begun: real,
    ended: real,
    apart: real,
    impulse: real,
    work: real,
    virial: real,
}

fn run_sums_of(i: u32) -> RunSums {
    return RunSums(
        states[at(RUN_SUMS_LAST_COSINE, i)],
        states[at(RUN_SUMS_LAST_SINE, i)],
        states[at(RUN_SUMS_CHANGE_0, i)],
        states[at(RUN_SUMS_CHANGE_1, i)],
        states[at(RUN_SUMS_CHANGE_2, i)],
        states[at(RUN_SUMS_CHANGE_3, i)],
        states[at(RUN_SUMS_LARGEST, i)],
        states[at(RUN_SUMS_COSINE_0, i)],
        states[at(RUN_SUMS_SINE_0, i)],
        states[at(RUN_SUMS_COSINE_1, i)],
        states[at(RUN_SUMS_SINE_1, i)],
        states[at(RUN_SUMS_DEEPEST, i)],
        states[at(RUN_SUMS_HIGHEST, i)],
        states[at(RUN_SUMS_HELD, i)],
        states[at(RUN_SUMS_STRONGEST, i)],
        states[at(RUN_SUMS_WEAKEST, i)],
        states[at(RUN_SUMS_TIME, i)],
        states[at(RUN_SUMS_BEGUN, i)],
        states[at(RUN_SUMS_ENDED, i)],
        states[at(RUN_SUMS_APART, i)],
        states[at(RUN_SUMS_IMPULSE, i)],
        states[at(RUN_SUMS_WORK, i)],
        states[at(RUN_SUMS_VIRIAL, i)],
    );
}

fn store_run_sums(i: u32, run_sums: RunSums) {
    states[at(RUN_SUMS_LAST_COSINE, i)] = run_sums.last_cosine;
    states[at(RUN_SUMS_LAST_SINE, i)] = run_sums.last_sine;
    states[at(RUN_SUMS_CHANGE_0, i)] = run_sums.change_0;
    states[at(RUN_SUMS_CHANGE_1, i)] = run_sums.change_1;
    states[at(RUN_SUMS_CHANGE_2, i)] = run_sums.change_2;
    states[at(RUN_SUMS_CHANGE_3, i)] = run_sums.change_3;
    states[at(RUN_SUMS_LARGEST, i)] = run_sums.largest;
    states[at(RUN_SUMS_COSINE_0, i)] = run_sums.cosine_0;
    states[at(RUN_SUMS_SINE_0, i)] = run_sums.sine_0;
    states[at(RUN_SUMS_COSINE_1, i)] = run_sums.cosine_1;
    states[at(RUN_SUMS_SINE_1, i)] = run_sums.sine_1;
    states[at(RUN_SUMS_DEEPEST, i)] = run_sums.deepest;
    states[at(RUN_SUMS_HIGHEST, i)] = run_sums.highest;
    states[at(RUN_SUMS_HELD, i)] = run_sums.held;
    states[at(RUN_SUMS_STRONGEST, i)] = run_sums.strongest;
    states[at(RUN_SUMS_WEAKEST, i)] = run_sums.weakest;
    states[at(RUN_SUMS_TIME, i)] = run_sums.time;
    states[at(RUN_SUMS_BEGUN, i)] = run_sums.begun;
    states[at(RUN_SUMS_ENDED, i)] = run_sums.ended;
    states[at(RUN_SUMS_APART, i)] = run_sums.apart;
    states[at(RUN_SUMS_IMPULSE, i)] = run_sums.impulse;
    states[at(RUN_SUMS_WORK, i)] = run_sums.work;
    states[at(RUN_SUMS_VIRIAL, i)] = run_sums.virial;
}

fn close_period(run_sums: RunSums, tally: Tally) -> RunSums {
    let t1 = tally.cosine_0 - run_sums.last_cosine;
    let t2 = tally.sine_0 - run_sums.last_sine;
    let t3 = TWO / real(job.steps) * sqrt(t1 * t1 + t2 * t2);
    return RunSums(
        tally.cosine_0,
        tally.sine_0,
        t3,
        run_sums.change_0,
        run_sums.change_1,
        run_sums.change_2,
        max(run_sums.largest, t3),
        run_sums.cosine_0 + tally.cosine_0,
        run_sums.sine_0 + tally.sine_0,
        run_sums.cosine_1 + tally.cosine_1,
        run_sums.sine_1 + tally.sine_1,
        max(run_sums.deepest, tally.deepest),
        min(run_sums.highest, tally.highest),
        min(run_sums.held, tally.held),
        max(run_sums.strongest, tally.strongest),
        min(run_sums.weakest, tally.weakest),
        run_sums.time + tally.time,
        run_sums.begun + tally.begun,
        run_sums.ended + tally.ended,
        max(run_sums.apart, tally.apart),
        run_sums.impulse + tally.impulse,
        run_sums.work + tally.work,
        run_sums.virial + tally.virial,
    );
}

// Travel beyond the steady free one, by harmonic. Twin: crates/kernel/src/tally.rs

fn tally_fourier(tally: ptr<function, Tally>, sample: Sample, index: u32) {
    //% each harmonic
    let at_$ = 2u * ($u * job.steps + index);
    (*tally).cosine_$ = sample.beyond * waves[at_$] + (*tally).cosine_$;
    (*tally).sine_$ = sample.beyond * waves[at_$ + 1u] + (*tally).sine_$;
    //% end
}

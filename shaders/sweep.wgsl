// A run's bindings and entry point: one thread takes one instance through a dispatch's steps.

// Cosine and sine of the drive's phase: [harmonic][step][2].
@group(0) @binding(1) var<storage, read> waves: array<real>;
// Constants of each driven instrument: [field][drive].
@group(0) @binding(2) var<storage, read> drives: array<real>;
// Constants of each instance: [field][instance].
@group(0) @binding(3) var<storage, read> cases: array<real>;
// Which drive each instance has.
@group(0) @binding(4) var<storage, read> drive_of: array<u32>;
// Where each instance is, and what it has measured: [field][instance].
@group(0) @binding(5) var<storage, read_write> states: array<real>;
// Steps done, and whether the state stopped being a number: [2][instance].
@group(0) @binding(6) var<storage, read_write> marks: array<u32>;
// How many instances are under way in each round and after the last; then which these are, in lists that take turns.
@group(0) @binding(7) var<storage, read> going: array<u32>;
//% if decay
// Decaying free motion at this dispatch's steps: [drive][step][3].
@group(0) @binding(8) var<storage, read> decays: array<real>;
//% end

@compute @workgroup_size(WORKGROUP)
fn sweep(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let number = thread(group, local);
    if number >= going[job.round] {
        return;
    }
    let i = going[listed(job.round, number)];
    let lever = case_of(i);
    let law = law_of(i);
    var state = state_of(i);
    var tally = tally_of(i);
    // A dispatch may begin within a period.
    if job.first == 0u {
        tally = tally_next_period(tally);
    }
    var numbers = true;
    var index = job.first;
    var done = 0u;
    loop {
        if done >= job.count {
            break;
        }
        var decay: Decay;
        //% if decay
        let row = 3u * (drive_of[i] * job.count + done);
        decay = Decay(decays[row], decays[row + 1u], decays[row + 2u]);
        //% end
        let sample = step(lever, law, &state, waves[2u * index], waves[2u * index + 1u], decay);
        tally = tally_add(tally, sample, index);
        done += 1u;
        index += 1u;
        if index == job.steps {
            //% each mode
            numbers = numbers && finite(state.x_$) && finite(state.u_$);
            //% end
            store_run_sums(i, close_period(run_sums_of(i), tally));
            tally = tally_next_period(tally);
            index = 0u;
        }
    }
    store_state(i, state);
    store_tally(i, tally);
    marks[i] = marks[i] + done;
    if !numbers {
        marks[job.instances + i] = 1u;
    }
}

// What searches share: the instances under way, the numbers of a state, and what becomes of it. Twin: crates/kernel/src/broyden.rs
// A state's numbers, NUMBERS, are counted up to `job.count`, which says the same: where loops have constant bounds, drivers write
// out each of their turns, and compile a second for what takes microseconds.

// Constants of each instance: [field][instance].
@group(0) @binding(1) var<storage, read> cases: array<real>;
// How many instances are under way in each round and after the last; then which these are, in two lists that take turns.
@group(0) @binding(2) var<storage, read_write> going: array<atomic<u32>>;
// Where each instance is, and what it has measured, if anything: [field][instance].
@group(0) @binding(3) var<storage, read_write> states: array<real>;
// Steps done, whether the state stopped being a number (beside slopes, steps since the last kick written down), and what has become
// of it: [3][instance]. Beside slopes others follow.
@group(0) @binding(4) var<storage, read_write> marks: array<u32>;

// What becomes of an instance.
const ON: u32 = 0u;
const FOUND: u32 = 1u;
const LOST: u32 = 2u;

alias Numbers = array<real, NUMBERS>;

// Where a number of a matrix is, or a row of it begins.
fn entry(column: u32, row: u32, i: u32) -> u32 {
    return at(column * NUMBERS + row, i);
}

fn product(a: ptr<function, Numbers>, b: ptr<function, Numbers>) -> real {
    var even = ZERO;
    var odd = ZERO;
    var k = 0u;
    loop {
        if k >= job.count {
            break;
        }
        even = (*a)[k] * (*b)[k] + even;
        odd = (*a)[k + 1u] * (*b)[k + 1u] + odd;
        k += 2u;
    }
    return even + odd;
}

// Puts an instance on the list of the next round. Which place it gets hangs on the threads; what becomes of it does not.
fn goes_on(i: u32) {
    let place = atomicAdd(&going[job.round + 1u], 1u);
    atomicStore(&going[listed(job.round + 1u, place)], i);
}

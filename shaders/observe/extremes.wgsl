// The middle of the last three samples, moved to the top of their parabola where it is one.
// Twin: crates/kernel/src/tally.rs

fn tally_extremes(tally: ptr<function, Tally>, sample: Sample) {
    let first = (*tally).last_0;
    let middle = (*tally).last_1;
    let next = sample.indentation;
    let turns = (middle - first) * (next - middle) < ZERO;
    let slope = next - first;
    let bend = (next - middle) - (middle - first);
    let top = middle - slope * slope / (EIGHT * bend);
    let value = select(middle, top, turns);
    (*tally).deepest = max((*tally).deepest, value);
    (*tally).highest = min((*tally).highest, value);
    let held = select((*tally).held, value, ZERO < (*tally).touched);
    (*tally).held = min((*tally).held, held);
}

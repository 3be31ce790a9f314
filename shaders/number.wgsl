// Whether a number is one, by its exponent's bits: comparisons with NaN are not to be trusted.
fn finite(value: real) -> bool {
    return (bitcast<u32>(f32(value)) & EXPONENT) != EXPONENT;
}

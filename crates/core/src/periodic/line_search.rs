//! Roots and maxima of a function of one number.

/// A root between `a` and `b`, where the function has different signs or is zero, to rounding.
pub fn root(a: f64, b: f64, function: impl Fn(f64) -> f64) -> f64 {
    root_within(a, b, 0.0, function)
}

/// The same, or a place where the function is no larger than `small`: bisection made faster by secants (Illinois).
pub fn root_within(mut a: f64, mut b: f64, small: f64, function: impl Fn(f64) -> f64) -> f64 {
    let (mut fa, mut fb) = (function(a), function(b));
    let mut side = 0;
    for step in 0..200 {
        if fa.abs() <= small {
            return a;
        }
        if fb.abs() <= small || (b - a).abs() <= 2.0 * f64::EPSILON * b.abs() {
            return b;
        }
        // A bisection replaces a secant that stalls.
        let c = if step % 8 == 7 { 0.5 * (a + b) } else { (a * fb - b * fa) / (fb - fa) };
        let c = if c > a && c < b { c } else { 0.5 * (a + b) };
        if c == a || c == b {
            return b;
        }
        let fc = function(c);
        if fc * fb > 0.0 || (fc == 0.0 && fb != 0.0) {
            (b, fb) = (c, fc);
            if side == 1 {
                fa *= 0.5;
            }
            side = 1;
        } else {
            (a, fa) = (c, fc);
            if side == -1 {
                fb *= 0.5;
            }
            side = -1;
        }
    }
    b
}

/// Where a function with one maximum is largest: golden sections.
pub fn highest(mut a: f64, mut b: f64, function: impl Fn(f64) -> f64) -> f64 {
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    for _ in 0..36 {
        let (low, high) = (b - GOLDEN * (b - a), a + GOLDEN * (b - a));
        if function(low) > function(high) { b = high } else { a = low }
    }
    0.5 * (a + b)
}

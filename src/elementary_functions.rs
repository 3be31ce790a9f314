//! Sines, exponentials and their kin by one library on every system, in place of the C library's own. With them, and with
//! every operation rounded (`AFMSWEEP_ROUNDING=twice`), a run has the same bits on any processor and in a browser.
//!
//! The linker takes a symbol that the program defines before one of a shared library.

macro_rules! elementary_functions {
    ($($name:ident($($number:ident),*))*) => { $(
        #[unsafe(no_mangle)]
        extern "C" fn $name($($number: f64),*) -> f64 {
            libm::$name($($number),*)
        }
    )* };
}

elementary_functions! {
    sin(x) cos(x) tan(x) asin(x) acos(x) atan(x) atan2(y, x) sinh(x) cosh(x) tanh(x)
    exp(x) exp2(x) expm1(x) log(x) log2(x) log10(x) log1p(x) pow(x, y) cbrt(x) hypot(x, y)
}

/// What a compiler makes of a sine and a cosine of one angle.
///
/// # Safety
/// Both places can be written to.
#[unsafe(no_mangle)]
unsafe extern "C" fn sincos(angle: f64, sine: *mut f64, cosine: *mut f64) {
    // SAFETY: as above.
    unsafe {
        *sine = libm::sin(angle);
        *cosine = libm::cos(angle);
    }
}

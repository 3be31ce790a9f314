//! What is compiled for a class.

use super::EngineError;
use crate::kernel::{MODES_MAX, Real, Rounding, Stepper, Tangent, tangent};
use crate::plan::Class;

/// What steps a class.
///
/// # Errors
/// No modes, or more than the kernel can step.
pub(super) fn stepper<E: Real>(rounding: Rounding, class: &Class) -> Result<Stepper<E>, EngineError> {
    E::stepper(rounding, class.law, class.modes).ok_or_else(|| none(class.modes))
}

/// What tells the slopes of a class's periods.
///
/// # Errors
/// As [`stepper`].
pub(super) fn slopes(rounding: Rounding, class: &Class) -> Result<Tangent<f64>, EngineError> {
    tangent(rounding, class.law, class.modes).ok_or_else(|| none(class.modes))
}

fn none(modes: usize) -> EngineError {
    match modes {
        0 => EngineError::NoModes,
        _ => EngineError::TooManyModes { modes, most: MODES_MAX },
    }
}

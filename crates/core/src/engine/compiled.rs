//! What is compiled for a class.

use super::EngineError;
use crate::kernel::{MODES_MAX, Real, Rounding, Stepper};
use crate::plan::Class;

/// What steps a class.
///
/// # Errors
/// No modes, or more than the kernel can step.
pub(super) fn stepper<E: Real>(rounding: Rounding, class: &Class) -> Result<Stepper<E>, EngineError> {
    let modes = class.modes;
    E::stepper(rounding, class.law, modes).ok_or(match modes {
        0 => EngineError::NoModes,
        _ => EngineError::TooManyModes { modes, most: MODES_MAX },
    })
}

//! The compiled kernel of a class.

use super::EngineError;
use crate::kernel::{MODES_MAX, Real, Rounding, Stepper, Tangent, strict_tangent, tangent};
use crate::plan::Class;

/// The stepper of a class.
///
/// # Errors
/// No modes, or more than the kernel can step.
pub(super) fn stepper<E: Real>(rounding: Rounding, class: &Class) -> Result<Stepper<E>, EngineError> {
    E::stepper(rounding, class.law, class.modes).ok_or_else(|| not_stepped(class.modes))
}

/// Numbers in which Jacobians of periods are computed.
pub(super) trait TangentReal: Real {
    /// Computes the Jacobians of a class's periods; in f32 every operation rounds, whatever `rounding` is.
    ///
    /// # Errors
    /// As [`stepper`].
    fn tangent(rounding: Rounding, class: &Class) -> Result<Tangent<Self>, EngineError>;
}

impl TangentReal for f32 {
    fn tangent(_: Rounding, class: &Class) -> Result<Tangent<Self>, EngineError> {
        strict_tangent(class.law, class.modes).ok_or_else(|| not_stepped(class.modes))
    }
}

impl TangentReal for f64 {
    fn tangent(rounding: Rounding, class: &Class) -> Result<Tangent<Self>, EngineError> {
        tangent(rounding, class.law, class.modes).ok_or_else(|| not_stepped(class.modes))
    }
}

pub(super) fn not_stepped(modes: usize) -> EngineError {
    match modes {
        0 => EngineError::NoModes,
        _ => EngineError::TooManyModes { modes, most: MODES_MAX },
    }
}

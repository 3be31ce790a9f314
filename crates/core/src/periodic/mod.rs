//! Periodic states: fixed points of the map that takes a state through one period of the drive.
//!
//! [`PtcNewton`] is Newton's method with a memory of time: at first it follows the flow that repeating the map would
//! take, in ever longer steps (pseudo-transient continuation; Kelley & Keyes, SIAM J. Numer. Anal. 35 (1998) 508),
//! so that of several states it tends to find the one that waiting would reach. It knows nothing of what the map
//! is: it says at which points it wants to know it, and is told. Many searches so run side by side.
//! [`Envelope`] follows a slow motion to where repeating the map would end, and is told likewise.

mod envelope;
mod floquet;
mod inverse;
mod newton_jacobian;
mod newton_options;
mod pseudo_transient;
mod size;

pub use envelope::{Envelope, EnvelopeEnd, EnvelopeOptions};
pub use floquet::Floquet;
pub use inverse::inverse;
pub use newton_options::NewtonOptions;
pub use pseudo_transient::{Failure, FixedPoint, PtcNewton, PtcOutcome};
pub use size::{Memory, Size};

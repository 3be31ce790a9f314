//! Periodic states: fixed points of the map that takes a state through one period of the drive.
//!
//! [`PtcNewton`] is Newton's method with pseudo-transient continuation (Kelley & Keyes, SIAM J. Numer. Anal. 35 (1998) 508):
//! it first follows the flow of the repeated map in ever longer steps. So, among several states, it tends to find the one that
//! integration would reach. It does not know the map: it asks for its values at points and is told them, so that many searches
//! run side by side. [`Envelope`] asks in the same way, and follows a slow motion to where repeating the map would end.

mod envelope;
mod floquet;
mod inverse;
mod line_search;
mod newton_jacobian;
mod newton_options;
mod pseudo_transient;
mod search_failure;
mod size;

pub use envelope::{Envelope, EnvelopeEnd, EnvelopeOptions};
pub use floquet::Floquet;
pub use inverse::inverse;
pub(crate) use line_search::{highest, root, root_within};
pub use newton_options::NewtonOptions;
pub use pseudo_transient::{FixedPoint, PtcNewton, PtcOutcome};
pub use search_failure::SearchFailure;
pub use size::{Memory, Size};

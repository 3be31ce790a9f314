//! Every tolerance of the dynamic tests, with its evidence. Errors are on the scales of the
//! accuracy asked for.

/// A mode with less than this share of the tip's static flexibility and of its free motion is left
/// out of the independent integration.
pub const UNSEEN: f64 = 1e-9;

/// Confirmed tapping points with 8192 steps a period: amplitude and forces relative, phase in
/// degrees, contact time, loss. Seen: 1e-9 in amplitude and 2e-7 in phase.
pub const PUBLISHED_FINE: [f64; 5] = [1e-6, 1e-4, 1e-5, 1e-5, 1e-4];
/// The same with the 128 steps that the plan takes for 1e-3. Seen: 8e-6, 8e-4, 1.5e-4, 4e-5, 2e-4.
pub const PUBLISHED_PLAN: [f64; 5] = [3e-5, 3e-3, 5e-4, 1e-4, 5e-4];

//! What a search is told.

/// How a search goes about.
#[derive(Clone, Copy, Debug)]
pub struct NewtonOptions {
    /// Length of a state that is not small: the free amplitude.
    pub scale: f64,
    /// Distance to the fixed point, in units of `scale`, that is aimed at, and that is near enough where the map
    /// is too rough for that.
    pub tolerance: f64,
    pub fallback_tolerance: f64,
    /// Step of the differences that make the Jacobian, in units of `scale`: far above the map's roughness.
    pub fd_step: f64,
    /// Step of the central differences that make the Jacobian at the end; without one the Jacobian on one side will do there,
    /// unless it leaves the state's stability in doubt.
    pub central_fd_step: Option<f64>,
    /// A multiplier by one-sided differences that is below this leaves no doubt of the state's stability.
    pub stable_below_fd: f64,
    /// The same of one that is known well, of a map that differs little.
    pub stable_below: f64,
    /// Where the map tells its Jacobian itself: how many columns by differences cost as much. Beyond so many no differences are
    /// taken.
    pub jacobian_columns: Option<usize>,
    /// Most evaluations of the map.
    pub max_evaluations: u32,
    /// Whether the start is thought to be next to the fixed point.
    pub start_is_close: bool,
    /// Whether the Jacobian that it begins with is that of a fixed point nearby: the first step goes by it.
    pub reuse_jacobian: bool,
    /// Whether only a stable fixed point is of use.
    pub require_stable: bool,
}

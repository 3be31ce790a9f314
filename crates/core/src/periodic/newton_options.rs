//! Options of a search.

/// Options of a Newton search.
#[derive(Clone, Copy, Debug)]
pub struct NewtonOptions {
    /// Typical length of a state: the free amplitude.
    pub scale: f64,
    /// Tolerance on the distance to the fixed point, in units of `scale`, and the tolerance that is enough where the map is
    /// too rough for that.
    pub tolerance: f64,
    pub fallback_tolerance: f64,
    /// Finite-difference step of the Jacobian, in units of `scale`: far above the map's roughness.
    pub fd_step: f64,
    /// Step of central differences for the last Jacobian. `None`: the one-sided Jacobian is enough there, unless it leaves
    /// stability in doubt.
    pub central_fd_step: Option<f64>,
    /// A state is stable without doubt if its multiplier by one-sided differences is below this.
    pub stable_below_fd: f64,
    /// The same for a multiplier known accurately, from a map that differs little.
    pub stable_below: f64,
    /// If the map computes its Jacobian: the number of finite-difference columns of equal cost. The search takes no more
    /// columns than that by differences.
    pub jacobian_columns: Option<usize>,
    /// Most evaluations of the map. A Jacobian by tangents counts as the differences that it replaces.
    pub max_evaluations: u32,
    /// Whether the start is expected to be close to the fixed point.
    pub start_is_close: bool,
    /// Whether the initial Jacobian is that of a fixed point nearby, so that the first step uses it.
    pub reuse_jacobian: bool,
    /// Whether only a stable fixed point counts.
    pub require_stable: bool,
}

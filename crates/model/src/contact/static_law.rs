//! What every contact law answers.

/// Points between the far end and the surface (0) of the indentations outside contact that a curve shows, as shares of the
/// way: 1 is the far end.
pub(super) type Shares<'a> = &'a [f64];

/// A law with its constants. Only a law with hysteresis looks at `in_contact`.
///
/// The first four are the law. Whoever needs to know more of a law (the plan, the engines, the curves) asks for it here,
/// and what holds for a law without adhesion is the answer where a law gives none of its own.
///
/// No input panics; a NaN comes back as NaN.
pub trait StaticLaw {
    /// Force on the tip, N, at indentation `delta` (m).
    fn force(&self, delta: f64, in_contact: bool) -> f64;
    /// Slope `df/d delta`, N/m; the contact's side of it at a kink. Minus infinity at JKR's fold.
    fn stiffness(&self, delta: f64, in_contact: bool) -> f64;
    /// Energy `U`, J, with `dU/d delta = f` and `U = 0` far apart.
    fn energy(&self, delta: f64, in_contact: bool) -> f64;
    /// Contact radius `a`, m; 0 out of contact.
    fn contact_radius(&self, delta: f64, in_contact: bool) -> f64;
    /// The kernel's constants in its units, in the order of its fields ([`crate::kernel::contact::Interaction::FIELDS`]).
    fn constants(&self, units: KernelUnits) -> Vec<f64>;

    /// Of these constants those of DMT's attraction.
    fn tail_constants(&self, _units: KernelUnits) -> Vec<f64> {
        Vec::new()
    }
    /// Of these constants those of the tabulated forces beside the contact.
    fn term_constants(&self, _units: KernelUnits) -> Vec<f64> {
        Vec::new()
    }
    /// Elastic part of the force (N) at a depth (m): what is left without adhesion.
    fn elastic_force(&self, depth: f64) -> f64 {
        self.force(depth, true)
    }
    /// Depth (m) at which the elastic part stops a tip that comes at `speed` (m/s), 1/`inverse_mass` (kg) heavy.
    ///
    /// This is for a law without adhesion: where `energy` is the kinetic one, found by halving.
    fn collision_depth(&self, speed: f64, inverse_mass: f64) -> f64 {
        first_depth(|depth| 2.0 * self.energy(depth, true) * inverse_mass >= speed * speed)
    }
    /// Depth (m) at which the elastic part carries a load (N), found by halving.
    fn depth_under(&self, load: f64) -> f64 {
        first_depth(|depth| self.elastic_force(depth) >= load)
    }
    /// Force on the tip, N, while the indentation changes by `rate` (m/s).
    fn force_moving(&self, delta: f64, _rate: f64, in_contact: bool) -> f64 {
        self.force(delta, in_contact)
    }
    /// How fast a sample that nothing touches forgets, as a rate of its exponential decay, 1/s: of a law with a memory.
    fn recovery(&self) -> f64 {
        0.0
    }
    /// Smallest and largest force (N) on a tip that went there.
    ///
    /// This is for a law whose force rises with the indentation, in contact and outside.
    fn forces(&self, passed: &Passed) -> (f64, f64) {
        (self.force(passed.highest, true), self.force(passed.deepest, true))
    }
    /// Indentation at which a contact ends on retraction, m (0 or below).
    fn release(&self) -> f64 {
        0.0
    }
    /// Indentation at which a contact begins on approach, m.
    fn formation(&self) -> f64 {
        0.0
    }
    /// Indentation at which the force passes through 0 on the contact branch, m.
    fn zero_force(&self) -> f64 {
        0.0
    }
    /// Most negative static force, N (0 or below).
    fn pull_off(&self) -> f64 {
        0.0
    }
    /// Whether the tip is in contact at `delta`, given whether it was just before.
    fn next_contact(&self, delta: f64, _was_in_contact: bool) -> bool {
        delta > 0.0
    }
    /// Largest slope, N/m, of an attraction that acts outside contact: a tip feels it that never touches.
    fn attraction_slope(&self) -> f64 {
        0.0
    }
    /// By how much adhesion takes a tip that touches deeper, m, to a factor of about two.
    fn depth_by_adhesion(&self) -> f64 {
        0.0
    }
    /// Rising indentations outside contact (m) at which a curve down to `deepest` shows the law, by shares that fall to 0.
    fn outside(&self, deepest: f64, shares: Shares) -> Vec<f64> {
        shares.iter().map(|share| -0.25 * deepest * share).collect()
    }
    /// How densely a curve's points lie at the end of the contact branch: evenly in this root of the distance from it.
    fn crowding(&self) -> i32 {
        2
    }
}

/// The least depth, m, from which on something holds.
pub(super) fn first_depth(holds: impl Fn(f64) -> bool) -> f64 {
    let (mut low, mut high): (f64, f64) = (1e-15, 1e-3);
    for _ in 0..60 {
        let middle = (low * high).sqrt();
        if holds(middle) { high = middle } else { low = middle }
    }
    high
}

/// The kernel's units for one instance; that of length is [`crate::kernel::LENGTH`].
///
/// So a force of `c delta^n` has the constant `c * LENGTH.powf(n) * impulse`, and one of `c delta^n` times the rate has
/// that times `LENGTH / step`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KernelUnits {
    /// Impulse of 1 N: the step's square times the tip's inverse mass over the unit of length.
    pub impulse: f64,
    /// Length of a step, s: the kernel's rates are per step.
    pub step: f64,
}

/// Where a tip went, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Passed {
    /// Largest and smallest indentation.
    pub deepest: f64,
    pub highest: f64,
    /// Smallest while in contact.
    pub held: f64,
    /// Whether it was ever in contact, and ever out of it.
    pub touched: bool,
    pub apart: bool,
    /// Whether a contact ended.
    pub let_go: bool,
    /// Least and largest force, N: what the engine has followed under a law that depends on the rate, else no numbers.
    pub forces: (f64, f64),
}

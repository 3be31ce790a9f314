//! Exact flow of the damped modes over one step, and what a kick does to each.

use super::Lane;

/// One mode as the plan gives it: angular frequency (rad/s), damping ratio 1/(2Q), and its share
/// of the tip's response to an impulse, c_k b_k / sum(c b).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlowMode {
    pub omega: f64,
    pub damping: f64,
    pub share: f64,
}

/// Coefficients of M modes for one step length. A mode's state is its part of the tip's travel, x,
/// and u = (dx/dt)/omega, both in kernel units of length.
#[derive(Clone, Copy, Debug)]
pub struct Flow<L, const M: usize> {
    /// Step matrix minus one: x += m00 x + m01 u, u += m10 x + m11 u. Increments, because a step
    /// matrix rounded to f32 drifts and its increments do not.
    pub m00: [L; M],
    pub m01: [L; M],
    pub m10: [L; M],
    pub m11: [L; M],
    /// Travel per step of a unit of u: omega h.
    pub rate: [L; M],
    /// Acceleration per step squared of a unit of x and of u.
    pub pull: [L; M],
    pub drag: [L; M],
    /// What the speed midway through a kick is too large by when it counts as work, by x and by u.
    pub work_x: [L; M],
    pub work_u: [L; M],
    /// Change of u and of x by a unit of impulse.
    pub kick_u: [L; M],
    pub kick_x: [L; M],
    /// Change of the tip's speed by a unit of impulse, all modes together (1 but for order h^2).
    pub kick_speed: L,
    /// The part by `work_u` that half a unit of impulse makes.
    pub kick_work: L,
}

impl<L: Lane, const M: usize> Flow<L, M> {
    /// Coefficients for a step of `step` seconds; `modes` has M entries.
    ///
    /// The kick's factor tan(y)/y (1 - y^2/6), y = omega h/2, is 1 + (omega h)^2/24 + ...: the
    /// term that the path average asks for, in the form that makes a mode's answer to a steady
    /// force exact however stiff it is. `kick_x` is the average's damping term (ARCHITECTURE.md).
    ///
    /// Work: with f the force at the sample, f'' its second derivative, g = omega/Q and v a mode's
    /// true speed, an impulse is f + h^2 f''/24 and the speed midway through it (Euler-Maclaurin)
    /// v + h^2 (g f/24 + f'/8 + g^2 v/24). Over a period f f' sums to nothing and f'' v to f v''
    /// with v'' = f' - g v' - omega^2 v, v' = f - g v - omega^2 x: what is left too much in the
    /// speed is h^2/24 (g omega^2 x + (2 g^2 - omega^2) v), in which f itself cancels. Without it the
    /// loss is of second order and shows a law without loss as one that feeds the lever.
    pub fn new(modes: &[FlowMode], step: f64) -> Self {
        let zero = [L::splat(0.0); M];
        let mut flow = Self {
            m00: zero,
            m01: zero,
            m10: zero,
            m11: zero,
            rate: zero,
            pull: zero,
            drag: zero,
            work_x: zero,
            work_u: zero,
            kick_u: zero,
            kick_x: zero,
            kick_speed: L::splat(0.0),
            kick_work: L::splat(0.0),
        };
        let (mut kick_speed, mut kick_work) = (0.0, 0.0);
        for (k, mode) in modes.iter().enumerate().take(M) {
            let [m00, m01, m10, m11] = increments(mode.omega * step, mode.damping);
            let angle = mode.omega * step;
            let half = 0.5 * angle;
            let factor = mode.share * half.tan() / half * (1.0 - angle * angle / 24.0);
            flow.m00[k] = L::splat(m00);
            flow.m01[k] = L::splat(m01);
            flow.m10[k] = L::splat(m10);
            flow.m11[k] = L::splat(m11);
            flow.rate[k] = L::splat(angle);
            flow.pull[k] = L::splat(-angle * angle);
            flow.drag[k] = L::splat(-2.0 * mode.damping * angle * angle);
            let loss = 2.0 * mode.damping * angle;
            let work_u = (2.0 * loss * loss - angle * angle) * angle / 24.0;
            flow.work_u[k] = L::splat(work_u);
            // g omega^2/24 in the limit of short steps; in this form a steady force does no work at
            // all. Its state is the one that a kick and a step lead back to: -m s = (1 + m) kick.
            let kick_x = mode.share * mode.damping * angle / 12.0;
            let kick_u = factor / angle;
            let (right_x, right_u) =
                (kick_x + m00 * kick_x + m01 * kick_u, kick_u + m10 * kick_x + m11 * kick_u);
            let scale = m01 * m10 - m00 * m11;
            let still_x = (m11 * right_x - m01 * right_u) / scale;
            let still_u = (m00 * right_u - m10 * right_x) / scale;
            flow.work_x[k] = L::splat((angle - work_u) * (still_u + 0.5 * kick_u) / still_x);
            kick_work += 0.5 * work_u * factor / angle;
            flow.kick_u[k] = L::splat(kick_u);
            flow.kick_x[k] = L::splat(kick_x);
            kick_speed += factor;
        }
        flow.kick_speed = L::splat(kick_speed);
        flow.kick_work = L::splat(kick_work);
        flow
    }
}

/// The step matrix minus one of a damped oscillator over the angle omega h, in (x, x'/omega).
///
/// Written with sin^2 and expm1 so that nothing cancels however short the step.
pub fn increments(angle: f64, damping: f64) -> [f64; 4] {
    let decay = -damping * angle;
    let shrink = decay.exp_m1();
    if damping < 1.0 {
        let root = (1.0 - damping * damping).sqrt();
        let turn = root * angle;
        let sine = turn.sin();
        let versine = 2.0 * (0.5 * turn).sin().powi(2);
        let scaled = (shrink + 1.0) * sine / root;
        // exp(decay) cos(turn) - 1
        let cosine = shrink - (shrink + 1.0) * versine;
        [cosine + damping * scaled, scaled, -scaled, cosine - damping * scaled]
    } else {
        // Aperiodic (Q <= 1/2): the same with hyperbolic functions; sinh(y)/y at y = 0 is 1.
        let root = (damping * damping - 1.0).sqrt();
        let turn = root * angle;
        let scaled = (shrink + 1.0) * if turn < 1e-8 { angle } else { turn.sinh() / root };
        let cosine = shrink + (shrink + 1.0) * 2.0 * (0.5 * turn).sinh().powi(2);
        [cosine + damping * scaled, scaled, -scaled, cosine - damping * scaled]
    }
}

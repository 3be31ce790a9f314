//! Rigid tips of several shapes: their forces again, in forms of their own.

use crate::contact::Contact;
use crate::kernel::contact::POWERS;
use crate::scene::TipShape;
use std::f64::consts::PI;

/// A rigid tip on a half-space of plane-strain modulus `modulus` = E*, Pa: Sneddon (1965).
#[derive(Clone, Copy, Debug)]
pub(super) enum Indenter {
    /// f = factor delta^power
    Power { factor: f64, power: i32 },
    /// In the contact radius: delta = a atanh(a/R), f = E* ((a^2 + R^2) atanh(a/R) - a R).
    Sphere { modulus: f64, radius: f64 },
    /// In s = a/A: delta = (A^2/R) s atan(s), f = E* (A^3/R) (s + (s^2 - 1) atan(s)), with A = R/tan(alpha).
    Hyperboloid { modulus: f64, radius: f64, axis: f64 },
    /// A cone with a spherical cap of radius R, in the contact radius: Briscoe and others (1994).
    Capped { modulus: f64, radius: f64, tangent: f64, cap: f64 },
    /// f = sum c_n delta^(n/2), n from 2 on: a tip on a layer, of which this series is the model.
    Series { coefficients: [f64; POWERS] },
}

impl Indenter {
    pub fn new(contact: &Contact) -> Self {
        let modulus = 0.75 * contact.modulus;
        let tangent = contact.half_angle.to_radians().tan();
        let series = contact.layer.is_some() || contact.shape == TipShape::Paraboloid;
        if let (Some(law), true) = (contact.shaped(), series) {
            return Self::Series { coefficients: *law.coefficients() };
        }
        match contact.shape {
            TipShape::Hyperboloid => {
                Self::Hyperboloid { modulus, radius: contact.radius, axis: contact.radius / tangent }
            }
            TipShape::SpheroCone => Self::Capped {
                modulus,
                radius: contact.radius,
                tangent,
                cap: contact.radius * contact.half_angle.to_radians().cos(),
            },
            TipShape::Paraboloid | TipShape::Sphere => Self::Sphere { modulus, radius: contact.radius },
            TipShape::Cone => Self::Power { factor: 2.0 / PI * modulus * tangent, power: 2 },
            TipShape::Pyramid => Self::Power { factor: 0.7453 * modulus * tangent, power: 2 },
            TipShape::Punch => Self::Power { factor: 2.0 * modulus * contact.radius, power: 1 },
        }
    }

    /// Its force at an indentation on the branch that `touching` selects.
    pub fn pressed(self, delta: f64, touching: bool) -> f64 {
        if touching && delta > 0.0 { self.force(delta) } else { 0.0 * delta }
    }

    fn force(self, delta: f64) -> f64 {
        match self {
            Self::Power { factor, power } => factor * delta.powi(power),
            Self::Hyperboloid { modulus, radius, axis } => hyperboloid(modulus, radius, axis, delta),
            Self::Capped { modulus, radius, tangent, cap } => capped(modulus, radius, (tangent, cap), delta),
            Self::Series { coefficients } => {
                let root = delta.sqrt();
                delta * coefficients.iter().rev().fold(0.0, |sum, factor| sum * root + factor)
            }
            Self::Sphere { modulus, radius } => sphere(modulus, radius, delta),
        }
    }
}

fn hyperboloid(modulus: f64, radius: f64, axis: f64, delta: f64) -> f64 {
    let depth = delta * radius / (axis * axis);
    // s atan(s) rises and bends upwards at first: Newton's method, kept above zero.
    let mut s = depth.sqrt().max(2.0 / PI * depth);
    for _ in 0..60 {
        let angle = s.atan();
        let step = (s * angle - depth) / (angle + s / (1.0 + s * s));
        s = (s - step).max(0.1 * s);
        if step.abs() <= 2.0 * f64::EPSILON * s {
            break;
        }
    }
    let square = s * s;
    let series = 4.0 / 3.0 - square * (8.0 / 15.0 - square * (12.0 / 35.0 - square * (16.0 / 63.0)));
    let sum = if s < 0.03 { series * square * s } else { s + (square - 1.0) * s.atan() };
    modulus * axis.powi(3) / radius * sum
}

fn capped(modulus: f64, radius: f64, (tangent, cap): (f64, f64), delta: f64) -> f64 {
    let hertz = (radius * delta).sqrt();
    if hertz <= cap {
        return 4.0 / 3.0 * modulus * hertz * delta;
    }
    // The profile of springs side by side and its slope, which rises: Newton's method from the left.
    let profile = |a: f64| {
        let (s, turn) = (((a - cap) * (a + cap)).sqrt(), (cap / a).acos());
        (
            a * (a - s) / radius + a * turn / tangent,
            (2.0 * a - s - a * a / s) / radius + (turn + cap / s) / tangent,
        )
    };
    let (mut low, mut high) = (cap, hertz.max(delta * tangent) + cap);
    let mut a = 0.5 * (low + high);
    for _ in 0..80 {
        let (depth, slope) = profile(a);
        if depth < delta {
            low = a
        } else {
            high = a
        }
        let next = a - (depth - delta) / slope;
        let next = if next > low && next < high { next } else { 0.5 * (low + high) };
        let moved = (next - a).abs();
        a = next;
        if moved <= 2.0 * f64::EPSILON * a {
            break;
        }
    }
    let (s, turn) = (((a - cap) * (a + cap)).sqrt(), (cap / a).acos());
    let under = a * a * turn / (2.0 * tangent) + a * a * a / (3.0 * radius)
        - s * (cap / (2.0 * tangent) + s * s / (3.0 * radius));
    2.0 * modulus * (a * delta - under)
}

fn sphere(modulus: f64, radius: f64, delta: f64) -> f64 {
    let depth = delta / radius;
    // By t = atanh(a/R): t tanh(t) = depth, which rises and bends upwards: Newton's method comes from above.
    let mut t = depth.sqrt() * (1.0 + depth.sqrt());
    for _ in 0..60 {
        let tanh = t.tanh();
        let step = (t * tanh - depth) / (tanh + t * (1.0 - tanh * tanh));
        t -= step;
        if step.abs() <= 2.0 * f64::EPSILON * t {
            break;
        }
    }
    // (1 + tanh^2) t - tanh; by its series where it would be a difference of almost equal numbers.
    let (tanh, square) = (t.tanh(), t * t);
    let series = 4.0 / 3.0 - square * (0.8 - square * (136.0 / 315.0 - square * (124.0 / 567.0)));
    let sum = if t < 0.03 { series * square * t } else { t - tanh + tanh * tanh * t };
    modulus * radius * radius * sum
}

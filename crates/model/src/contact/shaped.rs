//! A tip that is no paraboloid on an elastic half-space, or one on a layer: the force as a sum of half-integer powers.

use super::layer::{LayerSeries, LayerTip};
use super::{Compact, KernelUnits, StaticLaw};
use crate::kernel::LENGTH;
use crate::kernel::contact::POWERS;
use crate::scene::TipShape;
use std::f64::consts::PI;

/// By how much a sphere's force falls short of a paraboloid's: factors of `(delta/R)^k`, k = 0 to 4.
///
/// The first two are those of the series of Sneddon's solution. The others are fitted: up to `delta = R` the force is right
/// to 3e-8.
const SPHERE: [f64; 5] = [1.0, -0.1, -0.00118909154558, 0.000716456918101, 0.000231638139019];

/// The largest `delta/R` for which a sphere's series is fitted: half of it has sunk in.
pub const SPHERE_REACH: f64 = 1.0;

/// By how much a hyperboloid's force exceeds its apex's: factors of `x^(k/2)`, `x = delta tan(alpha)^2/R`, k = 0 to 8.
///
/// Fitted to Sneddon's solution up to `x = HYPERBOLOID_REACH`; there the force is right to 2e-6.
const HYPERBOLOID: [f64; 9] = [
    1.0,
    -6.434267483e-5,
    0.1007977485,
    -0.003326879383,
    0.005302708256,
    -0.006540003984,
    0.002488091305,
    -0.0004240895941,
    2.802311072e-5,
];
/// The largest `delta tan(alpha)^2/R` for which a hyperboloid's series is fitted.
pub const HYPERBOLOID_REACH: f64 = 10.0;

/// Force over `E* tan(alpha) delta^2` of a four-sided pyramid, `alpha` from its axis to a face: Bilodeau (1992).
const PYRAMID: f64 = 0.7453;

/// `f = sum c_n delta^(n/2)`, n = 2 to 11, in contact, 0 outside; with `E* = 3 K/4` and a half-angle `alpha` to the axis
///
/// | shape | force |
/// |---|---|
/// | sphere | `K sqrt(R) delta^1.5 (1 - x/10 - ...)`, `x = delta/R` |
/// | cone | `(2/pi) E* tan(alpha) delta^2` |
/// | four-sided pyramid | `0.7453 E* tan(alpha) delta^2` |
/// | flat punch of radius R | `2 E* R delta` |
/// | cone with a spherical cap | none: a table, see [`super::SpheroCone`] |
/// | hyperboloid of apex radius R | `K sqrt(R) delta^1.5 (1 + x/10 + ...)`, `x = delta tan(alpha)^2/R` |
/// | paraboloid or cone on a layer | that on a half-space times a series |
///
/// I. N. Sneddon, Int. J. Eng. Sci. 3, 47 (1965); the pyramid G. G. Bilodeau, J. Appl. Mech. 59, 519 (1992). The contact radius
/// is that of the punch with the same stiffness, `(df/d delta)/(2 E*)`, which is exact for every tip with an axis on a
/// half-space; on a layer it has a series of its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShapedHertz {
    /// `c_n`, N/m^(n/2).
    coefficients: [f64; POWERS],
    /// Likewise of the contact radius, from `delta^0` on, m^(1 - n/2).
    radius: [f64; POWERS],
}

impl From<&Compact> for ShapedHertz {
    fn from(of: &Compact) -> Self {
        let mut coefficients = [0.0; POWERS];
        let (radius, modulus) = (of.radius, 1.5 * of.modulus);
        match of.shape {
            TipShape::Paraboloid => coefficients[1] = of.modulus * radius.sqrt(),
            TipShape::Sphere => {
                for (k, factor) in SPHERE.into_iter().enumerate() {
                    coefficients[1 + 2 * k] = factor * of.modulus * radius.sqrt() / radius.powi(k as i32);
                }
            }
            TipShape::Cone => coefficients[2] = modulus / PI * of.half_angle.to_radians().tan(),
            TipShape::Pyramid => coefficients[2] = 0.5 * PYRAMID * modulus * of.half_angle.to_radians().tan(),
            TipShape::Punch => coefficients[0] = modulus * radius,
            // Its force is a table beside the contact.
            TipShape::SpheroCone => {}
            TipShape::Hyperboloid => {
                let steep = of.half_angle.to_radians().tan() / radius.sqrt();
                for (k, factor) in HYPERBOLOID.into_iter().enumerate() {
                    coefficients[1 + k] = factor * of.modulus * radius.sqrt() * steep.powi(k as i32);
                }
            }
        }
        let mut law = Self { coefficients, radius: [0.0; POWERS] };
        for (n, coefficient) in coefficients.into_iter().enumerate() {
            law.radius[n] = coefficient * (n as f64 + 2.0) / (2.0 * modulus);
        }
        if let Some(layer) = &of.layer {
            let (tip, first, steep) = match of.shape {
                TipShape::Cone => (LayerTip::Cone, 2, of.half_angle.to_radians().tan() / layer.thickness),
                _ => (LayerTip::Paraboloid, 1, radius / layer.thickness.powi(2)),
            };
            let series = LayerSeries::of(layer, tip);
            let (force, wide) = (coefficients[first], tip.radius(radius, of.half_angle));
            law.radius = [0.0; POWERS];
            law.radius[first] = wide;
            for k in 1..POWERS - first {
                let scale = steep.sqrt().powi(k as i32);
                law.coefficients[first + k] = force * scale * series.force[k - 1];
                law.radius[first + k] = wide * scale * series.radius[k - 1];
            }
        }
        law
    }
}

impl ShapedHertz {
    /// Factors of `delta^(n/2)`, n = 2 to 11, N/m^(n/2).
    pub fn coefficients(&self) -> &[f64; POWERS] {
        &self.coefficients
    }

    /// The sum with each term times `weight(n/2)`.
    fn sum(&self, delta: f64, weight: impl Fn(f64) -> f64) -> f64 {
        let powers = (2..).map(|n| f64::from(n) / 2.0);
        let terms = self.coefficients.iter().zip(powers).filter(|(coefficient, _)| **coefficient != 0.0);
        terms.map(|(coefficient, power)| coefficient * weight(power) * delta.powf(power)).sum()
    }
}

impl StaticLaw for ShapedHertz {
    fn force(&self, delta: f64, _in_contact: bool) -> f64 {
        if delta <= 0.0 { 0.0 } else { self.sum(delta, |_| 1.0) }
    }

    fn stiffness(&self, delta: f64, _in_contact: bool) -> f64 {
        if delta <= 0.0 { 0.0 } else { self.sum(delta, |power| power) / delta }
    }

    fn energy(&self, delta: f64, _in_contact: bool) -> f64 {
        if delta <= 0.0 { 0.0 } else { self.sum(delta, |power| 1.0 / (power + 1.0)) * delta }
    }

    fn contact_radius(&self, delta: f64, _in_contact: bool) -> f64 {
        let root = if delta > 0.0 { delta.sqrt() } else { return 0.0 };
        self.radius.iter().rev().fold(0.0, |sum, factor| sum * root + factor)
    }

    fn constants(&self, units: KernelUnits) -> Vec<f64> {
        let powers = (2..).map(|n| f64::from(n) / 2.0);
        let scaled = self.coefficients.iter().zip(powers);
        scaled.map(|(coefficient, power)| coefficient * LENGTH.powf(power) * units.impulse).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::Contact;
    use crate::scene::{LawChoice, Params};

    fn contact(shape: TipShape) -> Contact {
        let mut params = Params::default();
        params.contact.law = LawChoice::Hertz;
        (params.instrument.tip.shape, params.instrument.tip.half_angle) = (shape, Some(20.0));
        Contact::new(&params)
    }

    /// Truth: Sneddon's solution in the contact radius a, delta = a atanh(a/R), f = E* ((a^2 + R^2) atanh(a/R) - a R).
    #[test]
    fn exact_sphere() {
        let law = contact(TipShape::Sphere);
        let (modulus, radius) = (0.75 * law.modulus, law.radius);
        let force_at = |a: f64| modulus * ((a * a + radius * radius) * (a / radius).atanh() - a * radius);
        for step in 1..=75 {
            let a = 0.01 * f64::from(step) * radius;
            let (delta, force) = (a * (a / radius).atanh(), force_at(a));
            assert!((law.force(delta, true) / force - 1.0).abs() < 3e-8, "{step}");
            assert!((law.contact_radius(delta, true) / a - 1.0).abs() < 1e-6, "{step}");
            // Simpson's rule in a, in which all is smooth.
            let rate = |a: f64| (a / radius).atanh() + a * radius / (radius * radius - a * a);
            let power = |share: f64| force_at(share * a) * rate(share * a) * a;
            let pieces = 200;
            let area: f64 = (0..pieces)
                .map(|n| {
                    let at = |part: f64| power((f64::from(n) + part) / f64::from(pieces));
                    (at(0.0) + 4.0 * at(0.5) + at(1.0)) / (6.0 * f64::from(pieces))
                })
                .sum();
            assert!((law.energy(delta, true) / area - 1.0).abs() < 1e-7, "{step}: {area:e}");
        }
    }

    /// Truth: Sneddon in s = a/A, A = R/tan(alpha): delta = (A^2/R) s atan(s), f = E* (A^3/R) (s + (s^2 - 1) atan(s)).
    #[test]
    fn exact_hyperboloid() {
        let law = contact(TipShape::Hyperboloid);
        let (modulus, radius) = (0.75 * law.modulus, law.radius);
        let axis = radius / 20f64.to_radians().tan();
        for step in 1..=69 {
            let s = 0.1 * f64::from(step);
            let (delta, a) = (axis * axis / radius * s * s.atan(), s * axis);
            let force = modulus * axis.powi(3) / radius * (s + (s * s - 1.0) * s.atan());
            assert!(
                (law.force(delta, true) / force - 1.0).abs() < 3e-6,
                "{s}: {}",
                law.force(delta, true) / force
            );
            assert!((law.contact_radius(delta, true) / a - 1.0).abs() < 1e-4, "{s}");
        }
    }

    /// Truth: the closed forms of force, stiffness and energy.
    #[test]
    fn exact_cone_pyramid_and_punch() {
        let (modulus, radius) =
            (0.75 * contact(TipShape::Cone).modulus, Params::default().instrument.tip.radius);
        let tangent = 20f64.to_radians().tan();
        let cases = [
            (TipShape::Cone, 2.0 / PI * modulus * tangent, 2.0),
            (TipShape::Pyramid, 0.7453 * modulus * tangent, 2.0),
            (TipShape::Punch, 2.0 * modulus * radius, 1.0),
        ];
        for (shape, factor, power) in cases {
            let law = contact(shape);
            for delta in [1e-12f64, 1e-9, 3e-8] {
                let force = factor * delta.powf(power);
                assert!((law.force(delta, true) / force - 1.0).abs() < 1e-14, "{shape:?}");
                assert!((law.stiffness(delta, true) * delta / (power * force) - 1.0).abs() < 1e-14);
                assert!((law.energy(delta, true) * (power + 1.0) / (force * delta) - 1.0).abs() < 1e-14);
            }
            assert_eq!(law.force(-1e-9, false), 0.0);
        }
        assert!((contact(TipShape::Punch).contact_radius(1e-9, true) / radius - 1.0).abs() < 1e-15);
        let a = 2.0 / PI * tangent * 1e-9;
        assert!((contact(TipShape::Cone).contact_radius(1e-9, true) / a - 1.0).abs() < 1e-14);
    }
}

//! A thin layer on a rigid ground: by how much stiffer it is than a half-space, solved once for a few Poisson ratios.

use crate::legendre::gauss;
use crate::matrix_product::product;
use nalgebra::{DMatrix, DVector};
use std::f64::consts::{FRAC_2_PI, FRAC_PI_2, PI};
use std::sync::OnceLock;

/// Largest contact radius, in thicknesses, for which the series of a layer are fitted.
pub const LAYER_REACH: f64 = 2.0;
/// Terms of each series beside the leading 1 that a half-space has; a cone's last one is 0.
pub(super) const TERMS: usize = 8;
/// Nodes over the contact, over the waves of the kernel, and contact radii that are fitted.
const NODES: (usize, usize, usize) = (24, 60, 24);
/// Where the kernel's integral over the waves ends: it falls as exp(-2u).
const WAVES_END: f64 = 24.0;
/// Poisson ratios that are solved: a design may vary the ratio from row to row.
const RATIOS: usize = 48;

/// The layer of a case.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layer {
    /// m
    pub thickness: f64,
    /// Poisson's ratio of the sample; it does not matter to a layer that slides.
    pub poisson_ratio: f64,
    /// Whether it is bonded to the ground; else it slides on it without friction.
    pub bonded: bool,
}

/// A tip that presses on the layer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum LayerTip {
    Paraboloid,
    Cone,
}

impl LayerTip {
    /// The contact radius over the indentation's root (m^0.5) under a paraboloid, over the indentation itself under a cone;
    /// of a half-space.
    pub fn radius(self, radius: f64, half_angle: f64) -> f64 {
        match self {
            Self::Paraboloid => radius.sqrt(),
            Self::Cone => FRAC_2_PI * half_angle.to_radians().tan(),
        }
    }
}

/// Force and contact radius over those on a half-space at the same indentation: `1 + sum c_k y^k`, k from 1.
///
/// For a paraboloid `y = sqrt(R delta)/h`, for a cone `y = sqrt(delta tan(alpha)/h)`. Up to a contact radius of
/// [`LAYER_REACH`] thicknesses h the force is right to 6e-5 under a paraboloid and to 9e-4 under a cone.
#[derive(Clone, Copy, Debug)]
pub(super) struct LayerSeries {
    pub force: [f64; TERMS],
    pub radius: [f64; TERMS],
}

/// By tip, the series of a layer that slides, and those of a bonded one at the Poisson ratios of [`ratio_node`].
static SLIDING: [OnceLock<LayerSeries>; 2] = [const { OnceLock::new() }; 2];
static BONDED: [OnceLock<Vec<LayerSeries>>; 2] = [const { OnceLock::new() }; 2];

/// Where Chebyshev's points of the second kind lie between the least and the largest Poisson ratio there can be, -1 and 0.5.
fn ratio_node(n: usize) -> f64 {
    -0.25 - 0.75 * (PI * n as f64 / (RATIOS - 1) as f64).cos()
}

impl LayerSeries {
    pub fn of(layer: &Layer, tip: LayerTip) -> Self {
        if !layer.bonded {
            return *SLIDING[tip as usize].get_or_init(|| Self::solve(0.0, false, tip));
        }
        let solved = || (0..RATIOS).map(|n| Self::solve(ratio_node(n), true, tip)).collect();
        Self::interpolated(BONDED[tip as usize].get_or_init(solved), layer.poisson_ratio)
    }

    /// At this Poisson ratio, by the barycentric formula.
    fn interpolated(nodes: &[Self], ratio: f64) -> Self {
        let (mut sum, mut whole) = (Self { force: [0.0; TERMS], radius: [0.0; TERMS] }, 0.0);
        for (n, node) in nodes.iter().enumerate() {
            let off = ratio - ratio_node(n);
            if off == 0.0 {
                return *node;
            }
            let end = if n == 0 || n + 1 == nodes.len() { 0.5 } else { 1.0 };
            let weight = if n % 2 == 0 { end / off } else { -end / off };
            whole += weight;
            for k in 0..TERMS {
                sum.force[k] += weight * node.force[k];
                sum.radius[k] += weight * node.radius[k];
            }
        }
        Self { force: sum.force.map(|c| c / whole), radius: sum.radius.map(|c| c / whole) }
    }

    fn solve(poisson_ratio: f64, bonded: bool, tip: LayerTip) -> Self {
        let waves = waves(poisson_ratio, bonded);
        let radii = (0..NODES.2).map(|n| {
            let angle = PI * (n as f64 + 0.5) / NODES.2 as f64;
            0.5 * LAYER_REACH * (1.0 - angle.cos())
        });
        let points: Vec<[f64; 3]> = radii.map(|radius| pressed(radius, tip, &waves)).collect();
        let count = if tip == LayerTip::Cone { TERMS - 1 } else { TERMS };
        Self { force: fitted(&points, 1, count), radius: fitted(&points, 2, count) }
    }
}

/// Waves `u` of the kernel with their weights `(1 - L(u)) du`.
fn waves(poisson_ratio: f64, bonded: bool) -> Vec<(f64, f64)> {
    let kappa = 3.0 - 4.0 * poisson_ratio;
    let lacking = |u: f64| {
        let (fall, twice) = ((-2.0 * u).exp(), 4.0 * u * (-2.0 * u).exp());
        let (part, whole) = match bonded {
            true => (
                kappa * (1.0 - fall * fall) - twice,
                kappa * (1.0 + fall * fall) + (1.0 + kappa * kappa + 4.0 * u * u) * fall,
            ),
            false => ((1.0 - fall).powi(2), 1.0 - fall * fall + twice),
        };
        1.0 - part / whole
    };
    let wave = |(place, weight): (f64, f64)| {
        let u = 0.5 * WAVES_END * (place + 1.0);
        (u, 0.5 * WAVES_END * weight * lacking(u))
    };
    gauss(NODES.1).into_iter().map(wave).collect()
}

/// `y`, and the force and the contact radius over those on a half-space, at this contact radius in thicknesses.
///
/// Lebedev and Ufliand (1958): `phi(t) - (2/pi) int_0^a K(t, s) phi(s) ds = delta - g(t)` with
/// `K = int_0^inf (1 - L(u)) cos(ut) cos(us) du`, `phi(a) = 0` and `f = 2 E* int phi dt`; g is the profile of springs side by
/// side, `t^2/R` for a paraboloid and `pi t/(2 tan(alpha))` for a cone.
fn pressed(radius: f64, tip: LayerTip, waves: &[(f64, f64)]) -> [f64; 3] {
    let profile = |t: f64| match tip {
        LayerTip::Paraboloid => t * t,
        LayerTip::Cone => FRAC_PI_2 * t,
    };
    let nodes: Vec<(f64, f64)> =
        gauss(NODES.0).into_iter().map(|(x, w)| (0.5 * radius * (x + 1.0), 0.5 * radius * w)).collect();
    let count = nodes.len();
    // Its last row is the edge of the contact.
    let places = |i: usize| if i < count { nodes[i].0 } else { radius };
    let cosines = DMatrix::from_fn(count + 1, waves.len(), |i, j| (waves[j].0 * places(i)).cos());
    let weighted = DMatrix::from_fn(waves.len(), count, |j, i| waves[j].1 * cosines[(i, j)]);
    let mut kernel = product(&cosines, &weighted);
    (0..count).for_each(|i| kernel.column_mut(i).scale_mut(FRAC_2_PI * nodes[i].1));
    let system = DMatrix::identity(count, count) - kernel.rows(0, count);
    let sides = DMatrix::from_fn(count, 2, |i, k| if k == 0 { 1.0 } else { profile(nodes[i].0) });
    let Some(solved) = system.lu().solve(&sides) else { return [f64::NAN; 3] };
    // Of a unit indentation and of the profile; the edge says how much of the first there is.
    let edge = kernel.row(count) * &solved;
    let delta = (profile(radius) + edge[1]) / (1.0 + edge[0]);
    let force: f64 = (0..count).map(|i| 2.0 * nodes[i].1 * (delta * solved[(i, 0)] - solved[(i, 1)])).sum();
    match tip {
        LayerTip::Paraboloid => {
            let root = delta.sqrt();
            [root, force / (4.0 / 3.0 * delta * root), radius / root]
        }
        LayerTip::Cone => [delta.sqrt(), force / (FRAC_2_PI * delta * delta), radius / (FRAC_2_PI * delta)],
    }
}

/// The series of one column of the points over their first, by least squares of what it is off by relatively.
fn fitted(points: &[[f64; 3]], column: usize, count: usize) -> [f64; TERMS] {
    let most = points.iter().map(|point| point[0]).fold(0.0, f64::max);
    let power = |k: usize| k as i32 + 1;
    let terms = DMatrix::from_fn(points.len(), count, |i, k| {
        (points[i][0] / most).powi(power(k)) / points[i][column]
    });
    let wanted = DVector::from_fn(points.len(), |i, _| 1.0 - 1.0 / points[i][column]);
    match terms.svd(true, true).solve(&wanted, 1e-14) {
        Ok(found) => std::array::from_fn(|k| found.get(k).map_or(0.0, |c| c / most.powi(power(k)))),
        Err(_) => [f64::NAN; TERMS],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::Contact;
    use crate::scene::{LawChoice, Params, TipShape};

    type Row = (f64, bool, f64, f64, f64);

    /// Poisson ratio, bonded or not, contact radius and indentation of a layer of 1 with R = 1 or tan(alpha) = 1, and the force
    /// over that on a half-space, by `tests/python/layer_contact.py`.
    const PARABOLOID: [Row; 16] = [
        (0.5, true, 0.1, 0.009257746, 1.123544397),
        (0.5, true, 0.4, 0.118593253, 1.635485437),
        (0.5, true, 1.0, 0.559415486, 3.371098310),
        (0.5, true, 2.0, 1.819611286, 8.468011023),
        (0.3, true, 0.1, 0.009421665, 1.094049068),
        (0.3, true, 0.4, 0.127270693, 1.449975738),
        (0.3, true, 1.0, 0.647622320, 2.415639573),
        (0.3, true, 2.0, 2.292013423, 4.331920193),
        (0.0, true, 0.1, 0.009490547, 1.082017350),
        (0.0, true, 0.4, 0.130718024, 1.383543471),
        (0.0, true, 1.0, 0.673387524, 2.171545209),
        (0.0, true, 2.0, 2.368636854, 3.718265820),
        (0.3, false, 0.1, 0.009508296, 1.078922461),
        (0.3, false, 0.4, 0.131402920, 1.368733932),
        (0.3, false, 1.0, 0.673980645, 2.139099105),
        (0.3, false, 2.0, 2.360922170, 3.688146751),
    ];
    const CONE: [Row; 16] = [
        (0.5, true, 0.1, 0.148332081, 1.122323643),
        (0.5, true, 0.4, 0.505864711, 1.611280391),
        (0.5, true, 1.0, 1.047811780, 3.238866259),
        (0.5, true, 2.0, 1.851341201, 8.080908737),
        (0.3, true, 0.1, 0.150264268, 1.093344133),
        (0.3, true, 0.4, 0.531592514, 1.437718769),
        (0.3, true, 1.0, 1.153873327, 2.365876781),
        (0.3, true, 2.0, 2.143479451, 4.255151724),
        (0.0, true, 0.1, 0.151076261, 1.081480121),
        (0.0, true, 0.4, 0.541820371, 1.374367704),
        (0.0, true, 1.0, 1.184405756, 2.132464131),
        (0.0, true, 2.0, 2.186639876, 3.652358912),
        (0.3, false, 0.1, 0.151285599, 1.078422586),
        (0.3, false, 0.4, 0.543862754, 1.359971411),
        (0.3, false, 1.0, 1.184766178, 2.098824847),
        (0.3, false, 2.0, 2.180753720, 3.620173714),
    ];

    fn contact(row: Row, shape: TipShape, unit: f64) -> Contact {
        let mut params = Params::default();
        params.contact.law = LawChoice::Hertz;
        (params.instrument.tip.shape, params.instrument.tip.radius) = (shape, unit);
        params.instrument.tip.half_angle = Some(45.0);
        (params.sample.poisson_ratio, params.sample.bonded) = (row.0, row.1);
        params.sample.thickness = Some(unit);
        Contact::new(&params)
    }

    /// Truth: an independent program that solves the same integral equation without a series.
    #[test]
    fn forces_and_radii_are_those_of_the_integral_equation() {
        for (shape, rows, bounds) in
            [(TipShape::Paraboloid, PARABOLOID, [6e-5, 1e-4]), (TipShape::Cone, CONE, [9e-4, 2e-3])]
        {
            for row in rows {
                let (_, _, radius, depth, over) = row;
                let unit = 1e-7;
                let law = contact(row, shape, unit);
                let thick = match shape {
                    TipShape::Cone => FRAC_2_PI * 0.75 * law.modulus * (unit * depth).powi(2),
                    _ => law.modulus * unit.sqrt() * (unit * depth).powf(1.5),
                };
                let force = law.force(unit * depth, true) / (thick * over) - 1.0;
                let wide = law.contact_radius(unit * depth, true) / (unit * radius) - 1.0;
                assert!(force.abs() < bounds[0] && wide.abs() < bounds[1], "{row:?}: {force:e}, {wide:e}");
            }
        }
    }

    /// Truth: Gauss's quadrature over the indentation's root, in which forces and stiffnesses are polynomials.
    #[test]
    fn energy_is_the_forces_integral_and_force_the_stiffnesss() {
        let nodes = gauss(8);
        for (shape, rows) in [(TipShape::Paraboloid, PARABOLOID), (TipShape::Cone, CONE)] {
            for row in [rows[2], rows[6], rows[14]] {
                let law = contact(row, shape, 1e-7);
                for delta in [1e-9, 2e-8, 1e-7 * row.3] {
                    let root = 0.5 * f64::sqrt(delta);
                    let integral = |value: &dyn Fn(f64) -> f64| {
                        let part = |(x, weight): &(f64, f64)| {
                            let s = root * (x + 1.0);
                            root * weight * 2.0 * s * value(s * s)
                        };
                        nodes.iter().map(part).sum::<f64>()
                    };
                    let energy = integral(&|d| law.force(d, true)) / law.energy(delta, true) - 1.0;
                    let force = integral(&|d| law.stiffness(d, true)) / law.force(delta, true) - 1.0;
                    assert!(energy.abs() < 1e-12 && force.abs() < 1e-12, "{row:?}: {energy:e}, {force:e}");
                }
            }
        }
    }

    /// Truth: the problem solved at that Poisson ratio itself.
    #[test]
    fn poisson_ratios_between_those_solved_are_interpolated() {
        for tip in [LayerTip::Paraboloid, LayerTip::Cone] {
            for poisson_ratio in [-0.99, -0.5, -0.123, 0.05, 0.27, 0.38, 0.45, 0.485, 0.499] {
                let ours = LayerSeries::of(&Layer { thickness: 1.0, poisson_ratio, bonded: true }, tip);
                let exact = LayerSeries::solve(poisson_ratio, true, tip);
                for step in 1..=13 {
                    let y = 0.1 * f64::from(step);
                    let sum = |c: &[f64; TERMS]| c.iter().rev().fold(0.0, |sum, c| (sum + c) * y) + 1.0;
                    for (ours, exact) in [(&ours.force, &exact.force), (&ours.radius, &exact.radius)] {
                        let off = sum(ours) / sum(exact) - 1.0;
                        assert!(off.abs() < 1e-5, "{tip:?} {poisson_ratio} {y}: {off:e}");
                    }
                }
            }
        }
    }

    /// Truth: a layer much thicker than the contact is a half-space; and the force rises however deep the tip sinks in.
    #[test]
    fn a_thick_layer_is_a_half_space_and_a_thin_one_never_softens() {
        for (shape, row) in [(TipShape::Paraboloid, PARABOLOID[4]), (TipShape::Cone, CONE[4])] {
            let (mut params, thin) = (Params::default(), contact(row, shape, 1e-7));
            params.contact.law = LawChoice::Hertz;
            (params.instrument.tip.shape, params.instrument.tip.half_angle) = (shape, Some(45.0));
            params.sample.poisson_ratio = row.0;
            let thick = Contact::new(&params);
            params.sample.thickness = Some(1.0);
            let deep = Contact::new(&params);
            for delta in [1e-10, 1e-9, 1e-8] {
                let off = deep.force(delta, true) / thick.force(delta, true) - 1.0;
                assert!(off > 0.0 && off < 1e-3, "{shape:?} {delta:e}: {off:e}");
            }
            let forces: Vec<f64> = (1..400).map(|n| thin.force(5e-9 * f64::from(n), true)).collect();
            assert!(forces.windows(2).all(|pair| pair[0] < pair[1]), "{shape:?}");
        }
    }
}

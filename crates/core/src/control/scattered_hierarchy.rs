//! Instances without a grid: their distances in scaled quantities, and predictions from the nearest ones.

use super::kd_tree::KdTree;
use super::orbit_pair::{OrbitPair, WeightedPoint};
use super::rbf;
use crate::contact::KernelUnits;
use crate::kernel::LENGTH;
use crate::plan::Plan;
use rayon::prelude::*;

/// Coarse points are the tree's top: one in 2^COARSE_EXPONENT instances, at least about 2^MIN_COARSE_EXPONENT.
const COARSE_EXPONENT: u32 = 7;
const MIN_COARSE_EXPONENT: u32 = 6;
/// Points of a stencil beside one for each dimension. Twice as many for each took 2 to 5 % fewer steps and more time.
const STENCIL_POINTS_BESIDE_DIMENSIONS: usize = 4;
/// The points of a stencil may be so many times as far as the nearest ones.
const STENCIL_DISTANCE_RATIO: f64 = 2.0;
/// Number of neighbours from whose states an instance may start if no search finds its own.
const ADJACENT_POINTS: usize = 4;
/// Modes of an instrument that count for distance. Faster ones follow from the same lever.
const DISTANCE_MODES: usize = 4;
/// Distance between instances of two laws, in spreads.
const OTHER_LAW_DISTANCE: f64 = 20.0;
/// Two quantities that differ by no more than this, root mean square in spreads, count as one.
const SAME_QUANTITY_SPREAD: f64 = 1e-3;
/// A quantity whose relative spread is no larger counts as constant.
const QUANTITY_ROUNDING: f64 = 1e-9;

/// The instances of a block.
pub(super) struct ScatteredHierarchy {
    dimensions: usize,
    /// Scaled coordinates, instance after instance, in spreads.
    coordinates: Vec<f64>,
    tree: KdTree,
    /// Depths of the tree that hold the coarse points.
    scouted: u32,
}

impl ScatteredHierarchy {
    pub fn new(plan: &Plan) -> Self {
        let rows: Vec<Vec<f64>> =
            (0..plan.len() as u32).into_par_iter().map(|instance| quantities(plan, instance)).collect();
        let columns = distinct(&rows);
        let dimensions = columns.len();
        let coordinates: Vec<f64> =
            (0..rows.len()).flat_map(|n| columns.iter().map(move |column| column[n])).collect();
        let tree = KdTree::new(dimensions, &coordinates);
        let scouted = tree.depth().saturating_sub(COARSE_EXPONENT).max(MIN_COARSE_EXPONENT).min(tree.depth());
        Self { dimensions, coordinates, tree, scouted }
    }

    pub fn coarse(&self) -> Vec<u32> {
        self.tree.at(0..self.scouted)
    }

    pub fn levels(&self) -> usize {
        (self.tree.depth() - self.scouted) as usize
    }

    pub fn level(&self, number: usize) -> Vec<u32> {
        let depth = self.scouted + number as u32;
        self.tree.at(depth..depth + 1)
    }

    fn coordinates(&self, instance: u32) -> &[f64] {
        &self.coordinates[instance as usize * self.dimensions..][..self.dimensions]
    }

    /// The neighbours of an instance.
    pub fn adjacent(&self, instance: u32) -> Vec<u32> {
        let near = self.tree.nearest(self.coordinates(instance), self.tree.depth(), ADJACENT_POINTS + 1, 1.0);
        near.into_iter().map(|one| one.0).filter(|other| *other != instance).take(ADJACENT_POINTS).collect()
    }

    /// The nearest solved instances in the same regime as the very nearest, with their weights. Empty if there are too few.
    pub fn support(&self, level: usize, instance: u32, solved: &[OrbitPair]) -> Vec<WeightedPoint> {
        let (at, least) = (self.coordinates(instance), self.dimensions + 2);
        let count = STENCIL_POINTS_BESIDE_DIMENSIONS + self.dimensions;
        let near = self.tree.nearest(at, self.scouted + level as u32, count, STENCIL_DISTANCE_RATIO);
        let node = |i: u32| solved[i as usize].neighbours().map(|[_, second]| second);
        let first = near.first().and_then(|one| node(one.0));
        let alike: Vec<&(u32, f64)> =
            near.iter().filter(|one| first.zip(node(one.0)).is_some_and(|(a, b)| a.same_regime(b))).collect();
        if alike.len() < least || 2 * alike.len() < near.len() {
            return Vec::new();
        }
        let squares: Vec<f64> = alike.iter().take(least).map(|one| one.1).collect();
        let mut nearest = rbf::by_distance(&squares);
        nearest.resize(alike.len(), 0.0);
        let places: Vec<&[f64]> = alike.iter().map(|one| self.coordinates(one.0)).collect();
        let all = rbf::weights(at, &places).unwrap_or_else(|| nearest.clone());
        alike.iter().zip(all).zip(nearest).map(|((one, weight), nearest)| (one.0, weight, nearest)).collect()
    }
}

/// The quantities that determine an instance's motion, in units of its lever and amplitude: the law's constants, the gap, and
/// the modes relative to the drive. Positive quantities are logarithms.
fn quantities(plan: &Plan, instance: u32) -> Vec<f64> {
    let (case, driven) = (plan.case(instance), plan.driven(instance));
    let (free, instrument) = (&driven.free, &driven.instrument);
    let amplitude = driven.free_amplitude();
    let units = KernelUnits { impulse: instrument.flexibility() / LENGTH, step: 1.0 / free.omega };
    let mut all = vec![case.contact.law as u8 as f64, case.gap / amplitude, logarithm(amplitude)];
    for mode in instrument.modes.iter().take(DISTANCE_MODES) {
        let share = mode.inverse_mass() / (mode.omega * mode.omega) / instrument.flexibility();
        all.extend([logarithm(mode.omega / free.omega), logarithm(mode.quality_factor), logarithm(share)]);
    }
    all.resize(3 + 3 * DISTANCE_MODES, 0.0);
    all.extend(case.contact.law().constants(units).into_iter().map(logarithm));
    all
}

/// Logarithm of the absolute value; 0 if that is not finite.
fn logarithm(value: f64) -> f64 {
    let logarithm = value.abs().ln();
    if logarithm.is_finite() { logarithm } else { 0.0 }
}

/// The quantities that vary, each once, in units of their spread.
fn distinct(rows: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let most = rows.iter().map(Vec::len).max().unwrap_or(0);
    let count = rows.len().max(1) as f64;
    let mut columns: Vec<Vec<f64>> = Vec::new();
    for n in 0..most {
        let mut column: Vec<f64> = rows.iter().map(|row| row.get(n).copied().unwrap_or(0.0)).collect();
        let mean = column.iter().sum::<f64>() / count;
        let spread = (column.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / count).sqrt();
        if spread.is_nan() || spread <= QUANTITY_ROUNDING * mean.abs().max(SAME_QUANTITY_SPREAD) {
            continue;
        }
        let scale = if n == 0 { OTHER_LAW_DISTANCE / spread.max(1e-3) } else { 1.0 / spread };
        column.iter_mut().for_each(|value| *value = (*value - mean) * scale);
        let apart = |other: &Vec<f64>, sign: f64| -> f64 {
            let square: f64 = other.iter().zip(&column).map(|(a, b)| (a - sign * b).powi(2)).sum();
            (square / count).sqrt()
        };
        if columns.iter().all(|other| {
            apart(other, 1.0) > SAME_QUANTITY_SPREAD && apart(other, -1.0) > SAME_QUANTITY_SPREAD
        }) {
            columns.push(column);
        }
    }
    if columns.is_empty() { vec![vec![0.0; rows.len()]] } else { columns }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_plans::plan_of;

    fn plan(levers: &str) -> Plan {
        let text = format!(
            r#"
            [instrument.cantilever]
            stiffness = "40 N/m"
            frequency = "300 kHz"
            quality_factor = 100
            [instrument.actuator]
            model = "rigid"
            [drive]
            on = "tip"
            frequency = "resonance"
            free_amplitude = "20 nm"
            [contact]
            law = "dmt"
            [uncertain]
            "sample.youngs_modulus" = {{ distribution = "loguniform", from = "1 GPa", to = "10 GPa" }}
            "sample.poisson_ratio" = {{ distribution = "uniform", from = 0.2, to = 0.4 }}
            "approach.gap" = {{ distribution = "uniform", from = "14 nm", to = "16 nm" }}
            {levers}
            [design]
            kind = "sobol"
            samples = 1024
            "#
        );
        plan_of(&text)
    }

    /// Truth: Poisson's ratio and the modulus act through one number. For a lever at resonance in units of its own stiffness
    /// and period, only the quality factor is left, whatever its frequency.
    #[test]
    fn quantities_that_act_as_one_are_one() {
        let frequency = r#""instrument.cantilever.frequency" = { distribution = "uniform", from = "200 kHz", to = "400 kHz" }"#;
        let quality =
            r#""instrument.cantilever.quality_factor" = { distribution = "uniform", from = 100, to = 400 }"#;
        let dimensions = |levers: &str| ScatteredHierarchy::new(&plan(levers)).dimensions;
        assert_eq!([dimensions(""), dimensions(frequency)], [2, 2]);
        // The resonance differs slightly from the mode's own frequency. The quality factor determines by how much.
        assert!([3, 4].contains(&dimensions(quality)), "{}", dimensions(quality));
    }

    #[test]
    fn every_instance_comes_once() {
        let all = ScatteredHierarchy::new(&plan(""));
        let mut seen = all.coarse();
        assert_eq!(seen.len(), 63);
        (0..all.levels()).for_each(|level| seen.extend(all.level(level)));
        seen.sort_unstable();
        assert!(seen.into_iter().eq(0..1024));
    }
}

//! Where contact laws are used outside their assumptions.

use super::instance_rows::{InstanceRows, RowView};
use crate::contact::Warning;
use crate::control::JournaledRun;
use crate::engine::EngineError;
use crate::observe::Observable;
use crate::plan::Plan;
use crate::scene::{Cases, Params, Scene};
use rayon::prelude::*;

/// Names of the bits of `contact_warnings`.
pub const WARNINGS: [&str; 7] = [
    "law_does_not_fit",
    "between_laws",
    "adhesion_left_out",
    "large_strain",
    "rigid_tip",
    "beyond_series",
    "adhesive_layer",
];

fn bit(warning: &Warning) -> u8 {
    match warning {
        Warning::LawDoesNotFit { .. } => 1,
        Warning::BetweenLaws { .. } => 1 << 1,
        Warning::AdhesionLeftOut { .. } => 1 << 2,
        Warning::LargeStrain { .. } => 1 << 3,
        Warning::RigidTip { .. } => 1 << 4,
        Warning::BeyondSeries { .. } => 1 << 5,
        Warning::AdhesiveLayer => 1 << 6,
    }
}

/// What one pass over all instances gives and no journal stores: warnings of each, and the number of steps.
#[derive(Clone, Debug)]
pub struct LawWarnings {
    /// Warning bits of each instance, at the largest indentation measured or else expected. Empty if there are none.
    pub bits: Vec<u8>,
    /// Steps of all instances in all periods.
    pub instance_steps: u64,
}

impl LawWarnings {
    /// Collects the warnings of all instances.
    pub(super) fn of(scene: &Scene, rows: &InstanceRows) -> Result<Self, EngineError> {
        let (mut bits, mut steps) = (vec![0; rows.count()], 0);
        let cases = Cases::of(scene);
        rows.each(true, &mut |instances, some| {
            let depths = some.observed(Observable::IndentationMax);
            let one = |params: &mut Params, n: usize| {
                cases.put(params, instances[n] as usize);
                let depth = depth(some, n, depths[n]);
                let warnings = some.contact(n).warnings(params, depth);
                warnings.iter().map(bit).fold(0, |all, one| all | one)
            };
            let numbers = (0..instances.len()).into_par_iter();
            let all: Vec<u8> = numbers.map_init(|| cases.base(), one).collect();
            instances.iter().zip(all).for_each(|(i, one)| bits[*i as usize] = one);
            steps += some.steps().into_iter().map(u64::from).sum::<u64>();
        })?;
        if bits.iter().all(|bits| *bits == 0) {
            bits = Vec::new();
        }
        Ok(Self { bits, instance_steps: steps * u64::from(rows.plan().run.periods) })
    }

    /// For each of [`WARNINGS`], how many instances have it, and the message of the first.
    pub(crate) fn lines(&self, scene: &Scene, run: &JournaledRun) -> Result<Vec<String>, EngineError> {
        let mut lines = Vec::new();
        for (number, word) in WARNINGS.iter().enumerate() {
            let mask = 1u8 << number;
            let Some(first) = self.bits.iter().position(|bits| bits & mask != 0) else { continue };
            let count = self.bits.iter().filter(|bits| **bits & mask != 0).count();
            let one = run.some(&[first as u32])?;
            let depth = of_plan(&one.plan, 0, one.results.get(0).measured.indentation_max);
            let words = one.plan.contact(0).warnings(&scene.instance(first), depth);
            let words = words
                .into_iter()
                .find(|warning| bit(warning) == mask)
                .map_or_else(|| word.replace('_', " "), |warning| warning.to_string());
            lines.push(match self.bits.len() {
                1 => words,
                all => format!("{count} of {all} instances, instance {first} first: {words}"),
            });
        }
        Ok(lines)
    }
}

/// Largest indentation of an instance, m: the measured one, none if the measurement found no contact, else the expected one.
fn depth(some: &RowView, n: usize, measured: f64) -> Option<f64> {
    match measured.is_nan() {
        false => Some(measured),
        true => of_plan(some.plan(), n as u32, measured),
    }
}

fn of_plan(plan: &Plan, n: u32, measured: f64) -> Option<f64> {
    match measured.is_nan() {
        false => Some(measured),
        true if plan.wants.extremes || plan.steps(n) == 0 => None,
        true => Some(plan.expected_depth(n)),
    }
}

//! Where contact laws are used outside their assumptions.

use super::instance_rows::{InstanceRows, RowView};
use crate::contact::Warning;
use crate::control::JournaledRun;
use crate::engine::EngineError;
use crate::observe::Observable;
use crate::plan::Plan;
use crate::scene::{Cases, Params, Scene};
use rayon::prelude::*;

/// Words for the bits of `contact_warnings`.
pub const WARNINGS: [&str; 5] =
    ["law_does_not_fit", "between_laws", "adhesion_left_out", "large_strain", "rigid_tip"];

fn bit(warning: &Warning) -> u8 {
    match warning {
        Warning::LawDoesNotFit { .. } => 1,
        Warning::BetweenLaws { .. } => 1 << 1,
        Warning::AdhesionLeftOut { .. } => 1 << 2,
        Warning::LargeStrain { .. } => 1 << 3,
        Warning::RigidTip { .. } => 1 << 4,
    }
}

/// What one look at all instances tells, and no journal: the warnings of each, and what its steps come to.
#[derive(Clone, Debug)]
pub struct LawWarnings {
    /// Of each instance its warnings as bits, at the largest indentation measured or else expected; empty where none has any.
    pub bits: Vec<u8>,
    /// Steps of all instances in all periods.
    pub instance_steps: u64,
}

impl LawWarnings {
    /// Of all instances.
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

    /// How many instances have each warning of [`WARNINGS`], and the first one's own words.
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

/// Largest indentation of an instance, m: measured; none where it was measured and there was no contact;
/// else what the plan expects.
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

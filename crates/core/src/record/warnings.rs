//! Where contact laws are used outside their assumptions.

use super::instance_rows::{InstanceRows, RowView};
use crate::contact::Warning;
use crate::control::JournaledRun;
use crate::engine::EngineError;
use crate::observe::{Observable, Status};
use crate::plan::Plan;
use crate::scene::{Cases, ForceBranch, Params, Scene};
use rayon::prelude::*;

/// Names of the bits of `contact_warnings`.
pub const WARNINGS: [&str; 8] = [
    "law_does_not_fit",
    "between_laws",
    "adhesion_left_out",
    "large_strain",
    "rigid_tip",
    "beyond_series",
    "adhesive_layer",
    "beyond_table",
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
        Warning::BeyondTable { .. } => 1 << 7,
    }
}

/// What one pass over all instances gives and no journal stores: warnings of each, and the number of steps.
#[derive(Clone, Debug)]
pub struct LawWarnings {
    /// Warning bits of each instance, at the largest indentation measured or else expected. Empty if there are none.
    pub bits: Vec<u8>,
    /// Steps of all instances in all periods.
    pub instance_steps: u64,
    /// How many instances hold a set-point of the motion on the attractive branch, and how many on the repulsive one.
    held: [usize; 2],
}

impl LawWarnings {
    /// Collects the warnings of all instances.
    pub(super) fn of(scene: &Scene, rows: &InstanceRows) -> Result<Self, EngineError> {
        let (mut bits, mut steps) = (vec![0; rows.count()], 0);
        let cases = Cases::of(scene);
        let (holds, statuses, mut held) = (scene.holds_motion(), rows.statuses(), [0; 2]);
        rows.each(true, &mut |instances, some| {
            let depths = some.observed(Observable::IndentationMax);
            if holds {
                let is_steady =
                    |i: u32| Status::from_code(statuses[i as usize]).is_some_and(Status::is_steady);
                let forces = instances.iter().zip(some.observed(Observable::ForceMean));
                for (_, force) in forces.filter(|(i, force)| is_steady(**i) && force.abs() > 0.0) {
                    held[usize::from(force > 0.0)] += 1;
                }
            }
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
        Ok(Self { bits, held, instance_steps: steps * u64::from(rows.plan().run.periods) })
    }

    /// For each of [`WARNINGS`], how many instances have it, and the message of the first.
    pub(crate) fn lines(&self, scene: &Scene, run: &JournaledRun) -> Result<Vec<String>, EngineError> {
        let mut lines: Vec<String> = self.branch_line(scene, run.len()).into_iter().collect();
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

    /// What to know of the branch that holds a set-point.
    fn branch_line(&self, scene: &Scene, all: usize) -> Option<String> {
        let [attractive, repulsive] = self.held;
        let (count, words) = match scene.base.approach.branch {
            None => (
                attractive,
                "the set-point on the attractive branch, where the tip hovers or hardly touches: setpoint_branch = \
                 \"repulsive\" asks for the other",
            ),
            Some(ForceBranch::Repulsive) => (
                attractive,
                "the set-point on the attractive branch: on the repulsive one, which is asked for, \
                 none was found",
            ),
            Some(ForceBranch::Attractive) => (
                repulsive,
                "the set-point on the repulsive branch: on the attractive one, which is asked for, \
                 none was found",
            ),
        };
        let who =
            if all == 1 { "the instance holds".into() } else { format!("{count} of {all} instances hold") };
        (count > 0).then(|| format!("{who} {words} (branch tells which)"))
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
